"""The flexibility between hard contact points, by sparse factors where a matrix is too large."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.contact.active_set import ROUND_OFF
from faying.linalg.singular import NotDefiniteError
from faying.linalg.sparse_compliance import SparseCompliance


@dataclass(frozen=True, eq=False, kw_only=True)
class SaddlePoints:
    """H = N S Nᵀ + D; forces at active points follow from a factorization of (F16).

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
        """Diagonal of H if each pair moved alone, a lower bound."""
        singly = self.N.multiply(self.N) @ (1.0 / self.S.stiffness.diagonal)
        return np.asarray(self.D + singly)

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        return np.asarray(self.N @ (self.S @ (self.N.T @ forces)) + self.D * forces)

    def closing(self, points: Indices, added: Vector) -> Callable[[Matrix], Matrix]:
        """Return a function from gaps (n, k) at points to the forces (n, k) that close them.

        One factorization serves all gaps.
        """
        rows, shapes, core = self.N[points].tocsr(), self.S.shapes, self.S.core
        seen = rows @ shapes
        try:
            pressing = self.S.stiffness.pressing(rows, self.D[points] + added)
        except NotDefiniteError as error:
            raise LinAlgError(str(error)) from None

        def forces(gaps: Matrix) -> Matrix:
            if not len(points):
                return gaps
            answers = pressing(np.hstack([gaps, -seen]))
            alone, shared = np.split(answers, [gaps.shape[1]], axis=1)
            # By Woodbury: forces due to X C Xᵀ.
            system = np.eye(len(core)) + core @ (seen.T @ shared)
            return alone - shared @ np.linalg.solve(system, core @ (seen.T @ alone))

        return forces
