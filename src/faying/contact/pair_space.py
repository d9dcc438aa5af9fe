"""Elastic contact solved between node pairs: exact, with matrices of the pairs in contact.

Gaps at the contact points are interpolated from the pairs, H = N S Nᵀ + D, so H is a matrix of the
rank of S but for its diagonal. With r = Nᵀλ, the forces at the pairs, the active gaps close where

    (I + B S) r = −N_Aᵀ D_A⁻¹ g_A,   B = N_Aᵀ D_A⁻¹ N_A,   λ_A = −D_A⁻¹ (g_A + N_A S r),

in which B is the sparse stiffness of the penalty springs in contact. Only pairs that touch an
active point carry force: four Gauss points a facet make the matrix four times smaller than H.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from scipy.linalg import lapack

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.active_set import ROUND_OFF

SINGULAR_SPRINGS = 1e-12
"""Added to the diagonal of B, relative: it is singular where a facet has one active point."""

ROW_BLOCK = 1024
"""Contact points whose rows of H exist at once."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PairSpace:
    """H = N S Nᵀ + D in its parts.

    Attributes
    ----------
    N : (n_point, n_relative) sparse
    S : (n_relative, n_relative) [length/force]
    D : (n_point,) [length/force]
        Positive at every point that can close; elsewhere equilibration fails as singular.
    """

    N: SparseMatrix
    S: Matrix
    D: Vector
    noise: float = ROUND_OFF

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        blocks = [
            np.asarray(rows.multiply(rows @ self.S).sum(axis=1)).ravel()
            for rows in (
                self.N[start : start + ROW_BLOCK] for start in range(0, len(self.D), ROW_BLOCK)
            )
        ]
        return np.asarray(np.concatenate(blocks) + self.D)

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        result: Vector = self.N @ (self.S @ (self.N.T @ forces)) + self.D * forces
        return result

    def shifted(self, delta: float) -> "PairSpace":
        """Return the space of H + δ I."""
        return PairSpace(N=self.N, S=self.S, D=self.D + delta)

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        if not active.any():
            return np.zeros_like(g_free), g_free.copy()
        if not (self.D[active] > 0).all():
            message = "hard contact: the pair space needs a penalty"
            raise la.LinAlgError(message)
        forces, pairs = self.closing(g_free, active)
        slack = self.N @ (self.S @ pairs) + g_free
        slack[active] = 0.0
        return forces, slack

    def closing(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces at the points and at the pairs that close the active gaps."""
        pressed = np.where(active, g_free, 0.0)[active, None]
        points, pairs = self._closed(pressed, active)
        forces = np.zeros_like(g_free)
        forces[active] = points[:, 0]
        return forces, pairs[:, 0]

    def solve_active(self, right: Matrix, active: Mask) -> Matrix:
        """Return H_AA⁻¹ B (n_active, k) for B (n_active, k), of least norm where not unique."""
        if not (self.D[active] > 0).all():
            rows = self.N[np.flatnonzero(active)]
            block = rows @ (rows @ self.S).T + np.diag(self.D[active])
            return np.asarray(la.lstsq(block, right)[0])
        return self._closed(-right, active)[0]

    def _closed(self, gaps: Matrix, active: Mask) -> tuple[Matrix, Matrix]:
        """Return forces (n_active, k) and pair forces (n_pair, k) that close gaps (n_active, k).

        Displacements y of the pairs come from B y = b − r rather than y = S r, which loses as many
        digits as the structure is softer than the penalty.
        """
        springs = _assemble(self, active)
        touched, D = springs.touched, self.D[active][:, None]
        pressed = -(springs.rows.T @ (gaps / D))
        pairs = np.zeros_like(pressed)
        pairs[touched] = _solved(springs, self.S, pressed[touched])
        moved = springs.solve(pressed - pairs)
        forces: Matrix = -(gaps + springs.rows @ moved) / D
        return forces, pairs


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Springs:
    """Rows N_A and B of the active points, and the factors of B at the pairs they touch."""

    rows: SparseMatrix
    touched: Indices
    B: SparseMatrix
    factor: Any

    def solve(self, right: Matrix) -> Matrix:
        """Return a y with B y = b; what of y no active point feels is arbitrary."""
        result = np.zeros_like(right)
        for _ in range(2):
            result[self.touched] += self.factor.solve((right - self.B @ result)[self.touched])
        return result


def _assemble(space: PairSpace, active: Mask) -> _Springs:
    rows = space.N[np.flatnonzero(active)]
    touched = np.unique(rows.indices)
    B = (rows.T @ (rows / space.D[active][:, None])).tocsr()
    own = B[touched][:, touched]
    regular = own + SINGULAR_SPRINGS * sp.diags_array(own.diagonal())
    factor = spla.splu(
        sp.csc_array(regular),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return _Springs(rows=rows, touched=touched, B=B, factor=factor)


def _solved(springs: _Springs, S: Matrix, right: Matrix) -> Matrix:
    """Solve (I + B S) r = b at the touched pairs."""
    at = springs.touched
    matrix = springs.B[at][:, at] @ S[np.ix_(at, at)]
    matrix[np.diag_indices_from(matrix)] += 1.0
    # LAPACK works in column order: it factorizes the transpose in place.
    lu, pivots, failed = lapack.dgetrf(matrix.T, overwrite_a=1)
    if failed:
        message = "singular active block"
        raise la.LinAlgError(message)
    return np.asarray(lapack.dgetrs(lu, pivots, right, trans=1)[0])
