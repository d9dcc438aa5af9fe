"""The structure between pairs on springs at its points: the inverses that Newton steps begin from.

Σ = S⁻¹ is the stiffness of the structure, and U = (Σ + Gᵀ K₀ G)⁻¹.
"""

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, cho_factor, cho_solve, lapack, solve_triangular

from faying._typing import Matrix, SparseMatrix, Vector, frozen
from faying.contact.point_springs import PointSprings

REGULAR = 1e-11
"""Smallest over largest squared pivot of S from which it has an inverse worth using.

Springs of 1 N/mm beside elasticity leave 1e-7, a basis of fewer modes than pairs 1e-16.
"""

ROUNDS = 3
"""Times that points which the bolts pull apart are opened; the rest is left to Newton's method."""

UNCHANGED = 1e-12
"""Change of K at a point, over the largest K, that is round-off."""

FREE, MOST_ANCHORS = 100.0, 100
"""Motion of a pair beside that of its springs, from which a point there is kept closed.

Factors in single precision have seven digits. A body that weak springs alone hold has 1e5.
"""

ROWS = 256
"""Rows that are mirrored at once."""


@final
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
    compliance: Matrix

    @classmethod
    def on_springs(cls, points: PointSprings, springs: Matrix, structure: Matrix) -> "HeldPairs":
        """Return a structure Σ on springs (components, n_point) at its points.

        Raises
        ------
        LinAlgError
            If these and the structure do not hold it.
        """
        glue, both = points.of_diagonal(springs), structure.copy()
        _add(both, glue)
        return cls(frozen(springs), glue, frozen(inverse(both)))

    def change_to(self, K: Matrix) -> Matrix:
        """Return K − K₀ (n_point, components, components), round-off taken for nothing."""
        change, diagonal = K.copy(), np.arange(K.shape[1])
        change[:, diagonal, diagonal] -= self.springs.T
        change[np.abs(change) <= UNCHANGED * np.abs(K).max(initial=0.0)] = 0.0
        return change

    def loosened(self, shapes: Matrix, yields: Matrix) -> "HeldPairs":
        """Return them less springs across the structure; see :meth:`GluedPairs.loosened`."""
        moved = self.compliance @ shapes.T
        core = yields - shapes @ moved
        more = moved @ cho_solve(cho_factor((core + core.T) / 2), moved.T)
        return replace(self, compliance=self.compliance + more)


def anchored_pairs(points: PointSprings, springs: Matrix, S: Matrix) -> HeldPairs:
    """Return a structure held at the points that move most, as long as these move far.

    Cholesky's method with pivots finds them, and takes what they hold out of S.
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
    return HeldPairs(anchors, points.of_diagonal(anchors), S - half.T @ half if chosen else S)


def pressed_points(points: PointSprings, springs: Matrix, S: Matrix, pulled: Vector) -> Vector:
    """Return ones (n_point,) at points that the bolts press on, all of them where none is left.

    Along normals alone: what sticks there makes little difference.
    """
    every = np.ones(springs.shape[1])
    gaps = points.G[: len(every)]
    felt = np.flatnonzero(abs(gaps).sum(axis=0))
    normal = PointSprings(G=gaps[:, felt], components=1)
    stiffness, moved = inverse(S[felt].take(felt, axis=1)), pulled[felt]
    pressed = every
    for _ in range(ROUNDS):
        glue, system = normal.of_diagonal(springs[:1] * pressed), stiffness.copy()
        _add(system, glue)
        lifted = moved - cho_solve(cho_factor(system, overwrite_a=True), glue @ moved)
        previous, pressed = pressed, 1.0 * (normal.G @ lifted < 0)
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


def inverse(matrix: Matrix, smallest: float = 0.0) -> Matrix:
    """Return the inverse of a positive definite matrix, by Cholesky.

    Raises
    ------
    LinAlgError
        If a squared pivot is not positive, or below ``smallest`` times the largest.
    """
    lower, failed = lapack.dpotrf(matrix, lower=1, clean=0)
    pivots = np.diag(lower)
    if failed or pivots.min(initial=1) ** 2 < smallest * pivots.max(initial=1) ** 2:
        message = "the matrix is not positive definite"
        raise LinAlgError(message)
    whole: Matrix = np.ascontiguousarray(lapack.dpotri(lower, lower=1, overwrite_c=1)[0])
    for row in range(0, len(whole), ROWS):
        strip = slice(row, row + ROWS)
        whole[strip, row + ROWS :] = whole[row + ROWS :, strip].T
        corner = whole[strip, strip]
        whole[strip, strip] = np.tril(corner) + np.tril(corner, -1).T
    return whole
