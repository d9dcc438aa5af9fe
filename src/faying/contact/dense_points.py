"""The flexibility between contact points as one dense matrix: best for small interfaces."""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.linalg as la
from scipy.linalg import lapack

from faying._typing import Mask, Matrix, Vector
from faying.contact.pivoting import ROUND_OFF

SINGULAR_PIVOT = 1e-7
"""Smallest over largest Cholesky pivot (condition 1e14) below which H counts as singular."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class DensePoints:
    """H (n_point, n_point) [length/force]; one Cholesky factorization per active set."""

    H: Matrix
    noise: float = ROUND_OFF

    @property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        return np.diag(self.H)

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        index = np.flatnonzero(active)
        forces = np.zeros_like(g_free)
        if len(index) == 0:
            return forces, g_free.copy()
        # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
        block = self.H[np.ix_(index, index)].T
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        if failed or pivots.min() < SINGULAR_PIVOT * pivots.max():
            message = "singular active block"
            raise la.LinAlgError(message)
        forces[index] = lapack.dpotrs(factor, -g_free[index], lower=1)[0]
        # A product with all of H beats gathering its active columns.
        slack = self.H @ forces + g_free
        slack[index] = 0.0
        return forces, slack

    def solve(self, right: Matrix, active: Mask) -> Matrix:
        """Return H_AA⁻¹ B (n_active, k) for B (n_active, k), of least norm where not unique."""
        block = self.H[np.ix_(active, active)]
        factor, failed = lapack.dpotrf(block.T, lower=1, clean=0)
        pivots = np.diag(factor)
        if failed or pivots.min(initial=1.0) < SINGULAR_PIVOT * pivots.max(initial=0.0):
            return np.asarray(la.lstsq(block, right)[0])
        return np.asarray(lapack.dpotrs(factor, right, lower=1)[0])

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        result: Vector = self.H @ forces
        return result

    def shifted(self, delta: float) -> "DensePoints":
        """Return the space of H + δ I."""
        return DensePoints(H=self.H + delta * np.eye(len(self.H)))
