"""Active blocks of a matrix from the factorization of a similar one.

From one linear system of an active set method to the next, and from one instant to the next, few
points change sides. With B the points of the last factorization, a the points added since and r
those removed, the block of the present set A = B + a − r is solved bordered,

    ⎡H_BB  H_Ba  E_r⎤ ⎡λ_B⎤   ⎡b_B⎤
    ⎢H_aB  H_aa   0 ⎥ ⎢λ_a⎥ = ⎢b_a⎥      (λ_r = 0; μ is what opens there)
    ⎣E_rᵀ   0     0 ⎦ ⎣ μ ⎦   ⎣ 0 ⎦

through the Schur complement of H_BB: two triangular substitutions for the right-hand side, and one
pair for each point when it first changes. Points that changed once keep their columns, present or
not, so that nothing is copied from one system to the next.
"""

import numpy as np
import scipy.linalg as la
from scipy.linalg import blas, lapack

from faying._typing import Indices, Mask, Matrix, Vector

SINGULAR_PIVOT = 1e-7
"""Smallest over largest Cholesky pivot (condition 1e14) below which a block counts as singular."""

WELL_CONDITIONED = 1e-2
"""Smallest over largest pivot (condition 1e4) from which bordering keeps all digits that count.

A lap joint has 0.03; one whose middle plate hangs in soft springs 0.001, and bordering costs it a
digit of its pressures (4e-8 instead of 6e-9).
"""

MOST_CHANGED = 1 / 8
"""Changed over factorized points beyond which a new factorization is cheaper.

A factorization of n points takes n³/3 multiplications at the speed of matrix products, each changed
point n² at that of matrix-vector products. Measured on 1000 static cases and a step response of 464
points: 1.9 s and 0.115 s without borders, 1.3 s and 0.094 s with 1/8, 1.6 s and 0.123 s with 1/3.
"""


NEAR = 1 / 16
"""Changed over factorized points up to which the last factorization is taken without a search."""

MOST_FACTORS = 32
"""Factorizations remembered at most: enough for transients side by side to have one or two each."""

MOST_BYTES = 2**27
"""Memory of the factorizations remembered if all points were active."""


