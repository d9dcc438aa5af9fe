"""Cholesky factorization by MKL PARDISO: the fastest that pip installs on x86-64.

The compliance between ports Q is what the elimination of A leaves of a bordered matrix,

    [[A, Qᵀ], [Q, 0]]  →  −Q A⁻¹ Qᵀ,

its Schur complement. Ports come in where their unknowns are eliminated and not before, so METIS's
order of A serves, whatever the ports are.
"""

import logging
import threading
import weakref
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.blocks import node_blocks, upper_blocks
from faying.linalg.memory import FactorMemory, NotEnoughMemoryError, require_memory
from faying.linalg.mkl import INDEFINITE, PardisoHandle
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import column_blocks, solved_gram

_log = logging.getLogger("faying")

FEW = 100
"""Ports up to which a substitution for each takes less than a second factorization.

As much at 110 to 250 ports on joints of 8000 to 49 000 degrees of freedom.
"""

AGREEMENT = 1e-9
"""Difference of a Schur complement from a substitution, over the result; 1e-12 is usual."""

UNCERTAIN = 10
"""As much more may they differ as refining the substitution changes it.

On a roof held by springs of 1 N/mm they differ by 3e-9, and refinement changes as much.
"""


COMPARED = 3
"""Random combinations of columns that are substituted.

On two plates held by weak springs a complement differs from one of twelve by 0.3 to 11 times what
refinement changes it, from the largest of three by 1.0 to 1.9 times.
"""

