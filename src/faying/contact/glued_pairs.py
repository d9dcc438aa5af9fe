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
from scipy.linalg import LinAlgError, cho_factor, cho_solve, lapack

from faying._typing import Indices, Matrix, SparseMatrix, Vector, frozen
from faying.contact.point_springs import PointSprings
from faying.linalg.gmres import corrected

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

DIRECT = 500
"""Pairs up to which Σ + Gᵀ K G itself is factorized: its products cost more than (F7) saves."""

MOST_CORRECTIONS = 15
"""Products of GMRES, which take as long as a factorization."""

CHANGED, MOST_CHANGED = 0.1, 20
"""Change of K at a point, over the largest K, that counts, and how many such serve for GMRES."""

MOST_BESIDE = 1.1
"""Pairs that a system may have over those of the factors at hand."""

ROWS = 256
"""Rows that are mirrored at once."""


@final
@dataclass(frozen=True, eq=False)
class Factors:
    """LU factors of (I + ΔB_cc U_cc)ᵀ.

    Attributes
    ----------
    K : (n_point, components, components) [force/length]
        What it was made of.
    pairs : (n_changed,)
        c.
    lu, pivots
        In single precision, double where that does not do.
    """

    K: Matrix
    pairs: Indices
    lu: Matrix
    pivots: Indices

    @classmethod
    def of(cls, K: Matrix, pairs: Indices, product: Matrix) -> "Factors":
        """Factorize I + ΔB_cc U_cc, given the product, which is overwritten."""
        product.flat[:: len(product) + 1] += 1.0
        return cls(K, pairs, *_factorized(product))

    def serve(self, K: Matrix) -> bool:
        """Say whether K is another at few points only."""
        changed = np.abs(K - self.K).max(axis=(1, 2)) > CHANGED * np.abs(K).max()
        return bool(np.count_nonzero(changed) <= MOST_CHANGED)

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
    points
        G, displacements at the points (components n_point, n_relative).
    springs : (components, n_point) [force/length]
        K of points that are closed and stick.
    glue : (n_relative, n_relative), sparse or dense [force/length]
        B₀.
    compliance : (n_relative, n_relative) [length/force]
        U.
    structure : (n_relative, n_relative) [force/length]
        Σ.
    """

    points: PointSprings
    springs: Matrix
    glue: SparseMatrix | Matrix
    compliance: Matrix
    structure: Matrix

    @classmethod
    def of(
        cls, G: SparseMatrix | Matrix, springs: Matrix, S: Matrix, pulled: Vector | None = None
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
        structure = frozen(_inverse(S, REGULAR))
        points = PointSprings(G=G, components=len(springs))
        if pulled is not None:
            springs = springs * _pressed(points, springs, structure, pulled)
        return cls._held(points, frozen(springs), structure)

    @classmethod
    def _held(cls, points: PointSprings, springs: Matrix, structure: Matrix) -> "GluedPairs":
        glue, both = points.of_diagonal(springs), structure.copy()
        _add(both, glue)
        compliance = frozen(_inverse(both, 0.0))
        return cls(
            points=points, springs=springs, glue=glue, compliance=compliance, structure=structure
        )

    def glued_by(self, springs: Matrix) -> "GluedPairs":
        """Return the same pairs on other springs (components, n_point) [force/length].

        Raises
        ------
        LinAlgError
            If these and the structure do not hold them.
        """
        return self._held(self.points, frozen(springs), self.structure)

    @property
    def G(self) -> SparseMatrix | Matrix:
        """Displacements at the points (components n_point, n_relative), component by component."""
        return self.points.G

    @property
    def transposed(self) -> SparseMatrix | Matrix:
        """Gᵀ, which takes forces at the points to the pairs."""
        return self.points.transposed

    @cached_property
    def _single(self) -> Matrix:
        """U in single precision."""
        return self.compliance.astype(np.float32)

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""
        return np.asarray(self.structure @ displacements)

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
            structure=self.structure - shapes.T @ np.linalg.solve(yields, shapes),
            compliance=self.compliance
            + moved @ cho_solve(cho_factor((core + core.T) / 2), moved.T),
        )

    def step(
        self, K: Matrix, right: Vector, left: float, factors: Factors | None = None
    ) -> tuple[Vector, Vector, Factors | None]:
        """Return d, Σ d and the factors used.

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
        if len(self.structure) <= DIRECT:
            if factors is None or not np.array_equal(K, factors.K):
                both = self.structure.copy()
                self.points.add_to(both, K)
                factors = Factors(K, np.arange(len(both)), *_factorized(both))
            d = factors.solve(right)
            return d, self.structure @ d, factors
        changed = K.copy()
        diagonal = np.arange(K.shape[1])
        changed[:, diagonal, diagonal] -= self.springs.T
        changed[np.abs(changed) <= UNCHANGED * self.springs.max(initial=0.0)] = 0.0
        moved = self.compliance @ right
        if not changed.any():
            return moved, right - self.glue @ moved, factors
        enough = float(np.clip(0.05 * left, ACCURATE, LOOSE)) * float(np.linalg.norm(right))
        every, pairs = self.points.between_pairs(changed), self.points.touched(changed)
        if factors is not None and factors.serve(K):
            together = np.concatenate([factors.pairs, np.setdiff1d(pairs, factors.pairs)])
            if len(together) <= MOST_BESIDE * len(factors.pairs):
                block = every[together][:, together]
                single, between = block.astype(np.float32), self._between(together)
                solution = _in_single(single, between, block @ moved[together], enough, factors)
                answer = self._answer(right, together, block, solution)
                if answer is not None:
                    return *answer, factors
        block = every[pairs][:, pairs]
        shared = block @ moved[pairs]
        # What overflows single precision is solved in double.
        with np.errstate(over="ignore", invalid="ignore"):
            single, between = block.astype(np.float32), self._between(pairs)
            try:
                factors = Factors.of(K, pairs, single @ between)
                solution = _in_single(single, between, shared, enough, factors)
            except LinAlgError:
                solution = None
        answer = self._answer(right, pairs, block, solution)
        if answer is not None:
            return *answer, factors
        product = block @ self.compliance[pairs].take(pairs, axis=1)
        exact = Factors.of(K, pairs, product).solve(shared)
        forces = right.copy()
        forces[pairs] -= exact
        d = self.compliance @ forces
        return d, forces - self.glue @ d, None

    def solved(self, springs: Matrix, right: Matrix) -> Matrix:
        """Return the solutions (n_relative, k) of right-hand sides, to round-off.

        Parameters
        ----------
        springs : (components, n_point) [force/length]
            K, of points that are closed and stick.
        """
        changed = np.zeros((springs.shape[1], len(springs), len(springs)))
        diagonal = np.arange(len(springs))
        if len(self.structure) <= DIRECT:
            changed[:, diagonal, diagonal] = springs.T
            system = self.structure.copy()
            self.points.add_to(system, changed)
            return np.asarray(np.linalg.solve(system, right))
        changed[:, diagonal, diagonal] = (springs - self.springs).T
        pairs, forces = self.points.touched(changed), right.copy()
        block = self.points.between_pairs(changed)[pairs][:, pairs]
        system = block @ self.compliance[pairs].take(pairs, axis=1)
        system.flat[:: len(pairs) + 1] += 1.0
        forces[pairs] -= np.linalg.solve(system, block @ (self.compliance[pairs] @ right))
        return self.compliance @ forces

    def _answer(
        self, right: Vector, pairs: Indices, block: SparseMatrix, shared: Vector | None
    ) -> tuple[Vector, Vector] | None:
        """Return d and Σ d of the solution m at the pairs c, where it is one."""
        if shared is None:
            return None
        forces = right.copy()
        forces[pairs] -= shared
        d = self.compliance @ forces
        residual = shared - block @ d[pairs]
        exact = np.linalg.norm(residual) <= LOOSE * np.linalg.norm(right)
        return (d, forces - self.glue @ d) if exact else None

    def _between(self, pairs: Indices) -> Matrix:
        """Return U_cc in single precision."""
        return self._single[pairs].take(pairs, axis=1)


