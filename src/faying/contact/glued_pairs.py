"""Pairs on the springs of points that are all closed and stick: what Newton steps are solved with.

With Σ = S⁻¹, the stiffness of the structure between pairs, and B = Gᵀ K G, that of the points, a
Newton step is (Σ + B) d = b. One inverse U = (Σ + B₀)⁻¹, with all points closed and stuck, serves
every step: where only the points of pairs c are otherwise, ΔB = B − B₀ vanishes elsewhere, and

    (I + ΔB_cc U_cc) m = ΔB_cc (U b)_c,   d = U (b − m).                                    (F7)

U exists where bolts and contact alone hold a part.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, final

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.linalg import LinAlgError, cho_factor, cho_solve, lapack

from faying._typing import Indices, Matrix, SparseMatrix, Vector, frozen, read_only

REGULAR = 1e-11
"""Smallest over largest squared pivot of S from which it has an inverse worth using.

Springs of 1 N/mm beside elasticity leave 1e-7, a basis of fewer modes than pairs 1e-16.
"""

ROUNDS = 3
"""Times that points which the bolts pull apart are opened; the rest is left to Newton's method."""

UNCHANGED = 1e-12
"""Change of K at a point, over the largest K, that is round-off."""

ACCURATE, LOOSE = 1e-5, 1e-3
"""Relative residuals of (F7): single precision leaves 1e-6, Newton's method corrects the rest."""

MOST_CORRECTIONS = 8
"""Corrections of a solution in single precision; two or three are usual."""

SLOWEST = 0.25
"""What a correction must leave of the residual at most for the factors to serve."""