PAIR = sp.csr_array(np.array([[1.0, 0.5], [0.0, 1.0]]))
"""Two rows that are connected: without any such MKL 2026 crashes, as of a diagonal matrix."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PardisoFactorization:
    """Cholesky factor inside PARDISO, freed with this object.

    Attributes
    ----------
    order
        Rows of the matrix; PARDISO may hold some more, which fill a block.
    """

    order: int
    handle: PardisoHandle
    backend: str = "pardiso"
    _turn: threading.Lock = field(default_factory=threading.Lock, init=False, repr=False)

    def __post_init__(self) -> None:
        # At exit the system takes the memory back anyway, and MKL's threads may be gone.
        weakref.finalize(self, self.handle.release).atexit = False

    @property
    def memory(self) -> int:
        """Bytes of the factor and of its tables."""
        return self.handle.memory

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k); threads take turns."""
        B = np.asarray(right_hand_side, dtype=np.float64)
        if len(B) != self.order:
            message = f"the right-hand side has {len(B)} rows and the matrix {self.order}"
            raise ValueError(message)
        columns = B if B.ndim == 2 else B[:, None]
        solution = np.empty(columns.shape, order="F")
        for block in column_blocks(*columns.shape):
            with self._turn:
                solution[:, block] = _solved(self.handle, columns[:, block])
        return solution.reshape(B.shape)

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k).

        Notes
        -----
        Of many sparse columns the Schur complement of the bordered matrix, which substitutions
        of a few random combinations check; a substitution for each where that does not fit into the
        memory that is free, which is logged.
        """
        if sp.issparse(columns) and columns.shape[1] > FEW:
            upper = self.handle.upper[: self.order, : self.order]
            try:
                gram = schur_gram(upper, columns)
            except NotDefiniteError:  # where rows are eliminated in another order
                return solved_gram(self.solve, columns)
            except NotEnoughMemoryError as error:
                _log.warning("%d ports are solved for one by one, for %s", columns.shape[1], error)
                return solved_gram(self.solve, columns)
            if self._agrees(gram, upper, columns):
                return gram
        return solved_gram(self.solve, columns)

    def _agrees(self, gram: Matrix, upper: SparseMatrix, columns: SparseMatrix) -> bool:
        """Compare Bᵀ A⁻¹ B with the substitution of a few random combinations of columns."""
        probe = np.random.default_rng(0).standard_normal((columns.shape[1], COMPARED))
        forces = columns @ probe
        moved = self.solve(forces)
        residual = forces - upper @ moved - upper.T @ moved + upper.diagonal()[:, None] * moved
        expected, uncertain = columns.T @ moved, columns.T @ self.solve(residual)
        difference = np.abs(gram @ probe - expected).max()
        allowed = AGREEMENT * np.abs(expected).max() + UNCERTAIN * np.abs(uncertain).max()
        return bool(difference <= allowed)


def factorize_pardiso(A: SparseMatrix) -> PardisoFactorization:
    """Factorize a symmetric positive definite matrix.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the memory that is free.
    """
    if not A.diagonal().min(initial=np.inf) > 0:
        raise NotDefiniteError  # and PARDISO wants every diagonal entry stored
    handle = PardisoHandle(*upper_blocks(node_blocks(A)))
    try:
        require_memory(_expected(handle, A.shape[0]))
        handle.factorize()
    except BaseException:
        handle.release()
        raise
    return PardisoFactorization(order=A.shape[0], handle=handle)


def schur_gram(upper: SparseMatrix, columns: SparseMatrix) -> Matrix:
    """Return Bᵀ A⁻¹ B (k, k) for sparse B (n, k) and the upper triangle of A.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the memory that is free.
    """
    handle = _bordered(upper, columns)
    try:
        require_memory(_expected(handle, *columns.shape))
        gram = handle.schur_complement()
    finally:
        handle.release()
    return np.negative(gram, out=gram)


def _bordered(upper: SparseMatrix, columns: SparseMatrix) -> PardisoHandle:
    """Analyse [[A, B], [Bᵀ, 0]] for the upper triangle of A, with a pair of rows on its own.

    All zeros of the border are stored: with its diagonal alone the analysis of MKL 2026 reads
    memory that is not its own (valgrind), and crashes now and then.
    """
    k = columns.shape[1]
    rows = sp.block_array([[upper, None, columns], [None, PAIR, None]], format="csr")
    rows.sort_indices()
    counts = np.arange(k, 0, -1, dtype=np.int32)
    ends = np.cumsum(counts, dtype=np.int32)
    border = np.arange(ends[-1], dtype=np.int32) - np.repeat(ends - k, counts)
    return PardisoHandle(
        np.append(rows.data, np.zeros(len(border)))[:, None, None],
        np.append(rows.indices, rows.shape[0] + border).astype(np.int32),
        np.append(rows.indptr, rows.indptr[-1] + ends).astype(np.int32),
        border=k,
    )


def count_negative_pardiso(A: SparseMatrix) -> int:
    """Count the negative eigenvalues of a symmetric matrix.

    Raises
    ------
    InertiaError
        If a pivot was too small to have a sign, or some grew too large.
    NotEnoughMemoryError
        If the factor would not fit into the memory that is free.
    """
    upper = upper_blocks(node_blocks(_with_diagonal(A)))
    handle = PardisoHandle(*upper, kind=INDEFINITE)
    try:
        require_memory(_expected(handle, A.shape[0]))
        handle.factorize()
        if handle.perturbed:
            raise NotDefiniteError
        check_signs(A, lambda b: _solved(handle, b[:, None])[:, 0])
        return handle.negative
    except NotDefiniteError:
        reason = "the matrix is singular but for round-off"
        raise InertiaError(reason) from None
    finally:
        handle.release()


def estimate_pardiso(A: SparseMatrix) -> FactorMemory:
    """Tell what :func:`factorize_pardiso` would take, from the pattern alone."""
    handle = PardisoHandle(*upper_blocks(node_blocks(_with_diagonal(A))))
    try:
        return _expected(handle, A.shape[0])
    finally:
        handle.release()


def estimate_gram_pardiso(A: SparseMatrix, columns: SparseMatrix) -> int:
    """Tell the most bytes that Bᵀ A⁻¹ B takes beyond the factors of A, from the pattern alone."""
    if columns.shape[1] <= FEW:
        return 8 * int(columns.shape[1]) ** 2
    handle = _bordered(sp.triu(_with_diagonal(A), format="csr"), columns)
    try:
        return _expected(handle, *columns.shape).peak
    finally:
        handle.release()


def _expected(handle: PardisoHandle, order: int, n_port: int = 0) -> FactorMemory:
    return FactorMemory(
        backend="pardiso",
        order=order,
        factor=handle.expected_memory,
        peak=handle.peak + 8 * n_port**2,
        counted=True,
    )


def _with_diagonal(A: SparseMatrix) -> SparseMatrix:
    """Store zeros on the diagonal too, where PARDISO wants every entry."""
    stored = sp.csr_array(A, copy=True)
    stored.setdiag(A.diagonal())
    return stored


def _solved(handle: PardisoHandle, columns: Matrix) -> Matrix:
    """Solve for right-hand sides, padded to whole blocks."""
    padded = np.zeros((handle.n, columns.shape[1]), order="F")
    padded[: len(columns)] = columns
    solution: Matrix = handle.solve(padded)[: len(columns)]
    return solution
