"""Symmetric compliances too large to be kept entry by entry: blocks of low rank.

Pairs far from each other feel each other smoothly, so the block of two clusters has low numerical
rank (block low-rank matrices: Amestoy et al. 2015, doi:10.1137/120903476). Blocks are formed
exactly, a few columns at a time, and truncated by cross approximation with full pivoting (Bebendorf
2000, doi:10.1007/PL00005410), which knows the error it leaves.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias, final

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector
from faying.linalg.clusters import CLUSTER, geometric_clusters

TOLERANCE = 1e-9
"""Frobenius norm of all that truncation leaves out, over the least diagonal entry of a sample."""

ROWS = 256
"""Rows that are turned around at once, so that they stay in the processor's cache."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class CompressedCompliance:
    """S ≈ blocks of low rank + X C Xᵀ, symmetric.

    Attributes
    ----------
    clusters
        Indices of the members of each cluster; every index once.
    diagonal
        Dense block of each cluster.
    factors
        For each cluster I the factors X_IJ of all blocks S_IJ = X_IJ X_JIᵀ, side by side.
    ranks : (n_cluster, n_cluster)
        Columns of X_IJ, which follow one another in the order of J.
    smooth, core : (n, k), (k, k)
        X and C of what is known in factored form.
    places : (n, 3) [length]
        Where the rows belong to.
    error
        Bound on ‖S − S̃‖ in the Frobenius norm.
    """

    clusters: tuple[Indices, ...]
    diagonal: tuple[Matrix, ...]
    factors: tuple[Matrix, ...]
    ranks: Indices
    smooth: Matrix
    core: Matrix
    places: Matrix
    error: float

    def __post_init__(self) -> None:
        # One order in memory, so that products have the same digits however the parts were made.
        for name in ("diagonal", "factors"):
            object.__setattr__(self, name, tuple(map(np.ascontiguousarray, getattr(self, name))))
        for name in ("smooth", "core"):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name)))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""
        return len(self.smooth), len(self.smooth)

    @cached_property
    def starts(self) -> Indices:
        """Number of the first column of each X_IJ when the columns of all factors are numbered."""
        ends = np.cumsum(self.ranks.ravel())
        return (ends - self.ranks.ravel()).reshape(self.ranks.shape)

    @cached_property
    def exchange(self) -> Indices:
        """Where among all columns of all factors the partner of each column is."""
        count = int(self.ranks.sum())
        within = np.arange(count) - np.repeat(self.starts.ravel(), self.ranks.ravel())
        return np.repeat(self.starts.T.ravel(), self.ranks.ravel()) + within

    @property
    def n_bytes(self) -> int:
        """Memory of all parts [bytes]."""
        parts = [*self.diagonal, *self.factors, self.smooth]
        return sum(part.nbytes for part in parts)

    def __matmul__(self, vectors: Matrix) -> Matrix:
        """Return S x for x of shape (n,) or (n, k)."""
        result: Matrix = self.smooth @ (self.core @ (self.smooth.T @ vectors))
        parts = [vectors[members] for members in self.clusters]
        if not parts:
            return result
        seen = [X.T @ part for X, part in zip(self.factors, parts, strict=True)]
        sent = np.concatenate(seen)[self.exchange]
        start = 0
        blocks = zip(self.clusters, self.diagonal, self.factors, parts, strict=True)
        for members, dense, factor, part in blocks:
            result[members] += dense @ part + factor @ sent[start : start + factor.shape[1]]
            start += factor.shape[1]
        return result

    def block(self, cluster: int) -> Matrix:
        """Return the principal submatrix of one cluster, all parts included."""
        smooth = self.smooth[self.clusters[cluster]]
        return np.asarray(self.diagonal[cluster] + smooth @ self.core @ smooth.T)

    def principal(self, rows: Indices) -> Matrix:
        """Return the dense submatrix of some rows and the same columns, without duplicates."""
        smooth = self.smooth[rows]
        result: Matrix = smooth @ self.core @ smooth.T
        owner, local = self._homes
        places = [np.flatnonzero(owner[rows] == number) for number in range(len(self.clusters))]
        used = [number for number, members_there in enumerate(places) if len(members_there)]
        first = self.starts[:, :1]
        for this in used:
            mine, local_rows = places[this], local[rows[places[this]]]
            result[np.ix_(mine, mine)] += self.diagonal[this][np.ix_(local_rows, local_rows)]
            for cluster in used:
                if cluster >= this or not self.ranks[this, cluster]:
                    continue
                theirs = places[cluster]
                a, b = (
                    int(self.starts[i, j] - first[i, 0])
                    for i, j in ((this, cluster), (cluster, this))
                )
                rank = int(self.ranks[this, cluster])
                left = self.factors[this][local_rows, a : a + rank]
                right = self.factors[cluster][local[rows[theirs]], b : b + rank]
                block = left @ right.T
                result[np.ix_(mine, theirs)] += block
                result[np.ix_(theirs, mine)] += block.T
        return result

    @cached_property
    def _homes(self) -> tuple[Indices, Indices]:
        """Cluster of every row, and its place there."""
        owner, local = np.empty((2, len(self.smooth)), dtype=np.int64)
        for number, members in enumerate(self.clusters):
            owner[members], local[members] = number, np.arange(len(members))
        return owner, local

    def plus(self, smooth: Matrix, core: Matrix) -> "CompressedCompliance":
        """Return S + X C Xᵀ."""
        return replace(
            self,
            smooth=np.hstack([self.smooth, smooth]),
            core=np.asarray(la.block_diag(self.core, core)),
        )

    def added(self, other: "CompressedCompliance") -> "CompressedCompliance":
        """Return the sum with another compliance that is smooth alone."""
        return replace(self.plus(other.smooth, other.core), error=self.error + other.error)

    def scaled(self, factor: float) -> "CompressedCompliance":
        """Return S times a positive number."""
        root = np.sqrt(factor)
        return replace(
            self,
            diagonal=tuple(factor * block for block in self.diagonal),
            factors=tuple(root * block for block in self.factors),
            core=factor * self.core,
            error=factor * self.error,
        )


