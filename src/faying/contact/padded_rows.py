"""Rows of a sparse matrix, to be taken a few at a time: padded to one number of entries."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Indices, Matrix, SparseMatrix, Vector


@final
@dataclass(frozen=True, eq=False)
class PaddedRows:
    """Rows of a sparse matrix (n, n_column) with at most k entries each.

    Attributes
    ----------
    columns : (n, k)
        Column of each entry; 0 for padding.
    values : (n, k)
    n_column
        Columns of the matrix.
    """

    columns: Indices
    values: Matrix
    n_column: int

    @classmethod
    def of(cls, matrix: SparseMatrix) -> "PaddedRows":
        """Return the rows of a sparse matrix."""
        rows = matrix.tocsr()
        counts = np.diff(rows.indptr)
        used = np.arange(counts.max(initial=0)) < counts[:, None]
        columns, values = np.zeros(used.shape, dtype=np.int64), np.zeros(used.shape)
        columns[used], values[used] = rows.indices, rows.data
        return cls(columns, values, rows.shape[1])

    def product(self, rows: Indices, vector: Vector) -> Vector:
        """Return some rows times a vector (n_column,)."""
        entries = vector.take(self.columns.take(rows, axis=0))
        result: Vector = np.einsum("rk,rk->r", entries, self.values.take(rows, axis=0))
        return result

    def combined(self, rows: Indices, matrix: Matrix) -> Matrix:
        """Return some rows times the transpose of a matrix (m, n_column)."""
        entries = matrix.take(self.columns.take(rows, axis=0), axis=1)
        values = self.values.take(rows, axis=0)
        result: Matrix = np.matmul(entries.transpose(1, 0, 2), values[:, :, None])[:, :, 0]
        return result

    def gram(self, rows: Indices, weights: Vector) -> Matrix:
        """Return Vᵀ W V (n_column, n_column) of some rows V, with weights (n,) of all rows."""
        columns, values = self.columns.take(rows, axis=0), self.values.take(rows, axis=0)
        places = columns[:, :, None] * self.n_column + columns[:, None, :]
        entries = (values * weights.take(rows)[:, None])[:, :, None] * values[:, None, :]
        filled = np.bincount(places.ravel(), entries.ravel(), minlength=self.n_column**2)
        return np.asarray(filled.reshape(self.n_column, self.n_column))
