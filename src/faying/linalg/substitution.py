"""Right-hand sides by the block, so that memory stays bounded."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix

COLUMN_BLOCK = 256
"""Most right-hand sides solved at once; more gain nothing."""

BLOCK_BYTES = 2**27
"""Most memory of one dense block of right-hand sides."""

AGREEMENT = 1e-9
"""Largest difference of confined from complete substitution, over the result; 1e-12 is usual."""


def column_blocks(n_row: int, n_column: int) -> list[slice]:
    """Split columns of length ``n_row`` into blocks worth solving at once."""
    width = min(COLUMN_BLOCK, max(16, BLOCK_BYTES // (8 * max(n_row, 1))))
    return [slice(start, start + width) for start in range(0, n_column, width)]


def solved_gram(solve: Callable[[Matrix], Matrix], columns: SparseMatrix | Matrix) -> Matrix:
    """Return Bᵀ A⁻¹ B for B (n, k) with one substitution per column."""
    n, k = columns.shape
    gram = np.empty((k, k))
    by_column = sp.csc_array(columns) if sp.issparse(columns) else columns
    for block in column_blocks(n, k):
        gram[:, block] = columns.T @ solve(dense(by_column[:, block]))
    return gram


def agrees(gram: Matrix, columns: SparseMatrix | Matrix, solve: Callable[[Matrix], Matrix]) -> bool:
    """Compare Bᵀ A⁻¹ B with one substitution, of a random combination of columns B (n, k)."""
    probe = np.random.default_rng(0).standard_normal(columns.shape[1])
    expected = columns.T @ solve(columns @ probe)
    difference = np.abs(gram @ probe - expected).max(initial=0.0)
    return bool(difference <= AGREEMENT * np.abs(expected).max(initial=0.0))


def dense(columns: SparseMatrix | Matrix) -> Matrix:
    """Return columns as a dense array."""
    return columns.toarray() if isinstance(columns, sp.sparray) else np.asarray(columns)
