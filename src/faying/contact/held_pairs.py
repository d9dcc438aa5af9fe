"""The structure between pairs on springs at its points: inverses that Newton steps start from.

Σ = S⁻¹ is the stiffness of the structure, and U = (Σ + Gᵀ K₀ G)⁻¹, in single precision where U
serves Newton steps alone.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import (
    LinAlgError,
    blas,
    cho_factor,
    cho_solve,
    eigh,
    lapack,
    solve_triangular,
)

from faying._typing import Indices, Matrix, SparseMatrix, Vector, frozen
from faying.contact.point_springs import PointSprings
from faying.digits import ROUND_OFF
from faying.iterations import RETRIES
from faying.linalg.cholesky import inverse

FREE, MOST_ANCHORS = 100.0, 100
"""Motion of a pair over its springs' above which a point there is kept closed; most such points.

Factors in single precision have seven digits. For a body on weak springs alone it is 1e5.
"""

SMALLEST_SINGLE_PIVOT = 1e-4
"""Smallest over largest squared pivot above which U in single precision suffices for steps.

The residual is then 6e-8 over this ratio, and Newton's method reduces it further (1e-6 on a roof
and a flange with ratios of 1e-2 and 6e-2).
"""


@dataclass(frozen=True, eq=False)
class HeldPairs:
    """The structure on springs at its points.

    Attributes
    ----------
    springs : (components, n_point) [force/length]
        K₀, diagonal.
    glue : (n_relative, n_relative), sparse or dense [force/length]
        B₀.
    compliance : (n_relative, n_relative) [length/force]
        U.
    """

    springs: Matrix
    glue: SparseMatrix | Matrix
    compliance: npt.NDArray[Any]

    @classmethod
    def on_springs(cls, points: PointSprings, springs: Matrix, structure: Matrix) -> "HeldPairs":
        """Return a structure Σ on springs (components, n_point) at its points.

        Raises
        ------
        LinAlgError
            If structure and springs leave a pair free to move.
        """
        return cls._invert(points, springs, structure.astype(np.float64), 0.0)

    @classmethod
    def for_steps(cls, points: PointSprings, springs: Matrix, structure: Matrix) -> "HeldPairs":
        """Return the pairs as :meth:`on_springs` does, for Newton steps, which correct errors of U.

        U is in single precision where that suffices.
        """
        single = structure.astype(np.float32)
        try:
            return cls._invert(points, springs, single, SMALLEST_SINGLE_PIVOT)
        except LinAlgError:
            return cls.on_springs(points, springs, structure)

    @classmethod
    def _invert(
        cls, points: PointSprings, springs: Matrix, structure: npt.NDArray[Any], smallest: float
    ) -> "HeldPairs":
        """Return the pairs with U in the precision of ``structure``, which is overwritten."""
        glue = points.of_diagonal(springs)
        _add(structure, glue)
        return cls(frozen(springs), glue, inverse(structure, smallest, overwrite=True))

    def moved_by(self, forces: Vector) -> Vector:
        """Return U times forces (n_relative,)."""
        return symmetric_product(self.compliance, forces)

    def loosened(self, structure: Matrix, shapes: Matrix, yields: Matrix) -> "HeldPairs":
        """Return the pairs of a structure Σ without some springs (:meth:`GluedPairs.loosened`).

        In double precision where these springs give a part nearly all its support.
        """
        moved = np.array([self.moved_by(shape) for shape in shapes]).T
        left = shapes.T - structure @ moved - self.glue @ moved
        moved += np.array([self.moved_by(column) for column in left.T]).T
        core = yields - shapes @ moved
        core = (core + core.T) / 2
        more = moved @ cho_solve(cho_factor(core), moved.T)
        if eigh(core, yields, eigvals_only=True)[0] > SMALLEST_SINGLE_PIVOT:
            more = more.astype(self.compliance.dtype)
        return replace(self, compliance=self.compliance + more)


def change_from(springs: Matrix, K: Matrix) -> Matrix:
    """Return K − K₀ (n_point, components, components); changes within round-off are zero."""
    change, diagonal = K.copy(), np.arange(K.shape[1])
    change[:, diagonal, diagonal] -= springs.T
    change[np.abs(change) <= ROUND_OFF * np.abs(K).max(initial=0.0)] = 0.0
    return change


def anchored_pairs(points: PointSprings, springs: Matrix, S: Matrix) -> HeldPairs:
    """Return a structure held at the points that move most, as long as they move far.

    Pivots of Cholesky's method choose the points and remove their share from S. The result is in
    single precision and serves Newton steps alone.
    """
    sprung = points.of_diagonal(springs).diagonal()
    remaining, shapes = sprung * np.diag(S), np.empty((0, len(S)))
    chosen = list[int]()
    n = springs.shape[1]
    while len(chosen) < MOST_ANCHORS and remaining.max(initial=0.0) > FREE:
        pivot = int(remaining.argmax())
        column = S[pivot] - shapes[:, pivot] @ shapes
        shapes = np.vstack([shapes, column / np.sqrt(column[pivot])])
        remaining -= sprung * shapes[-1] ** 2
        chosen.append(int(points.strongest(pivot)) % n)
    anchors = springs * np.isin(np.arange(n), chosen)
    rows = np.flatnonzero(anchors)
    felt = np.asarray(points.G[rows] @ S)
    core = np.diag(1.0 / anchors.ravel()[rows]) + np.asarray(points.G[rows] @ felt.T)
    half = solve_triangular(np.linalg.cholesky((core + core.T) / 2), felt, lower=True)
    compliance = (S - half.T @ half if chosen else S).astype(np.float32)
    return HeldPairs(anchors, points.of_diagonal(anchors), compliance)


def symmetric_product(matrix: npt.NDArray[Any], vector: Vector) -> Vector:
    """Return the product of a symmetric matrix, of which one triangle is read, with a vector."""
    if not vector.size:
        return vector
    multiply = blas.ssymv if matrix.dtype == np.float32 else blas.dsymv
    return np.asarray(multiply(1.0, matrix.T, vector, lower=1), dtype=float)


@dataclass(frozen=True, eq=False)
class NormalPairs:
    """The structure along the normals of its points; tangential displacements are held.

    In single precision, which suffices for steps that later ones correct.

    Attributes
    ----------
    felt : (n_felt,)
        Relative displacements that change gaps.
    points
        Gaps from these displacements.
    structure : (n_felt, n_felt) [force/length]
        Σ between them.
    """

    felt: Indices
    points: PointSprings
    structure: npt.NDArray[np.float32]

    @classmethod
    def of(cls, points: PointSprings, structure: Matrix) -> "NormalPairs":
        """Return the normal pairs of a structure Σ between all relative displacements."""
        gaps = points.G[: points.G.shape[0] // points.components]
        felt = np.flatnonzero(abs(gaps).sum(axis=0))
        normal = PointSprings(G=gaps[:, felt], components=1)
        return cls(felt, normal, structure[np.ix_(felt, felt)].astype(np.float32))

    def moved_by(self, forces: Vector, springs: Vector) -> Vector | None:
        """Return d (n_felt,) under forces, on springs (n_point,); None if a part stays free."""
        system = self.structure.copy()
        _add(system, self.points.of_diagonal(springs[None]))
        _, moved, failed = lapack.sposv(system.T, forces.astype(np.float32), lower=1, overwrite_a=1)
        return None if failed else np.asarray(moved, dtype=float)

    def pressed(self, springs: Vector, pull: Vector) -> Vector:
        """Return ones (n_point,) at points that the bolts press together; if none, at all points.

        ``pull`` (n_felt,) are forces that pull the pairs apart; slip makes little difference.
        """
        pressed = every = np.ones(len(springs))
        for _ in range(RETRIES):
            lifted = self.moved_by(pull, springs * pressed)
            if lifted is None:
                break
            previous, pressed = pressed, np.where(self.points.G @ lifted < 0, 1.0, 0.0)
            if np.array_equal(previous, pressed):
                break
        return pressed if pressed.any() else every


def _add(matrix: npt.NDArray[Any], entries: SparseMatrix | Matrix) -> None:
    """Add a sparse matrix without duplicates, or a dense one, to a dense matrix in place."""
    if isinstance(entries, np.ndarray):
        matrix += entries
        return
    where = entries.tocoo()
    matrix[where.row, where.col] += where.data
