"""The sparsity of a block of elements: the pairs of nodes that share one."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector


@dataclass(frozen=True, eq=False)
class NodePairs:
    """The pairs of nodes that share an element.

    Attributes
    ----------
    rows_start : (n_node + 1,)
    columns : (n_pair,)
        Compressed rows of the pairs.
    slots : (n_cell, n_node_per_cell²)
        Which pair each pair of an element's nodes is.
    """

    rows_start: Indices
    columns: Indices
    slots: Indices

    @staticmethod
    def of(cells: Indices, n_node: int) -> "NodePairs":
        """Find the pairs of a block of cells (n_cell, n_node_per_cell)."""
        keys = (cells[:, :, None] * n_node + cells[:, None, :]).reshape(len(cells), -1)
        unique, slots = np.unique(keys, return_inverse=True)
        start = np.searchsorted(unique, np.arange(n_node + 1, dtype=np.int64) * n_node)
        return NodePairs(start, unique % max(n_node, 1), slots.reshape(keys.shape))

    @property
    def n_pairs(self) -> int:
        """Number of different pairs."""
        return len(self.columns)

    def add(self, total: Matrix, part: slice, values: Matrix) -> None:
        """Add values (n_cell_of_part · n_node_per_cell², n) of a batch to their pairs."""
        slots = self.slots[part].ravel()
        low, high = int(slots.min()), int(slots.max()) + 1
        shape = (high - low, len(slots))
        scatter = sp.csc_array((np.ones(len(slots)), slots - low, np.arange(len(slots) + 1)), shape)
        total[low:high] += scatter @ values

    def expanded(self, blocks: Matrix) -> SparseMatrix:
        """Return the matrix with a 3 x 3 block (n_pair, 9) per pair, on six dofs per node."""
        n_node = len(self.rows_start) - 1
        matrix = sp.bsr_array(
            (blocks.reshape(-1, 3, 3), self.columns, self.rows_start),
            shape=(3 * n_node, 3 * n_node),
        ).tocsr()
        return _on_six(matrix, n_node)

    def expanded_six(self, blocks: Matrix) -> SparseMatrix:
        """Return the matrix with a 6 x 6 block (n_pair, 36) per pair, without its zeros."""
        size = 6 * (len(self.rows_start) - 1)
        parts = (blocks.reshape(-1, 6, 6), self.columns, self.rows_start)
        matrix = sp.bsr_array(parts, shape=(size, size)).tocsr()
        matrix.eliminate_zeros()
        return matrix

    def expanded_diagonal(self, coefficients: Vector) -> SparseMatrix:
        """Return the matrix with coefficient · I₃ (n_pair,) per pair, on six dofs per node."""
        n_node = len(self.rows_start) - 1
        nodal = sp.csr_array((coefficients, self.columns, self.rows_start), shape=(n_node, n_node))
        return _on_six(sp.kron(nodal, sp.eye_array(3), format="csr"), n_node)


def _on_six(matrix: SparseMatrix, n_node: int) -> SparseMatrix:
    """Spread a matrix of three dofs per node over six."""
    index_type = matrix.indices.dtype
    columns = (matrix.indices + 3 * (matrix.indices // 3)).astype(index_type)
    counts = np.zeros((n_node, 6), dtype=np.int64)
    counts[:, :3] = np.diff(matrix.indptr).reshape(n_node, 3)
    start = np.concatenate([[0], np.cumsum(counts)]).astype(index_type)
    return sp.csr_array((matrix.data, columns, start), shape=(6 * n_node, 6 * n_node))