@final
@dataclass(frozen=True, eq=False)
class Factors:
    """LU factors of (I + ΔB_cc U_cc)ᵀ.

    Attributes
    ----------
    pairs : (n_changed,)
        c.
    lu, pivots
        In single precision, double where that does not do.
    """

    pairs: Indices
    lu: Matrix
    pivots: Indices

    @classmethod
    def of(cls, pairs: Indices, product: Matrix) -> "Factors":
        """Factorize I + ΔB_cc U_cc, given the product, which is overwritten."""
        product.flat[:: len(product) + 1] += 1.0
        single = product.dtype == np.float32
        factorize = lapack.sgetrf if single else lapack.dgetrf
        # LAPACK works in column order: it factorizes the transpose in place.
        lu, pivots, failed = factorize(product.T, overwrite_a=1)
        if failed or not np.isfinite(lu).all():
            message = "singular system of a Newton step"
            raise LinAlgError(message)
        return cls(pairs, lu, pivots)

    def solve(self, right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return the solution of a right-hand side at the pairs c."""
        single = self.lu.dtype == np.float32
        substitute = lapack.sgetrs if single else lapack.dgetrs
        return np.asarray(substitute(self.lu, self.pivots, right, trans=1)[0])


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class GluedPairs:
    """Solves (Σ + Gᵀ K G) d = b.

    Attributes
    ----------
    G : (components n_point, n_relative) sparse
        Displacements at the points, component by component.
    springs : (components, n_point) [force/length]
        K of points that are closed and stick.
    compliance : (n_relative, n_relative) [length/force]
        U.
    stiffness : (n_relative, n_relative) [force/length]
        Σ + B₀.
    """

    G: SparseMatrix
    springs: Matrix
    compliance: Matrix
    stiffness: Matrix

    @classmethod
    def of(
        cls, G: SparseMatrix, springs: Matrix, S: Matrix, pulled: Vector | None = None
    ) -> "GluedPairs":
        """Return the pairs of a structure whose compliance between them is S.

        Parameters
        ----------
        pulled : (n_relative,) or None [length]
            Relative displacements that the bolts alone would cause: points that they do not press
            on are left open, so that fewer change sides afterwards.

        Raises
        ------
        LinAlgError
            If S is not positive definite beyond round-off.

        Notes
        -----
        Two inverses, 2 n³ multiplications for n relative displacements, and up to three
        factorizations to find the points that bolts press on.
        """
        stiffness = _inverse(S, REGULAR)
        if pulled is not None:
            springs = springs * _pressed(G, springs, stiffness, pulled)
        _add(stiffness, (G.T @ sp.diags_array(springs.ravel()) @ G).tocsr())
        return cls(
            G=read_only(G),
            springs=frozen(springs),
            compliance=frozen(_inverse(stiffness, 0.0)),
            stiffness=frozen(stiffness),
        )

    @cached_property
    def transposed(self) -> SparseMatrix:
        """Gᵀ, which takes forces at the points to the pairs."""
        return read_only(self.G.T.tocsr())

    @cached_property
    def glue(self) -> SparseMatrix:
        """B₀ (n_relative, n_relative)."""
        return read_only((self.transposed @ sp.diags_array(self.springs.ravel()) @ self.G).tocsr())

    @cached_property
    def _single(self) -> Matrix:
        """U in single precision."""
        return self.compliance.astype(np.float32)

    @cached_property
    def _touching(self) -> SparseMatrix:
        """Which pairs a point touches (n_relative, n_point)."""
        n = self.springs.shape[1]
        pattern = abs(self.G)
        parts = [pattern[start : start + n] for start in range(0, self.G.shape[0], n)]
        return sum(parts[1:], parts[0]).T.tocsr()

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""
        return np.asarray(self.stiffness @ displacements - self.glue @ displacements)

    def loosened(self, shapes: Matrix, yields: Matrix) -> "GluedPairs":
        """Return the pairs of the structure less springs across it (T1).

        Parameters
        ----------
        shapes : (n_spring, n_relative) [1]
            z, forces between pairs per initial force of each spring.
        yields : (n_spring, n_spring) [length/force]
            What a spring yields to its initial force with the pairs held.
        """
        moved = self.compliance @ shapes.T
        core = yields - shapes @ moved
        return replace(
            self,
            stiffness=self.stiffness - shapes.T @ np.linalg.solve(yields, shapes),
            compliance=self.compliance
            + moved @ cho_solve(cho_factor((core + core.T) / 2), moved.T),
        )

    def step(
        self, K: Matrix, right: Vector, left: float, factors: Factors | None = None
    ) -> tuple[Vector, Vector, Factors | None]:
        """Return d, (Σ + B₀) d and the factors used.

        Parameters
        ----------
        K : (n_point, components, components) [force/length]
        left
            Residual of Newton's method over the largest force, which says how exact is enough.
        factors
            Of the step before.

        Notes
        -----
        Two products with U, and factors of as many rows as points that changed sides touch.
        """
        changed = K.copy()
        diagonal = np.arange(K.shape[1])
        changed[:, diagonal, diagonal] -= self.springs.T
        changed[np.abs(changed) <= UNCHANGED * self.springs.max(initial=0.0)] = 0.0
        moved = self.compliance @ right
        if not changed.any():
            return moved, right, factors
        pairs, block = self._block(changed)
        enough = float(np.clip(0.05 * left, ACCURATE, LOOSE))
        shared = block @ moved[pairs]
        # What overflows single precision is solved in double.
        with np.errstate(over="ignore", invalid="ignore"):
            found = self._in_single(pairs, block, shared, enough, factors)
        if found is not None:
            forces, d = self._answer(right, pairs, found[0])
            rest = right[pairs] - forces[pairs] - block @ d[pairs]
            if np.linalg.norm(rest) <= LOOSE * np.linalg.norm(right):
                return d, forces, found[1]
        product = block @ self.compliance[pairs].take(pairs, axis=1)
        exact = Factors.of(pairs, product)
        forces, d = self._answer(right, pairs, exact.solve(shared))
        return d, forces, None

    def _answer(self, right: Vector, pairs: Indices, shared: Vector) -> tuple[Vector, Vector]:
        """Return (Σ + B₀) d and d of the solution m at the pairs c."""
        forces = right.copy()
        forces[pairs] -= shared
        return forces, self.compliance @ forces

    def _block(self, changed: Matrix) -> tuple[Indices, SparseMatrix]:
        """Return the pairs c that changed points touch, and ΔB_cc."""
        k, n = self.springs.shape
        points = np.flatnonzero(changed.any(axis=(1, 2)))
        touched = np.zeros(n)
        touched[points] = 1.0
        pairs = np.flatnonzero(self._touching @ touched)
        number = np.full(self.G.shape[1], -1)
        number[pairs] = np.arange(len(pairs))
        rows = (n * np.arange(k)[:, None] + points).ravel()
        G = self.G[rows]
        G = sp.csr_array((G.data, number[G.indices], G.indptr), shape=(len(rows), len(pairs)))
        which = np.arange(len(points))
        shape = (k, k, len(points))
        place = len(points) * np.arange(k)
        first = np.broadcast_to(place[:, None, None] + which, shape).ravel()
        second = np.broadcast_to(place[None, :, None] + which, shape).ravel()
        data = changed[points].transpose(1, 2, 0).ravel()
        local = sp.csr_array((data, (first, second)), shape=(len(rows), len(rows)))
        return pairs, (G.T @ (local @ G)).tocsr()

    def _in_single(
        self,
        pairs: Indices,
        block: SparseMatrix,
        right: Vector,
        enough: float,
        factors: Factors | None,
    ) -> tuple[Vector, Factors] | None:
        """Solve (F7) for m in single precision, with factors at hand where they serve."""
        single, b = block.astype(np.float32), np.asarray(right, dtype=np.float32)
        between = self._single[pairs].take(pairs, axis=1)
        if factors is not None and np.array_equal(factors.pairs, pairs):
            found = _corrected(single, between, b, enough, factors)
            if found is not None:
                return found, factors
        try:
            factors = Factors.of(pairs, single @ between)
        except LinAlgError:
            return None
        found = _corrected(single, between, b, enough, factors)
        return None if found is None else (found, factors)


def _corrected(
    block: SparseMatrix,
    between: Matrix,
    right: npt.NDArray[np.float32],
    enough: float,
    factors: Factors,
) -> Vector | None:
    """Solve (F7) by factors of a similar system and corrections, or not at all."""
    solution, rest = np.zeros_like(right), right
    size = before = float(np.linalg.norm(right))
    for _ in range(MOST_CORRECTIONS):
        solution = solution + factors.solve(rest).astype(right.dtype)
        rest = right - solution - block @ (between @ solution)
        after = float(np.linalg.norm(rest))
        if after <= enough * size:
            return np.asarray(solution, dtype=float)
        if not after <= SLOWEST * before:
            return None
        before = after
    return None


def _pressed(G: SparseMatrix, springs: Matrix, stiffness: Matrix, pulled: Vector) -> Vector:
    """Return ones (n_point,) at points that the bolts press on, all of them where none is left."""
    every = np.ones(springs.shape[1])
    pressed = every
    for _ in range(ROUNDS):
        glue = (G.T @ sp.diags_array((springs * pressed).ravel()) @ G).tocsr()
        system = stiffness.copy()
        _add(system, glue)
        moved = pulled - cho_solve(cho_factor(system, overwrite_a=True), glue @ pulled)
        before, pressed = pressed, 1.0 * (G[: len(every)] @ moved < 0)
        if np.array_equal(before, pressed):
            break
    return pressed if pressed.any() else every


def _add(matrix: Matrix, entries: SparseMatrix) -> None:
    """Add a sparse matrix without duplicates to a dense one in its place."""
    where = entries.tocoo()
    matrix[where.row, where.col] += where.data


def _inverse(matrix: Matrix, least: float) -> Matrix:
    """Return the inverse of a positive definite matrix, by Cholesky.

    Raises
    ------
    LinAlgError
        If a squared pivot is not positive, or below ``least`` times the largest.
    """
    lower, failed = lapack.dpotrf(matrix, lower=1, clean=0)
    pivots = np.diag(lower)
    if failed or pivots.min(initial=1) ** 2 < least * pivots.max(initial=1) ** 2:
        message = "the matrix is not positive definite"
        raise LinAlgError(message)
    inverse = lapack.dpotri(lower, lower=1, overwrite_c=1)[0]
    whole: Matrix = np.tril(inverse)
    whole += np.tril(inverse, -1).T
    return whole