Compliance: TypeAlias = Matrix | CompressedCompliance
"""A symmetric matrix between pairs, dense or compressed."""


def smooth_compliance(smooth: Matrix, core: Matrix, places: Matrix) -> CompressedCompliance:
    """Return X C Xᵀ alone, for a core C that is positive semidefinite."""
    clusters = geometric_clusters(places)
    return CompressedCompliance(
        clusters=clusters,
        diagonal=tuple(np.zeros((len(members), len(members))) for members in clusters),
        factors=tuple(np.zeros((len(members), 0)) for members in clusters),
        ranks=np.zeros((len(clusters), len(clusters)), dtype=np.int64),
        smooth=smooth,
        core=core,
        places=places,
        error=0.0,
    )


def plus(compliance: Compliance, smooth: Matrix, core: Matrix) -> Compliance:
    """Return S + X C Xᵀ, dense (read-only) or compressed as S is."""
    if isinstance(compliance, CompressedCompliance):
        return compliance.plus(smooth, core)
    total = (smooth @ core) @ smooth.T
    total += compliance
    symmetrized(total).setflags(write=False)
    return total


def symmetrized(matrix: Matrix) -> Matrix:
    """Return (A + Aᵀ)/2 in the place of A, an eighth of the time that ``A += A.T`` takes."""
    for start in range(0, len(matrix), ROWS):
        rows, columns = matrix[start : start + ROWS, start:], matrix[start:, start : start + ROWS]
        mean = (rows + columns.T) * 0.5
        rows[:], columns[:] = mean, mean.T
    return matrix


def compress(
    columns: Callable[[Indices], Matrix],
    places: Matrix,
    tolerance: float = TOLERANCE,
    largest: int = CLUSTER,
) -> CompressedCompliance:
    """Compress a symmetric matrix that is formed a cluster of columns at a time.

    ``columns`` returns the columns (n, len(indices)) of given indices. Rows belong to places (n, 3)
    [length]; neighbours are put in one cluster, of ``largest`` members at most. The tolerance is as
    :data:`TOLERANCE`; the sample is one entry of each cluster.

    Notes
    -----
    All columns are formed once, never together, and those of the sample twice. O(n k) memory a
    cluster for blocks of rank k.
    """
    clusters = geometric_clusters(places, largest)
    n, count = len(places), len(clusters)
    diagonal: list[Matrix] = []
    parts: list[list[Matrix]] = [[] for _ in clusters]
    ranks = np.zeros((count, count), dtype=np.int64)
    squared = 0.0
    sample = np.array([members[len(members) // 2] for members in clusters])
    allowed = tolerance * float(np.diag(columns(sample)[sample]).min()) / count
    for this, members in enumerate(clusters):
        dense = columns(members)
        blocks_of_cluster = dense[members]
        diagonal.append((blocks_of_cluster + blocks_of_cluster.T) / 2)
        for later in range(this + 1, count):
            left, right, missed = cross_approximation(dense[clusters[later]], allowed)
            squared += 2 * missed**2
            parts[later].append(left)
            ranks[this, later] = ranks[later, this] = left.shape[1]
            parts[this].append(right)
    return CompressedCompliance(
        clusters=clusters,
        diagonal=tuple(diagonal),
        factors=tuple(
            np.hstack(blocks_of_cluster) if blocks_of_cluster else np.zeros((len(members), 0))
            for blocks_of_cluster, members in zip(parts, clusters, strict=True)
        ),
        ranks=ranks,
        smooth=np.zeros((n, 0)),
        core=np.zeros((0, 0)),
        places=places,
        error=float(np.sqrt(squared)),
    )


def cross_approximation(block: Matrix, allowed: float) -> tuple[Matrix, Matrix, float]:
    """Return X (m, k), Y (n, k) and ‖block − X Yᵀ‖_F, which is at most ``allowed``."""
    remainder = np.array(block, order="C")
    left: list[Vector] = []
    right: list[Vector] = []
    missed = float(np.linalg.norm(remainder))
    while missed > allowed and len(left) < min(remainder.shape):
        i, j = divmod(int(np.abs(remainder).argmax()), remainder.shape[1])
        pivot = remainder[i, j]
        if pivot == 0.0:
            break
        column, row = remainder[:, j] / np.sqrt(abs(pivot)), remainder[i] / np.sqrt(abs(pivot))
        column = column * np.sign(pivot)
        remainder -= np.outer(column, row)
        left.append(column)
        right.append(row)
        missed = float(np.linalg.norm(remainder))
    shape = (len(left), -1)
    if not left:
        return np.zeros((len(remainder), 0)), np.zeros((remainder.shape[1], 0)), missed
    return np.reshape(left, shape).T, np.reshape(right, shape).T, missed
