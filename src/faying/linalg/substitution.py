"""Substitutions in blocks of right-hand sides, so that memory stays bounded."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix

BLOCK = 256
"""Rows or columns of a dense matrix at once: more right-hand sides are no faster, and a larger
transpose exceeds the processor's cache."""

BLOCK_BYTES = 2**27
"""Largest memory of one dense block of right-hand sides."""


def column_blocks(n_row: int, n_column: int) -> list[slice]:
    """Return slices of columns of length ``n_row`` to solve at once."""
    width = min(BLOCK, max(16, BLOCK_BYTES // (8 * max(n_row, 1))))
    return [slice(start, start + width) for start in range(0, n_column, width)]


def solved_gram(solve: Callable[[Matrix], Matrix], columns: SparseMatrix | Matrix) -> Matrix:
    """Return Bᵀ A⁻¹ B for B (n, k) with one substitution per column."""
    n, k = columns.shape
    gram = np.empty((k, k))
    by_column = sp.csc_array(columns) if sp.issparse(columns) else columns
    for block in column_blocks(n, k):
        gram[:, block] = columns.T @ solve(dense(by_column[:, block]))
    return symmetrized(gram)


def dense(columns: SparseMatrix | Matrix) -> Matrix:
    """Return columns as a dense array."""
    return columns.toarray() if isinstance(columns, sp.sparray) else np.asarray(columns)


def symmetrized(matrix: Matrix) -> Matrix:
    """Return (A + Aᵀ)/2, in the memory of A and in an eighth of the time of ``A += A.T``."""
    for start in range(0, len(matrix), BLOCK):
        rows, columns = matrix[start : start + BLOCK, start:], matrix[start:, start : start + BLOCK]
        mean = (rows + columns.T) * 0.5
        rows[:], columns[:] = mean, mean.T
    return matrix
