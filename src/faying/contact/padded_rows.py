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
    """

    columns: Indices
    values: Matrix

    @classmethod
    def of(cls, matrix: SparseMatrix) -> "PaddedRows":
        """Return the rows of a sparse matrix."""
        rows = matrix.tocsr()
        counts = np.diff(rows.indptr)
        used = np.arange(counts.max(initial=0)) < counts[:, None]
        columns, values = np.zeros(used.shape, dtype=np.int64), np.zeros(used.shape)
        columns[used], values[used] = rows.indices, rows.data
        return cls(columns, values)

    def product(self, rows: Indices, vector: Vector) -> Vector:
        """Return some rows times a vector (n_column,)."""
        result: Vector = (self.values[rows] * vector[self.columns[rows]]).sum(axis=1)
        return result

    def combined(self, rows: Indices, matrix: Matrix) -> Matrix:
        """Return some rows times a matrix (n_column, m)."""
        result = np.zeros((len(rows), matrix.shape[1]))
        columns, values = self.columns[rows], self.values[rows]
        for k in range(columns.shape[1]):
            result += values[:, k, None] * matrix[columns[:, k]]
        return result
