"""The flexibility between points of hard contact too many for a matrix, by sparse factors."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Mask, SparseMatrix, Vector
from faying.contact.active_set import ROUND_OFF
from faying.linalg.singular import NotDefiniteError
from faying.linalg.sparse_compliance import SparseCompliance


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SaddlePoints:
    """H = N S Nᵀ + D; the forces at active points are a factorization of (F16).

    Attributes
    ----------
    N : (n_point, n_relative) sparse
    S
    D : (n_point,) [length/force]
    """

    N: SparseMatrix
    S: SparseCompliance
    D: Vector
    noise: float = ROUND_OFF

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H if pairs moved singly, which is less."""
        singly = self.N.multiply(self.N) @ (1.0 / self.S.stiffness.diagonal)
        return np.asarray(self.D + singly)

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        points, forces = np.flatnonzero(active), np.zeros_like(g_free)
        if not len(points):
            return forces, g_free.copy()
        forces[points], moved = self._closing(points, self.D)(g_free[points])
        slack = self.N @ moved + g_free
        slack[active] = 0.0
        return forces, slack

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        return np.asarray(self.N @ (self.S @ (self.N.T @ forces)) + self.D * forces)

    def yielding(self, added: Vector) -> Callable[[Vector], Vector]:
        """Return what returns the forces under which gaps (n_point,) are (H + diag(added)) λ."""
        closing = self._closing(np.arange(len(added)), self.D + added)
        return lambda gaps: closing(-gaps)[0]

    def _closing(self, points: Indices, D: Vector) -> Callable[[Vector], tuple[Vector, Vector]]:
        """Return what returns the forces that close gaps of points, and what they move.

        One factorization serves all gaps.
        """
        rows, shapes, core = self.N[points].tocsr(), self.S.shapes, self.S.core
        seen = rows @ shapes
        try:
            pressing = self.S.stiffness.pressing(rows, D[points])
        except NotDefiniteError as error:
            raise LinAlgError(str(error)) from None

        def closing(gaps: Vector) -> tuple[Vector, Vector]:
            answers, moved = pressing(np.column_stack([gaps, -seen]))
            # By Woodbury: forces that X C Xᵀ takes up.
            system = np.eye(len(core)) + core @ (seen.T @ answers[:, 1:])
            shares = np.linalg.solve(system, core @ (seen.T @ answers[:, 0]))
            weights = np.concatenate([[1.0], -shares])
            forces = answers @ weights
            return forces, moved @ weights + shapes @ (core @ (seen.T @ forces))

        return closing

    def shifted(self, delta: float) -> "SaddlePoints":
        """Return the space of H + δ I."""
        return replace(self, D=self.D + delta)
