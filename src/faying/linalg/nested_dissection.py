"""METIS's order of elimination, where pip has installed pymetis."""

import numpy as np

from faying._typing import Indices, SparseMatrix
from faying.linalg.blocks import node_blocks

try:
    import pymetis  # type: ignore[import-not-found, unused-ignore]
except ImportError:
    pymetis = None

SMALLEST = 1000
"""Order of a matrix below which minimum degree is as good."""


def nested_dissection(A: SparseMatrix) -> Indices | None:
    """Return an order of the rows that keeps the factors sparse, or None without METIS.

    References
    ----------
    G. Karypis, V. Kumar, SIAM J. Sci. Comput. 20 (1998) 359–392.
    """
    n = A.shape[0]
    if pymetis is None or n < SMALLEST:
        return None
    blocks = node_blocks(A)
    size, n_block = blocks.blocksize[0], len(blocks.indptr) - 1
    rows = np.repeat(np.arange(n_block), np.diff(blocks.indptr))
    off = rows != blocks.indices
    starts = np.concatenate([[0], np.cumsum(np.bincount(rows[off], minlength=n_block))])
    graph = pymetis.CSRAdjacency(starts, blocks.indices[off])
    order = np.asarray(pymetis.nested_dissection(graph)[0])
    expanded: Indices = (size * order[:, None] + np.arange(size)).ravel()
    order_of_rows: Indices = expanded[expanded < n]
    return order_of_rows