def _factorized(matrix: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], Indices]:
    """Factorize the transpose of a matrix, which is overwritten, in its own precision."""
    factorize = lapack.sgetrf if matrix.dtype == np.float32 else lapack.dgetrf
    # LAPACK works in column order: it factorizes the transpose in place.
    lu, pivots, failed = factorize(matrix.T, overwrite_a=1)
    if failed or not np.isfinite(lu).all():
        message = "singular system of a Newton step"
        raise LinAlgError(message)
    return lu, pivots


def _in_single(
    block: SparseMatrix, between: Matrix, shared: Vector, enough: float, factors: Factors
) -> Vector | None:
    """Solve (F7) for m in single precision by factors of the first pairs, or not at all.

    Parameters
    ----------
    block, between
        ΔB_cc and U_cc in single precision.
    shared : (n_changed,) [force]
        ΔB_cc (U b)_c.
    enough
        Residual that is left [force].
    """
    n = len(factors.pairs)

    def near(right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return np.concatenate([factors.solve(right[:n]), right[n:]])

    def product(right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        solution = near(right)
        return np.asarray(solution + block @ (between @ solution))

    right = np.asarray(shared, dtype=np.float32)
    if not np.isfinite(right).all():
        return None
    reduced = corrected(product, right, enough, MOST_CORRECTIONS)
    return None if reduced is None else np.asarray(near(reduced), dtype=float)


def _pressed(points: PointSprings, springs: Matrix, stiffness: Matrix, pulled: Vector) -> Vector:
    """Return ones (n_point,) at points that the bolts press on, all of them where none is left."""
    every = np.ones(springs.shape[1])
    pressed = every
    for _ in range(ROUNDS):
        glue = points.of_diagonal(springs * pressed)
        # Which points they are needs few digits.
        system = stiffness.astype(np.float32)
        _add(system, glue)
        factor = cho_factor(system, overwrite_a=True)
        moved = pulled - cho_solve(factor, (glue @ pulled).astype(np.float32))
        previous, pressed = pressed, 1.0 * (points.G[: len(every)] @ moved < 0)
        if np.array_equal(previous, pressed):
            break
    return pressed if pressed.any() else every


def _add(matrix: npt.NDArray[Any], entries: SparseMatrix | Matrix) -> None:
    """Add a matrix, sparse without duplicates or dense, to a dense one in its place."""
    if isinstance(entries, np.ndarray):
        matrix += entries
        return
    where = entries.tocoo()
    matrix[where.row, where.col] += where.data


def _inverse(matrix: Matrix, smallest: float) -> Matrix:
    """Return the inverse of a positive definite matrix, by Cholesky.

    Raises
    ------
    LinAlgError
        If a squared pivot is not positive, or below ``least`` times the largest.
    """
    lower, failed = lapack.dpotrf(matrix, lower=1, clean=0)
    pivots = np.diag(lower)
    if failed or pivots.min(initial=1) ** 2 < smallest * pivots.max(initial=1) ** 2:
        message = "the matrix is not positive definite"
        raise LinAlgError(message)
    inverse: Matrix = np.ascontiguousarray(lapack.dpotri(lower, lower=1, overwrite_c=1)[0])
    for row in range(0, len(inverse), ROWS):
        strip = slice(row, row + ROWS)
        inverse[strip, row + ROWS :] = inverse[row + ROWS :, strip].T
        corner = inverse[strip, strip]
        inverse[strip, strip] = np.tril(corner) + np.tril(corner, -1).T
    return inverse
