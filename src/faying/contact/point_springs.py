"""Springs at the points as springs between the pairs, B = Gᵀ K G."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, read_only


@dataclass(frozen=True, eq=False, kw_only=True)
class PointSprings:
    """Assembles B = Gᵀ K G repeatedly; the map of entries from K to B is formed once.

    Attributes
    ----------
    G : (components n_point, n_relative), sparse or dense
        Displacements at the points, component by component.
    components
    """

    G: SparseMatrix | Matrix
    components: int

    @cached_property
    def transposed(self) -> SparseMatrix | Matrix:
        """Gᵀ, which maps forces at the points to the pairs."""
        if isinstance(self.G, np.ndarray):
            return self.G.T
        transposed = self.G.T.tocsr()
        transposed.sum_duplicates()
        return read_only(transposed)

    def of_diagonal(self, springs: Matrix) -> SparseMatrix | Matrix:
        """Return B for springs (components, n_point)."""
        if isinstance(self.G, np.ndarray):
            return np.asarray((self.transposed * springs.ravel()) @ self.G)
        return (self.transposed @ sp.diags_array(springs.ravel()) @ self.G).tocsr()

    def between_pairs(self, K: Matrix) -> SparseMatrix:
        """Return B (n_relative, n_relative) for K (n_point, components, components)."""
        places, indices, indptr = self._assembly
        n = self.G.shape[1]
        return sp.csr_array((places @ K.ravel(), indices, indptr), shape=(n, n))

    def add_to(self, matrix: Matrix, K: Matrix) -> None:
        """Add B to a dense matrix (n_relative, n_relative) in place."""
        if isinstance(self.G, np.ndarray):
            rows = self.G.reshape(self.components, -1, self.G.shape[1])
            sprung = np.einsum("pij,jpr->ipr", K, rows)
            matrix += self.transposed @ sprung.reshape(self.G.shape)
            return
        places, indices, _ = self._assembly
        matrix[self._row_of_entry, indices] += places @ K.ravel()

    def strongest(self, pair: int) -> int:
        """Return the row of G with the largest entry for a relative displacement."""
        felt = self.transposed[[pair]]
        felt = felt if isinstance(felt, np.ndarray) else felt.toarray()
        return int(np.abs(felt[0]).argmax())

    def touched(self, K: Matrix) -> tuple[Indices, Indices]:
        """Return the rows of B on which springs K act, and the columns that change their forces.

        The forces of a point that begins to slip change along its tangents alone.
        """
        acting, feeling = (K.any(axis=axis).ravel(order="F") for axis in (2, 1))
        return np.flatnonzero(self._pattern @ acting), np.flatnonzero(self._pattern @ feeling)

    def components_of(self, K: Matrix) -> Indices:
        """Return the rows of G along which springs K act."""
        return np.flatnonzero(K.any(axis=2).ravel(order="F"))

    def felt_along(self, components: Indices, K: Matrix) -> SparseMatrix:
        """Return K G (n_acting, n_relative) along some rows of G."""
        (along, at), n = np.divmod(components, len(K)), len(K)
        felt = [sp.diags_array(K[at, along, j]) @ self.G[j * n + at] for j in range(K.shape[1])]
        return sp.csr_array(sum(felt))

    @cached_property
    def _pattern(self) -> SparseMatrix:
        """|Gᵀ| (n_relative, components n_point), nonzero where a pair moves a point."""
        return abs(self.transposed)

    @cached_property
    def _row_of_entry(self) -> Indices:
        """Row of each entry of B."""
        indptr = self._assembly[2]
        return np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))

    @cached_property
    def _assembly(self) -> tuple[SparseMatrix, Indices, Indices]:
        """Return the map from K to entries of B (nnz, components² n_point), columns, rows."""
        k, n_pair = self.components, self.G.shape[1]
        n = self.G.shape[0] // k
        columns, values = (part.reshape(k, n, part.shape[1]) for part in padded_rows(self.G))
        keys, sources, shares = [], [], []
        for i, j in np.ndindex(k, k):
            share = values[i][:, :, None] * values[j][:, None, :]
            used = share.nonzero()
            keys.append((columns[i][:, :, None] * n_pair + columns[j][:, None, :])[used])
            sources.append((used[0] * k + i) * k + j)
            shares.append(share[used])
        entries, position = np.unique(np.concatenate(keys), return_inverse=True)
        places = sp.csr_array(
            (np.concatenate(shares), (position, np.concatenate(sources))),
            shape=(len(entries), k * k * n),
        )
        indptr = np.searchsorted(entries, n_pair * np.arange(n_pair + 1))
        return places, entries % n_pair, indptr


def padded_rows(matrix: SparseMatrix) -> tuple[Indices, Matrix]:
    """Return columns and values (n, k) of the entries of rows with at most k; padding is zero."""
    rows = matrix.tocsr()
    counts = np.diff(rows.indptr)
    used = np.arange(counts.max(initial=0)) < counts[:, None]
    columns, values = np.zeros(used.shape, dtype=np.int64), np.zeros(used.shape)
    columns[used], values[used] = rows.indices, rows.data
    return columns, values
