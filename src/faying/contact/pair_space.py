"""Elastic contact solved between node pairs: exact, with matrices of the pairs in contact.

Gaps at the contact points are interpolated from the pairs, H = N S Nᵀ + D, so H is a matrix of the
rank of S but for its diagonal. With r = Nᵀλ, the forces at the pairs, the active gaps close where

    (I + B S) r = −N_Aᵀ D_A⁻¹ g_A,   B = N_Aᵀ D_A⁻¹ N_A,   λ_A = −D_A⁻¹ (g_A + N_A S r),

in which B is the sparse stiffness of the penalty springs in contact. Only pairs that touch an
active point carry force: four Gauss points a facet make the matrix four times smaller than H.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from scipy.linalg import lapack

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.active_set import ROUND_OFF, largest
from faying.contact.padded_rows import PaddedRows

SINGULAR_SPRINGS = 1e-12
"""Added to the diagonal of B, relative: it is singular where a facet has one active point."""

ROW_BLOCK = 1024
"""Contact points whose rows of H exist at once."""

DOUBT = 1e-11
"""Gaps of the wrong sign beyond this fraction of the largest |g_free| are no round-off of S r."""


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
        """Return the forces that close the active gaps, and the slack of all points.

        Where some sign is wrong beyond doubt these forces are not the last, and come from y = S r.
        """
        if not active.any():
            return np.zeros_like(g_free), g_free.copy()
        if not (self.D[active] > 0).all():
            message = "hard contact: the pair space needs a penalty"
            raise la.LinAlgError(message)
        springs = self._springs(active)
        pressed = -(self._transposed @ (springs.stiffness * g_free))
        pairs = springs.pair_forces(self.S, pressed)
        slack = self.N @ (self.S @ pairs) + g_free
        doubt = DOUBT * largest(g_free)
        if np.where(active, slack > doubt, slack < -doubt).any():
            forces = -springs.stiffness * slack
        else:
            moved = springs.displacements(pressed - pairs)
            forces = -springs.stiffness * (self.N @ moved + g_free)
        slack[active] = 0.0
        return forces, slack

    def closing(self, g_free: Vector, active: Mask) -> Vector:
        """Return the forces at all points that close the active gaps."""
        forces = np.zeros_like(g_free)
        forces[active] = self._closed(g_free[active, None], active)[:, 0]
        return forces

    def solve_active(self, right: Matrix, active: Mask) -> Matrix:
        """Return H_AA⁻¹ B (n_active, k) for B (n_active, k), of least norm where not unique."""
        if not (self.D[active] > 0).all():
            rows = self.N[np.flatnonzero(active)]
            block = rows @ (rows @ self.S).T + np.diag(self.D[active])
            return np.asarray(la.lstsq(block, right)[0])
        return self._closed(-right, active)

    def _closed(self, gaps: Matrix, active: Mask) -> Matrix:
        """Return the forces (n_active, k) that close gaps (n_active, k)."""
        springs, rows = self._springs(active), self.N[np.flatnonzero(active)]
        own = springs.stiffness[active][:, None]
        pressed = -(rows.T @ (gaps * own))
        moved = springs.displacements(pressed - springs.pair_forces(self.S, pressed))
        forces: Matrix = -own * (gaps + rows @ moved)
        return forces

    @cached_property
    def _transposed(self) -> SparseMatrix:
        return self.N.T.tocsr()

    @cached_property
    def _spring_pattern(self) -> tuple[Indices, Indices, SparseMatrix]:
        """Row starts and columns of NᵀN, and the entries of each point (n_entry, n_point)."""
        rows = PaddedRows.of(self.N)
        products = rows.values[:, :, None] * rows.values[:, None, :]
        places = rows.columns[:, :, None] * rows.n_column + rows.columns[:, None, :]
        points, first, second = products.nonzero()
        filled, entry = np.unique(places[points, first, second], return_inverse=True)
        shape = (len(filled), len(self.D))
        each = sp.csr_array((products[points, first, second], (entry, points)), shape=shape)
        starts = np.searchsorted(filled // rows.n_column, np.arange(rows.n_column + 1))
        return starts, filled % rows.n_column, each

    def _springs(self, active: Mask) -> "_Springs":
        """Assemble the springs of the active points."""
        starts, columns, each = self._spring_pattern
        stiffness = np.divide(active, self.D, out=np.zeros_like(self.D), where=active)
        n = self.N.shape[1]
        B = sp.csr_array((each @ stiffness, columns, starts), shape=(n, n))
        return _Springs(stiffness=stiffness, B=B, touched=np.flatnonzero(B.diagonal()))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Springs:
    """Springs of the active points: D⁻¹, zero elsewhere, B, and the pairs they touch."""

    stiffness: Vector
    B: SparseMatrix
    touched: Indices

    def pair_forces(self, S: Matrix, pressed: Matrix) -> Matrix:
        """Solve (I + B S) r = b; forces of pairs that no spring touches vanish."""
        at = self.touched
        matrix = self.B[at] @ S.take(at, axis=1)
        matrix.flat[:: len(at) + 1] += 1.0
        # LAPACK works in column order: it factorizes the transpose in place.
        lu, pivots, failed = lapack.dgetrf(matrix.T, overwrite_a=1)
        if failed:
            message = "singular active block"
            raise la.LinAlgError(message)
        forces = np.zeros_like(pressed)
        forces[at] = lapack.dgetrs(lu, pivots, pressed[at], trans=1)[0]
        return forces

    def displacements(self, right: Matrix) -> Matrix:
        """Return a y with B y = b; what of y no active point feels is arbitrary.

        It keeps the digits that y = S r loses, as many as the structure is softer than the penalty.
        """
        at = self.touched
        own = self.B[at][:, at]
        factor = spla.splu(
            sp.csc_array(own + SINGULAR_SPRINGS * sp.diags_array(own.diagonal())),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        result = np.zeros_like(right)
        for _ in range(2):
            result[at] += factor.solve((right - self.B @ result)[at])
        return result
