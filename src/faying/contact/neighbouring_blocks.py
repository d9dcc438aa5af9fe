"""Blocks of the flexibility between points that differ by a few points from one to the next.

With H_00 = L Lᵀ of the points Z that were factorized last, the block of other points A is solved in
the points of both: forces y_N of the points N that came, and constraints that those of the points R
that went vanish. With U the columns H_0N, and of R those of the unit matrix,

    (C − Wᵀ W) y = d − Wᵀ L⁻¹ b_0,   W = L⁻¹ U,   x_0 = L⁻ᵀ (L⁻¹ b_0 − W y),

C = H_NN and d = b_N, and zero for R: W. W. Hager, "Updating the inverse of a matrix", SIAM Review
31 (1989) 221-239.
"""

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np
from scipy.linalg import blas, lapack

from faying._typing import Indices, Mask, Matrix
from faying.contact.dense_points import SINGULAR_PIVOT
from faying.exceptions import ModelError

MOST_CHANGES = 32
"""Points that came or went before the block is factorized anew."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class NeighbouringBlocks:
    """Solves blocks of H that differ little from the one that was factorized last.

    Attributes
    ----------
    H : (n_point, n_point) [length/force]
    points : (n,)
        Of the block that was factorized.
    factor : (n, n)
        Its lower Cholesky factor.
    changed : (n_changed,)
        Points that came or went since.
    columns : (n, n_changed)
        Their columns of W, of those that went scaled to those of H.
    """

    H: Matrix
    points: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    factor: Matrix = field(default_factory=lambda: np.zeros((0, 0)))
    changed: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    columns: Matrix = field(default_factory=lambda: np.zeros((0, 0)))

    def solved(self, active: Mask, right: Matrix) -> tuple[Matrix, "NeighbouringBlocks"]:
        """Return X (n_point, k), zero outside, with H_AA X_A = B_A, and what solves the next one.

        Parameters
        ----------
        active : (n_point,)
        right : (n_point, k)

        Raises
        ------
        ModelError
            If the block is singular.
        """
        if not active.any():
            return np.zeros_like(right), self
        near = self._changed_to(active)
        found = None if near is None else near._updated(active, right)
        if near is not None and found is not None:
            return found, near
        anew = self._factorized(np.flatnonzero(active))
        solution = np.zeros_like(right)
        solution[anew.points] = lapack.dpotrs(anew.factor, right[anew.points], lower=1)[0]
        return solution, anew

    def _changed_to(self, active: Mask) -> "NeighbouringBlocks | None":
        """Return the same with the columns of the points that changed; None of too many."""
        known = np.zeros(len(active), dtype=bool)
        known[self.points] = True
        differing = active ^ known
        if not len(self.points) or np.count_nonzero(differing) > MOST_CHANGES:
            return None
        kept = differing[self.changed]
        differing[self.changed] = False
        new = np.flatnonzero(differing)
        columns = np.zeros((len(self.points), len(new)))
        came = ~known[new]
        columns[:, came] = self.H[np.ix_(self.points, new[came])]
        went = new[~came]
        columns[np.searchsorted(self.points, went), np.flatnonzero(~came)] = self.H[went, went]
        solved = blas.dtrsm(1.0, self.factor, columns, lower=1) if len(new) else columns
        return replace(
            self,
            changed=np.concatenate([self.changed[kept], new]),
            columns=np.hstack([self.columns[:, kept], solved]),
        )

    def _updated(self, active: Mask, right: Matrix) -> Matrix | None:
        """Return the solution by the factor there is; None where the update is near singular."""
        half = blas.dtrsm(1.0, self.factor, right[self.points], lower=1)
        solution = np.zeros_like(right)
        came = active[self.changed]
        if len(self.changed):
            schur = -self.columns.T @ self.columns
            own = self.changed[came]
            schur[np.ix_(came, came)] += self.H[np.ix_(own, own)]
            sizes = np.abs(np.linalg.eigvalsh(schur))
            if sizes.min() < SINGULAR_PIVOT * max(sizes.max(), self.H[own, own].max(initial=0.0)):
                return None
            sides = -self.columns.T @ half
            sides[came] += right[own]
            others = np.linalg.solve(schur, sides)
            half = half - self.columns @ others
            solution[own] = others[came]
        solution[self.points] = blas.dtrsm(1.0, self.factor, half, lower=1, trans_a=1)
        solution[~active] = 0.0
        return solution

    def _factorized(self, points: Indices) -> "NeighbouringBlocks":
        block = self.H.take(points, axis=0)[:, points].T
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        if failed or pivots.min() < SINGULAR_PIVOT * pivots.max():
            message = (
                "contact forces are not unique where contact is hard at more points than there are "
                "relative displacements; take nodal quadrature or a penalty to follow a load"
            )
            raise ModelError(message)
        return NeighbouringBlocks(
            H=self.H, points=points, factor=factor, columns=np.zeros((len(points), 0))
        )
