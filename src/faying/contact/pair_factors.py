"""Factors between changed pairs, reused from step to step and updated where few points change."""

import threading
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, lapack

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.contact.held_pairs import HeldPairs
from faying.contact.point_springs import PointSprings

STIFFNESS_CHANGE = 0.1
"""Change of K at a point, over the largest K, above which factors are updated; else by GMRES."""

MOST_UPDATED = 0.15
"""Updated rows over all rows of factors above which new factors take no longer."""

IN_CACHE = 64
"""Rows gathered at a time: 0.046 s for 6500 by 5500 of 8160 numbers, instead of 0.083 s for all."""


class Room(threading.local):
    """Memory that the systems of successive steps share, separate for each thread.

    Clearing new pages takes as long as filling them: a quarter of the time of steps of 3000 rows.
    """

    def __init__(self, largest: int) -> None:
        self._largest = largest
        self._between = np.empty(8 * largest**2, dtype=np.uint8)
        self._factors = np.empty(4 * largest**2, dtype=np.uint8)

    def __reduce__(self) -> tuple[type[Self], tuple[int]]:
        """Pickle the size alone; other processes allocate memory of their own."""
        return type(self), (self._largest,)

    def between(self, n_rows: int, n_columns: int, like: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return an array that the next call overwrites."""
        return _view(self._between, n_rows, n_columns, like.dtype)

    def factors(self, n: int) -> npt.NDArray[np.float32]:
        """Return an array that the next call overwrites."""
        return _view(self._factors, n, n, np.dtype(np.float32))


def _view(
    memory: npt.NDArray[np.uint8], n_rows: int, n_columns: int, dtype: np.dtype[Any]
) -> npt.NDArray[Any]:
    used = memory[: n_rows * n_columns * dtype.itemsize]
    return used.view(dtype).reshape(n_rows, n_columns)


@dataclass(frozen=True, eq=False)
class LU:
    """LU factors of the transpose of a matrix, in its own precision."""

    lu: npt.NDArray[Any]
    pivots: Indices

    @classmethod
    def of(cls, matrix: npt.NDArray[Any]) -> Self:
        """Factorize a matrix, which is overwritten."""
        factorize = lapack.sgetrf if matrix.dtype == np.float32 else lapack.dgetrf
        # LAPACK works in column order: it factorizes the transpose in place.
        lu, pivots, failed = factorize(matrix.T, overwrite_a=1)
        if failed or not np.isfinite(lu).all():
            message = "singular system of a Newton step"
            raise LinAlgError(message)
        return cls(lu, pivots)

    def solve(self, right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return the solution of right-hand sides, in the precision of the factors."""
        substitute = lapack.sgetrs if self.lu.dtype == np.float32 else lapack.dgetrs
        right = np.asarray(right, dtype=self.lu.dtype)
        return np.asarray(substitute(self.lu, self.pivots, right, trans=1)[0])


@dataclass(frozen=True, eq=False)
class WholeFactors:
    """Factors of Σ + B for some K (n_point, components, components) [force/length]."""

    K: Matrix
    lu: LU


@dataclass(frozen=True, eq=False)
class PairSystem:
    """The matrix I + ΔB_rc U_cr.

    Attributes
    ----------
    rows, columns
        r and c.
    block : (n_row, n_column) sparse
        ΔB_rc.
    between : (n_column, n_row)
        U_cr; to gather it takes as long as two products with it.
    """

    rows: Indices
    columns: Indices
    block: SparseMatrix
    between: Matrix

    def times(self, solution: Vector) -> Vector:
        """Return the product of the matrix with a vector."""
        moved = self.between @ solution.astype(self.between.dtype, copy=False)
        return np.asarray(solution + self.block @ moved)

    def factorized(self, product: npt.NDArray[Any]) -> LU:
        """Return the factors of the matrix, in its precision and in the memory of ``product``."""
        block = self.block.astype(product.dtype)
        between = self.between.astype(product.dtype, copy=False)
        for first in range(0, len(product), IN_CACHE):
            product[first : first + IN_CACHE] = block[first : first + IN_CACHE] @ between
        product.flat[:: len(product) + 1] += 1.0
        return LU.of(product)


@dataclass(frozen=True, eq=False)
class Factors:
    """Factors of a system between changed pairs: those of an earlier K, and an update to this K.

    Attributes
    ----------
    reference
        Pairs of U.
    K : (n_point, components, components) [force/length]
    system
        System of K.
    first, first_system, lu
        K and system that were factorized, in single precision.
    update
        None where K is the first one.
    """

    reference: HeldPairs
    K: Matrix
    system: PairSystem
    first: Matrix
    first_system: PairSystem
    lu: LU
    update: "Update | None" = None

    @classmethod
    def of(cls, reference: HeldPairs, K: Matrix, system: PairSystem, room: Room) -> Self:
        """Return the factors of a system, stored in the shared memory."""
        lu = system.factorized(room.factors(len(system.rows)))
        return cls(reference, K, system, K, system, lu)

    def solve(self, right: Vector) -> Vector:
        """Return the solution of a right-hand side at the rows."""
        solver = self.lu if self.update is None else self.update
        return np.asarray(solver.solve(right), dtype=float)

    def updated(self, K: Matrix, rows: Indices, points: PointSprings) -> "Factors | None":
        """Return factors for K at more rows; None where new factors take no longer.

        By Woodbury's formula for the rows of points whose K changes, or for the components of these
        points where they are fewer, as for isolated points.
        """
        if np.isin(rows, self.system.rows).all() and not _large_change(K, self.K).any():
            return self
        base, change = self.first_system, _large_change(K, self.first)
        added, (acting, feeling) = np.setdiff1d(rows, base.rows), points.touched(change)
        components = points.components_of(change)
        if min(len(acting), len(components)) + len(added) > MOST_UPDATED * len(base.rows):
            return None
        together, compliance = np.concatenate([base.rows, added]), self.reference.compliance
        coupling = base.block @ compliance[np.ix_(base.columns, added)]
        if len(acting) <= len(components):
            places = (together[:, None] == acting).astype(np.float32)
            block = points.between_pairs(change)[acting]
        else:
            places = points.transposed[together][:, components].toarray().astype(np.float32)
            block = points.felt_along(components, change)
        felt = block[:, feeling] @ compliance[np.ix_(feeling, together)]
        update = Update(self.lu, places, coupling.astype(np.float32), felt.astype(np.float32))
        return replace(self, K=K, system=replace(self.system, rows=together), update=update)


@dataclass(frozen=True, eq=False)
class Update:
    """Correction of factors for another K and more rows.

    Attributes
    ----------
    lu
        The factors.
    places : (n_row + n_more, n_acting)
        Rows on which the changes act: single rows, or those of a component at a point.
    coupling : (n_row, n_more)
        ΔB U between the rows of the factors and the added ones.
    felt : (n_acting, n_row + n_more)
        The change of ΔB, times U.
    """

    lu: LU
    places: npt.NDArray[np.float32]
    coupling: npt.NDArray[np.float32]
    felt: npt.NDArray[np.float32]

    def solve(self, right: Vector) -> npt.NDArray[np.float32]:
        """Return the solution of a right-hand side at all rows."""
        solution = self._before(right.astype(np.float32))
        return np.asarray(solution - self._answers @ (self.felt @ solution))

    def _before(self, right: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Return the solution for the factorized K."""
        n = len(self.coupling)
        solved = self.lu.solve(right[:n] - self.coupling @ right[n:])
        return np.concatenate([solved, right[n:]])

    @cached_property
    def _answers(self) -> npt.NDArray[np.float32]:
        """Solution of the changed system for forces at ``places``."""
        answers = self._before(self.places)
        core = self.felt @ answers
        core.flat[:: len(core) + 1] += 1.0
        return np.asarray(answers @ np.linalg.inv(core))


def _large_change(K: Matrix, previous: Matrix) -> Matrix:
    """Return K − previous at points where it is large, else zero."""
    change = K - previous
    change[np.abs(change).max(axis=(1, 2)) <= STIFFNESS_CHANGE * np.abs(K).max()] = 0.0
    return change
