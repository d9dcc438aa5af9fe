"""LU factorization by SciPy's SuperLU, available on every platform."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Indices, Matrix, SparseMatrix
from faying.linalg.blocks import node_blocks
from faying.linalg.memory import FactorMemory, require_memory
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import solved_gram

try:
    import pymetis  # type: ignore[import-not-found, unused-ignore]
except ImportError:
    pymetis = None

SMALLEST = 1000
"""Order of a matrix below which minimum degree ordering is as good."""


def nested_dissection(A: SparseMatrix) -> Indices | None:
    """Return an order of the rows for sparse factors; None without METIS.

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
    return np.asarray(expanded[expanded < n])


BYTES_PER_ENTRY = np.dtype(np.float64).itemsize + np.dtype(np.intc).itemsize
"""A number and its row."""

FILL, FILL_EXPONENT = 4.35, 1.484
"""Entries of L and U are 4.35 n^1.484, fitted to joints of 600 to 49 000 degrees of freedom.

Plates and blocks of all element kinds are within a factor of 1.8.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class SuperluFactorization:
    """LU factors of a sparse symmetric matrix, made in SuperLU's symmetric mode.

    Attributes
    ----------
    order : (n,) or None
        Rows in the order of elimination; None if SuperLU chooses it.
    """

    factors: Any
    order: Indices | None

    @property
    def backend(self) -> str:
        """Name of the library, and of the one that ordered the rows."""
        return "superlu" if self.order is None else "superlu+metis"

    @property
    def memory(self) -> int:
        """Bytes of the factors."""
        return BYTES_PER_ENTRY * int(self.factors.nnz)

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        B = np.asarray(right_hand_side, dtype=np.float64)
        solution: Matrix
        if self.order is None:
            solution = self.factors.solve(B)
        else:
            solution = np.empty(B.shape)
            solution[self.order] = self.factors.solve(B[self.order])
        return solution

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k), with one substitution per column."""
        return solved_gram(self.solve, columns)


def factorize_superlu(A: SparseMatrix) -> SuperluFactorization:
    """Factorize a symmetric matrix, definite or not."""
    require_memory(estimate_superlu(A))
    order = nested_dissection(A)
    try:
        factors = spla.splu(
            sp.csc_array(A) if order is None else sp.csr_array(A)[order][:, order].tocsc(),
            permc_spec="MMD_AT_PLUS_A" if order is None else "NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise NotDefiniteError from None
    return SuperluFactorization(factors=factors, order=order)


def factorize_saddle_superlu(A: SparseMatrix) -> SuperluFactorization:
    """Factorize a symmetric indefinite matrix with zeros on its diagonal, with pivoting."""
    require_memory(estimate_superlu(A))
    try:
        return SuperluFactorization(factors=spla.splu(sp.csc_array(A)), order=None)
    except RuntimeError:
        raise NotDefiniteError from None


def estimate_superlu(A: SparseMatrix) -> FactorMemory:
    """Return an estimate of the memory of :func:`factorize_superlu`, from the order alone."""
    n = A.shape[0]
    upper_bound = n * (n + 1)  # L and U, both with their diagonal
    size = BYTES_PER_ENTRY * int(min(FILL * n**FILL_EXPONENT, upper_bound))
    return FactorMemory(backend="superlu", order=n, factor=size, peak=size, counted=False)


def count_negative_superlu(A: SparseMatrix) -> int:
    """Return the number of negative eigenvalues of a symmetric matrix, by diagonal pivots.

    Raises
    ------
    InertiaError
        If diagonal pivots fail: the matrix is singular, or a leading part of it nearly is.

    NotEnoughMemoryError
        If it would probably not fit into the free memory.

    Notes
    -----
    SciPy copies the factors to show their diagonal: twice the memory for a moment. A count is not
    worth running out of memory, so here an estimate is enough to refuse.
    """
    expected = estimate_superlu(A)
    require_memory(replace(expected, peak=2 * expected.factor, counted=True))
    try:
        factorization = factorize_superlu(A)
    except NotDefiniteError:
        reason = "the matrix is singular"
        raise InertiaError(reason) from None
    factors = factorization.factors
    if not np.array_equal(factors.perm_r, factors.perm_c):
        reason = "a pivot is zero, and SuperLU takes one off the diagonal"
        raise InertiaError(reason)
    check_signs(A, factorization.solve)
    return int(np.count_nonzero(factors.U.diagonal() < 0))
