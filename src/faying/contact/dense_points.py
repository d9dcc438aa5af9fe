"""The flexibility between contact points as one dense matrix: exact for every law and penalty."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
from scipy.linalg import blas, lapack

from faying._typing import Mask, Matrix, Vector
from faying.contact.active_set import ROUND_OFF, solve_complementarity
from faying.contact.forces import ContactForces

SINGULAR_PIVOT = 1e-7
"""Smallest over largest Cholesky pivot (condition 1e14) below which a block counts as singular."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class DensePoints:
    """H (n_point, n_point) [length/force]; its active blocks are factorized, one a system."""

    H: Matrix
    noise: float = ROUND_OFF

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        return np.diag(self.H).copy()

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        points, forces = np.flatnonzero(active), np.zeros_like(g_free)
        if not len(points):
            return forces, g_free.copy()
        factor, regular = self._factorized(active)
        if not regular:
            message = "singular active block"
            raise la.LinAlgError(message)
        # Two triangular substitutions take half the time of LAPACK's, which is made for many.
        half = blas.dtrsv(factor, -g_free[points], lower=1)
        forces[points] = blas.dtrsv(factor, half, lower=1, trans=1, overwrite_x=1)
        # A product with all of H beats gathering its active columns.
        slack = self.H @ forces + g_free
        slack[active] = 0.0
        return forces, slack

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        result: Vector = self.H @ forces
        return result

    def shifted(self, delta: float) -> "DensePoints":
        """Return the space of H + δ I."""
        return DensePoints(H=self.H + delta * np.eye(len(self.H)))

    def solve(self, g_free: Vector, active: Mask | None = None) -> ContactForces:
        """Solve by :func:`~.active_set.solve_complementarity`."""
        return solve_complementarity(self, g_free, active)

    def _factorized(self, active: Mask) -> tuple[Matrix, bool]:
        """Return the lower Cholesky factor of an active block, and whether it is regular."""
        points = np.flatnonzero(active)
        # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
        block = self.H.take(points, axis=0)[:, points].T
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        smallest, biggest = pivots.min(initial=np.inf), pivots.max(initial=0.0)
        return factor, not failed and bool(smallest >= SINGULAR_PIVOT * biggest)
