"""Contact solved between node pairs: exact, with matrices of the pairs in contact.

Gaps at the contact points are interpolated from the pairs, H = N S Nᵀ + D, so H is a matrix of the
rank of S but for its diagonal. With r = Nᵀλ, the forces at the pairs, the active gaps close where

    (I + B S) r = −N_Aᵀ D_A⁻¹ g_A,   B = N_Aᵀ D_A⁻¹ N_A,   λ_A = −D_A⁻¹ (g_A + N_A S r),

in which B is the sparse stiffness of the penalty springs in contact. Only pairs that touch an
active point carry force: four Gauss points a facet make the matrix four times smaller than H.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from scipy.linalg import lapack

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.pivoting import ROUND_OFF, ContactForces, solve_complementarity
from faying.contact.sprung_pairs import NEAR, InaccurateError, SprungPairs
from faying.linalg.threads import threads_for

UPDATED_FRACTION = 0.05
"""Points that change sides, over pairs in contact, up to which a factorization is updated.

An update costs two triangular solves a point, a factorization a third of a solve a pair, but at
several times the speed.
"""

UPDATED_SIZE = 1000
"""Pairs in contact from which factorizations are updated; smaller ones cost little anew.

An update is not quite as accurate: round-off of S r, amplified by the penalty, shows in the forces.
"""

LEAST_TOUCHED = 1 / 8
"""Pairs in contact over all pairs from which pairs on springs pay.

All pairs take part in what is made for the springs, only those in contact in a factorization.
"""

TRUSTED = 1e-6
"""Relative correction by one step of refinement, above which a factorization is renewed."""

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
    _held: "_Held" = field(default_factory=lambda: _Held(), repr=False)
    _last: dict[str, "_Factor"] = field(default_factory=dict, repr=False)
    _last_springs: dict[str, "_Springs"] = field(default_factory=dict, repr=False)

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
        with threads_for(len(self._springs(active).touched)):
            forces, pairs = self.closing(g_free, active)
            slack = self.N @ (self.S @ pairs) + g_free
        slack[active] = 0.0
        return forces, slack

    def closing(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces at the points and at the pairs that close the active gaps."""
        pairs, trusted = self._pair_forces(self._near(active), g_free, active)
        if not trusted:
            pairs, _ = self._pair_forces(self._exactly(active), g_free, active)
        return self._point_forces(pairs, g_free, active), pairs

    def solve(self, right: Matrix, active: Mask) -> Matrix:
        """Return H_AA⁻¹ B (n_active, k) for B (n_active, k), of least norm where not unique."""
        if not (self.D[active] > 0).all():
            rows = self.N[np.flatnonzero(active)]
            block = rows @ (rows @ self.S).T + np.diag(self.D[active])
            return np.asarray(la.lstsq(block, right)[0])
        factor, result = self._exactly(active), np.empty(right.shape)
        gap = np.zeros(len(self.D))
        for k, column in enumerate(right.T):
            gap[active] = -column
            pairs, _ = self._pair_forces(factor, gap, active)
            result[:, k] = self._point_forces(pairs, gap, active)[active]
        return result

    def _pair_forces(self, factor: "_Factor", g_free: Vector, active: Mask) -> tuple[Vector, bool]:
        """Solve for r; with an updated factorization, improve once and say whether that is small.

        A correction by S r would bring in round-off that a new factorization does not have.
        """
        springs, solve = self._springs(active), factor.solver(self, active)
        right = -(self.N.T @ np.where(active, g_free / self._positive, 0.0))
        pairs = solve(right)
        if np.array_equal(factor.active, active):
            return pairs, True
        correction = solve(right - pairs - springs.B @ (self.S @ pairs))
        trusted = np.abs(correction).max() <= TRUSTED * np.abs(pairs).max()
        return pairs + correction, bool(trusted)

    def _point_forces(self, pairs: Vector, g_free: Vector, active: Mask) -> Vector:
        """Share the forces at the pairs out to the active points.

        Displacements y of the pairs come from B y = b − r rather than y = S r, which loses as many
        digits as the structure is softer than the penalty.
        """
        springs, D = self._springs(active), self._positive
        missing = -(self.N.T @ np.where(active, g_free / D, 0.0)) - pairs
        moved = springs.solve(missing)
        forces: Vector = np.where(active, -(g_free + self.N @ moved) / D, 0.0)
        return forces

    @cached_property
    def _positive(self) -> Vector:
        """D, with ones where contact is hard and no penalty acts."""
        return np.where(self.D > 0, self.D, 1.0)

    def _springs(self, active: Mask) -> "_Springs":
        last = self._last_springs.get("springs")
        if last is None or (last.active != active).any():
            last = self._last_springs["springs"] = _assemble(self, active)
        return last

    def _near(self, active: Mask) -> "_Factor":
        """Return the last factorization where few points have changed sides since, or a new one."""
        last = self._last.get("factor")
        if last is not None and len(last.touched) >= UPDATED_SIZE:
            changed = np.count_nonzero(active ^ last.active)
            if changed <= UPDATED_FRACTION * len(last.touched):
                return last
        return self._exactly(active)

    def _exactly(self, active: Mask) -> "_Factor":
        last = self._last.get("factor")
        if last is None or (last.active != active).any():
            self._last.clear()
            self._last["factor"] = last = _factorize(self, self._springs(active))
        return last


