"""Active blocks of a matrix from the factorization of a similar one.

From one linear system of an active set method to the next, and from one instant to the next, few
points change sides. With B the points of the last factorization, a the points added since and r
those removed, the block of the present set A = B + a − r is solved bordered,

    ⎡H_BB  H_Ba  E_r⎤ ⎡λ_B⎤   ⎡b_B⎤
    ⎢H_aB  H_aa   0 ⎥ ⎢λ_a⎥ = ⎢b_a⎥      (λ_r = 0; μ is what opens there)
    ⎣E_rᵀ   0     0 ⎦ ⎣ μ ⎦   ⎣ 0 ⎦

through the Schur complement of H_BB: two triangular substitutions for the right-hand side, and one
pair for each point when it first changes.
"""

import numpy as np
import scipy.linalg as la
from scipy.linalg import lapack

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


class BorderedFactor:
    """Solver of active blocks of one symmetric matrix; remembers its last factorization.

    What it returns depends on the block alone, up to round-off; what it remembers only decides how
    fast.
    """

    def __init__(self, H: Matrix) -> None:
        self._H = H
        self._points: Indices = np.empty(0, dtype=np.int64)
        self._place: Indices = np.full(len(H), -1)
        self._factor: Matrix = np.empty((0, 0))
        self._changed: list[int] = []
        self._columns: Matrix = np.empty((0, 0))
        self._borders: Matrix = np.empty((0, 0))

    def solve(self, right: Vector, active: Mask) -> Vector:
        """Return λ (n_point,) with H_AA λ_A = b_A, zero elsewhere.

        Raises
        ------
        scipy.linalg.LinAlgError
            If the block is singular to working precision.
        """
        inside = self._place >= 0
        changed = np.flatnonzero(active ^ inside)
        if not len(self._points) or len(changed) > MOST_CHANGED * len(self._points):
            return self.solve_anew(right, active)
        forces = self._bordered(right, changed)
        if forces is None:
            return self.solve_anew(right, active)
        return forces

    def solve_anew(self, right: Vector, active: Mask) -> Vector:
        """Return the same from a factorization of this very block.

        Raises
        ------
        scipy.linalg.LinAlgError
            If the block is singular to working precision.
        """
        points = np.flatnonzero(active)
        forces = np.zeros_like(right)
        self._points = np.empty(0, dtype=np.int64)
        self._place[:] = -1
        if not len(points):
            return forces
        # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
        block = self._H[np.ix_(points, points)].T
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        if failed or pivots.min() < SINGULAR_PIVOT * pivots.max():
            message = "singular active block"
            raise la.LinAlgError(message)
        forces[points] = lapack.dpotrs(factor, right[points], lower=1)[0]
        if pivots.min() >= WELL_CONDITIONED * pivots.max():
            self._remember(points, factor)
        return forces

    def _remember(self, points: Indices, factor: Matrix) -> None:
        self._points, self._factor = points, factor
        self._place[points] = np.arange(len(points))
        most = int(MOST_CHANGED * len(points)) + 1
        self._changed = []
        self._columns = np.empty((len(points), 2 * most), order="F")
        self._borders = np.empty((len(points), 2 * most), order="F")

    def _bordered(self, right: Vector, changed: Indices) -> Vector | None:
        points = self._points
        alone: Vector = lapack.dpotrs(self._factor, right[points], lower=1)[0]
        forces = np.zeros_like(right)
        if not len(changed):
            forces[points] = alone
            return forces
        columns, borders = self._of(changed)
        added = self._place[changed] < 0
        corner = -(borders.T @ columns)
        corner[np.ix_(added, added)] += self._H[np.ix_(changed[added], changed[added])]
        rest = np.where(added, right[changed], 0.0) - borders.T @ alone
        lu, pivots, failed = lapack.dgetrf(corner)
        scale = np.abs(np.diag(lu))
        if failed or scale.min() < SINGULAR_PIVOT**2 * scale.max():
            return None
        outer: Vector = lapack.dgetrs(lu, pivots, rest)[0]
        forces[points] = alone - columns @ outer
        forces[changed] = np.where(added, outer, 0.0)
        return forces

    def _of(self, changed: Indices) -> tuple[Matrix, Matrix]:
        """Return H_BB⁻¹ C and C (n_factorized, n_changed), C = [H_Ba E_r], each solved once."""
        known = {point: at for at, point in enumerate(self._changed)}
        new = [point for point in changed.tolist() if point not in known]
        if len(known) + len(new) > self._columns.shape[1]:
            self._changed, known, new = [], {}, changed.tolist()
        start = len(known)
        for at, point in enumerate(new, start=start):
            known[point] = at
            place = self._place[point]
            if place < 0:
                self._borders[:, at] = self._H[self._points, point]
            else:
                self._borders[:, at] = 0.0
                self._borders[place, at] = 1.0
        self._changed = [*self._changed, *new]
        fresh = slice(start, start + len(new))
        if new:
            self._columns[:, fresh] = lapack.dpotrs(self._factor, self._borders[:, fresh], lower=1)[
                0
            ]
        at_all = [known[point] for point in changed.tolist()]
        return self._columns[:, at_all], self._borders[:, at_all]
