"""The flexibility between contact points as one dense matrix: best for small interfaces."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
from scipy.linalg import lapack

from faying._typing import Mask, Matrix, Vector
from faying.contact.bordered_factor import SINGULAR_PIVOT, BorderedFactor
from faying.contact.pivoting import ROUND_OFF, largest

UNCLOSED = 1e-12
"""Gap left at active points over the largest |g_free| above which a block is factorized anew."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class DensePoints:
    """H (n_point, n_point) [length/force]; its active blocks are factorized, or bordered."""

    H: Matrix
    noise: float = ROUND_OFF

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        return np.diag(self.H).copy()

    @cached_property
    def _blocks(self) -> BorderedFactor:
        return BorderedFactor(self.H)

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        forces = self._blocks.solve(-g_free, active)
        # A product with all of H beats gathering its active columns.
        slack = self.H @ forces + g_free
        if largest(slack[active]) > UNCLOSED * largest(g_free):
            forces = self._blocks.solve_anew(-g_free, active)
            slack = self.H @ forces + g_free
        slack[active] = 0.0
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