def solve_between_pairs(
    space: PairSpace, g_free: Vector, active: Mask | None = None
) -> ContactForces:
    """Solve s = H λ + g_free ≥ 0, λ ≥ 0, λᵀ s = 0, from the problem solved last if it is similar.

    Where few points have changed sides, pairs on springs (:class:`SprungPairs`) take the place of
    a factorization per linear system; :func:`solve_complementarity` does the rest.

    Parameters
    ----------
    active : (n_point,), optional
        Points assumed in contact at the start; by default those with g_free < 0.

    Raises
    ------
    ConvergenceError
        If H is not positive semidefinite.
    """
    start = g_free < 0 if active is None else np.array(active, dtype=bool)
    held = space._held
    with threads_for(len(space.S)):
        found = _solve_on_springs(space, g_free, start)
    if found is None:
        found = solve_complementarity(space, g_free, start)
    held.steady = held.last is not None and _near(space, found.active, held.last)
    held.last = found.active
    return found


@dataclass(eq=False)
class _Held:
    """What the last problem left: its closed points, and pairs on springs since they pay.

    They do where one problem follows from another, as in steps, and the last one did (``steady``).
    """

    last: Mask | None = None
    steady: bool = False
    pairs: SprungPairs | None = None
    useless: bool = False


def _solve_on_springs(space: PairSpace, g_free: Vector, active: Mask) -> ContactForces | None:
    """Solve from a similar set of closed points; None if there is none or it does not help."""
    held = space._held
    if held.useless:
        return None
    try:
        if held.pairs is None or not held.pairs.near(active):
            if held.last is None or not (held.steady and _near(space, active, held.last)):
                return None
            if not _pays(space, active):
                return None
            if held.pairs is None:
                held.pairs = SprungPairs(N=space.N, S=space.S, D=space.D, own=space.diagonal)
            held.pairs.renew(active)
        return held.pairs.solve(g_free, active)
    except (la.LinAlgError, InaccurateError):
        held.useless = True
        return None


def _near(space: PairSpace, active: Mask, last: Mask) -> bool:
    """Say whether few points have changed sides."""
    return bool(np.count_nonzero(active ^ last) <= NEAR * len(space.S))


def _pays(space: PairSpace, active: Mask) -> bool:
    """Say whether contact is elastic and enough pairs are in contact."""
    touched = np.count_nonzero(abs(space.N).T @ active)
    return bool((space.D > 0).all() and touched >= LEAST_TOUCHED * len(space.S))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Springs:
    """B of the active points, and its factors at the pairs they touch."""

    active: Mask
    touched: Indices
    B: SparseMatrix
    factor: Any

    def solve(self, right: Vector) -> Vector:
        """Return a y with B y = b; what of y no active point feels is arbitrary."""
        result = np.zeros_like(right)
        for _ in range(2):
            result[self.touched] += self.factor.solve((right - self.B @ result)[self.touched])
        return result


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Factor:
    """LU factors of I + B S at the pairs that the active points touch."""

    active: Mask
    touched: Indices
    lu: Matrix
    pivots: Indices
    B: SparseMatrix

    def solver(self, space: PairSpace, active: Mask) -> "_Solver":
        """Return a solver for other points in contact: Woodbury for those that changed sides."""
        changed = np.flatnonzero(active ^ self.active)
        rows = space.N[changed]
        shapes = self.solve(space.S, rows.T.toarray())
        sign = np.where(active[changed], 1.0, -1.0)
        seen = rows @ space.S
        return _Solver(
            factor=self,
            S=space.S,
            seen=seen,
            shapes=shapes,
            capacitance=np.diag(sign * space.D[changed]) + seen @ shapes,
        )

    def solve(self, S: Matrix, right: Matrix) -> Matrix:
        """Return (I + B S)⁻¹ b for b (n_relative, k) that may touch further pairs."""
        at = self.touched
        result = right.copy()
        outside = right.copy()
        outside[at] = 0.0
        reduced = right[at]
        rows = np.flatnonzero(outside.any(axis=1))
        if len(rows):
            reduced = reduced - self.B @ (S[np.ix_(at, rows)] @ outside[rows])
        result[at] = lapack.dgetrs(self.lu, self.pivots, reduced, trans=1)[0]
        return result


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Solver:
    """(I + B S + Vᵀ C V S)⁻¹ with the springs C of the points that changed sides."""

    factor: _Factor
    S: Matrix
    seen: Matrix
    shapes: Matrix
    capacitance: Matrix

    def __call__(self, right: Vector) -> Vector:
        plain = self.factor.solve(self.S, right[:, None])[:, 0]
        if not len(self.seen):
            return plain
        share = np.linalg.solve(self.capacitance, self.seen @ plain)
        result: Vector = plain - self.shapes @ share
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
    return _Springs(active=active, touched=touched, B=B, factor=factor)


def _factorize(space: PairSpace, springs: _Springs) -> _Factor:
    touched = springs.touched
    B = springs.B[touched][:, touched]
    matrix = B @ space.S[np.ix_(touched, touched)]
    matrix[np.diag_indices_from(matrix)] += 1.0
    # LAPACK works in column order: it factorizes the transpose in place.
    lu, pivots, failed = lapack.dgetrf(matrix.T, overwrite_a=1)
    if failed:
        message = "singular active block"
        raise la.LinAlgError(message)
    return _Factor(active=springs.active, touched=touched, lu=lu, pivots=pivots, B=B)