class BorderedFactor:
    """Solver of active blocks of one symmetric matrix; remembers its last factorizations.

    What it returns depends on the block alone, up to round-off; what it remembers only decides how
    fast.
    """

    def __init__(self, H: Matrix) -> None:
        n_kept = max(1, min(MOST_FACTORS, MOST_BYTES // max(8 * H.size, 1)))
        self._H = H
        self._factored: list[_Factored] = []
        self._inside: Mask = np.zeros((n_kept, len(H)), dtype=bool)
        self._used: Indices = np.zeros(n_kept, dtype=np.int64)
        self._clock = 0
        self._last = 0

    def solve(self, right: Vector, active: Mask) -> Vector:
        """Return λ (n_point,) with H_AA λ_A = b_A, zero elsewhere.

        Raises
        ------
        scipy.linalg.LinAlgError
            If the block is singular to working precision.
        """
        changed = self._nearest(active)
        if changed is None:
            return self.solve_anew(right, active)
        self._note_use()
        forces = self._factored[self._last].solve(right, changed)
        return self.solve_anew(right, active) if forces is None else forces

    def solve_anew(self, right: Vector, active: Mask) -> Vector:
        """Return the same from a factorization of this very block.

        Raises
        ------
        scipy.linalg.LinAlgError
            If the block is singular to working precision.
        """
        points = np.flatnonzero(active)
        forces = np.zeros(len(right))
        if not len(points):
            return forces
        # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
        block = self._H.take(points, axis=0)[:, points].T
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        if failed or pivots.min() < SINGULAR_PIVOT * pivots.max():
            message = "singular active block"
            raise la.LinAlgError(message)
        forces[points] = _substituted(factor, right[points])
        if pivots.min() >= WELL_CONDITIONED * pivots.max():
            self._remember(_Factored(self._H, points, factor), active)
        return forces

    def _nearest(self, active: Mask) -> Indices | None:
        """Turn to the factorization of the nearest points; None if all are too far away."""
        if not self._factored:
            return None
        changed = (active ^ self._inside[self._last]).nonzero()[0]
        if len(changed) > NEAR * len(self._factored[self._last].points):
            known = self._inside[: len(self._factored)]
            self._last = int(np.count_nonzero(known ^ active, axis=1).argmin())
            changed = (active ^ self._inside[self._last]).nonzero()[0]
        near = len(changed) <= MOST_CHANGED * len(self._factored[self._last].points)
        return changed if near else None

    def _remember(self, factored: "_Factored", active: Mask) -> None:
        """Keep a factorization, in place of the one not used for longest if there are too many."""
        n_known = len(self._factored)
        at = n_known if n_known < len(self._used) else int(self._used.argmin())
        self._factored[at : at + 1] = [factored]
        self._inside[at], self._last = active, at
        self._note_use()

    def _note_use(self) -> None:
        self._clock += 1
        self._used[self._last] = self._clock


class _Factored:
    """A factorized block H_BB and the borders C = [H_Ba E_r] of the points changed since.

    Attributes
    ----------
    points : (n_factorized,)
        B.
    """

    def __init__(self, H: Matrix, points: Indices, factor: Matrix) -> None:
        self.points = points
        self._H = H
        self._factor = factor
        self._place = np.full(len(H), -1)
        self._place[points] = np.arange(len(points))
        room = 2 * (int(MOST_CHANGED * len(points)) + 1)
        self._columns = np.empty((len(points), room), order="F")
        self._corner = np.empty((room, room))
        self._forget()

    def _forget(self) -> None:
        self._known: Indices = np.empty(0, dtype=np.int64)
        self._slot = np.full(len(self._H), -1)

    def solve(self, right: Vector, changed: Indices) -> Vector | None:
        """Return λ where the changed points have changed sides; None where that is singular."""
        points = self.points
        inside = right[points]
        alone = _substituted(self._factor, inside)
        forces = np.zeros(len(right))
        if not len(changed):
            forces[points] = alone
            return forces
        slots = self._slots(changed)
        columns = self._columns[:, : len(self._known)]
        added = self._place[changed] < 0
        rest = np.where(added, right[changed], 0.0)
        rest -= (inside @ columns)[slots]
        lu, _, outer, failed = lapack.dgesv(self._corner[slots[:, None], slots], rest)
        scale = np.abs(lu.diagonal())
        if failed or scale.min() < SINGULAR_PIVOT**2 * scale.max():
            return None
        present = np.zeros(columns.shape[1])
        present[slots] = outer
        forces[points] = alone - columns @ present
        forces[changed] = np.where(added, outer, 0.0)
        return forces

    def _slots(self, changed: Indices) -> Indices:
        """Return the places of changed points among the borders, each solved when first seen."""
        slots = self._slot[changed]
        if slots.min() >= 0:
            return slots
        new = changed[slots < 0]
        if len(self._known) + len(new) > self._columns.shape[1]:
            self._forget()
            new = changed
        self._border(new)
        return self._slot[changed]

    def _border(self, new: Indices) -> None:
        """Append H_BB⁻¹ C and the Schur complement [H_aa 0; 0 0] − CᵀH_BB⁻¹C of new points."""
        start, end = len(self._known), len(self._known) + len(new)
        self._slot[new] = np.arange(start, end)
        self._known = np.concatenate([self._known, new])
        places = self._place[self._known]
        added = places[start:] < 0
        borders = np.zeros((len(self.points), len(new)), order="F")
        borders[:, added] = self._H[new[added]][:, self.points].T
        borders[places[start:][~added], np.flatnonzero(~added)] = 1.0
        self._columns[:, start:end] = lapack.dpotrs(self._factor, borders, lower=1)[0]
        corner = -(self._columns[:, :end].T @ borders)
        both = (places < 0)[:, None] & added
        corner += np.where(both, self._H[self._known[:, None], new], 0.0)
        self._corner[:end, start:end] = corner
        self._corner[start:end, :end] = corner.T


def _substituted(factor: Matrix, right: Vector) -> Vector:
    """Return (L Lᵀ)⁻¹ b; for one right-hand side twice as fast as LAPACK's blocked routine."""
    half = blas.dtrsv(factor, right, lower=1)
    solution: Vector = blas.dtrsv(factor, half, lower=1, trans=1, overwrite_x=1)
    return solution
