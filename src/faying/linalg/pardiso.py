"""Cholesky factorization by MKL PARDISO: the fastest that pip installs on x86-64."""

import threading
import weakref
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from faying._typing import Mask, Matrix, SparseMatrix, Vector
from faying.linalg.blocks import node_blocks, single_rows, upper_blocks
from faying.linalg.memory import FactorMemory, require_memory
from faying.linalg.mkl import INDEFINITE, PardisoHandle
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import column_blocks, solved_gram

AGREEMENT = 1e-9
"""Largest difference of confined from complete substitution, over the result; 1e-12 is usual."""

MOST_UNTOUCHED = 2
"""Rows in the blocks that ports touch over rows touched, from which on single rows are better.

Their analysis takes eight times as long; a dense last front of a third of the rows makes up for it.
"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PardisoFactorization:
    """Cholesky factor inside PARDISO, freed with this object.

    Attributes
    ----------
    n
        Order of the matrix.
    last : (n,)
        Degrees of freedom eliminated last, because ports touch them.
    """

    handle: PardisoHandle
    n: int
    last: Mask
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
        if len(B) != self.n:
            message = f"the right-hand side has {len(B)} rows and the matrix {self.n}"
            raise ValueError(message)
        columns = B if B.ndim == 2 else B[:, None]
        solution = np.empty(columns.shape, order="F")
        for block in column_blocks(*columns.shape):
            with self._turn:
                solution[:, block] = self.handle.solve(self._padded(columns[:, block]))[: self.n]
        return solution.reshape(B.shape)

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k).

        Notes
        -----
        Columns that vanish outside ``last`` take part in the last front of the factor alone, by
        Y = L⁻¹B and YᵀY. The complete substitution of one random combination of them checks it.
        """
        by_row = sp.csr_array(columns)
        if not self._confines(by_row):
            return solved_gram(self.solve, columns)
        halves = self._halves(by_row.tocsc())
        gram: Matrix = halves.T @ halves
        probe = np.random.default_rng(0).standard_normal(columns.shape[1])
        expected = columns.T @ self.solve(columns @ probe)
        difference = np.abs(gram @ probe - expected).max(initial=0.0)
        if difference <= AGREEMENT * np.abs(expected).max(initial=0.0):
            return gram
        return solved_gram(self.solve, columns)

    def _confines(self, columns: SparseMatrix) -> bool:
        return bool(self.last.any() and not _touched(columns)[~self.last].any())

    def _halves(self, columns: SparseMatrix) -> Matrix:
        """Return the rows ``last`` of L⁻¹B, where all others vanish."""
        halves = np.empty((np.count_nonzero(self.last), columns.shape[1]))
        for block in column_blocks(*columns.shape):
            some = columns[:, block]
            some.resize(self.handle.n, some.shape[1])
            # In PARDISO's order of numbers at once: turning a dense block around takes as long as
            # the substitution.
            padded = some.toarray(order="F")
            with self._turn:
                halves[:, block] = self.handle.forward(padded)[: self.n][self.last]
        return halves

    def _padded(self, columns: Matrix) -> Matrix:
        padded = np.zeros((self.handle.n, columns.shape[1]), order="F")
        padded[: self.n] = columns
        return padded


def factorize_pardiso(A: SparseMatrix, ports: SparseMatrix | None = None) -> PardisoFactorization:
    """Factorize a symmetric positive definite matrix.

    Parameters
    ----------
    ports : (n_port, n)
        Rows between which the inverse will be wanted. Where it pays, the degrees of freedom they
        touch are eliminated last.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the memory that is free.
    """
    if not A.diagonal().min(initial=np.inf) > 0:
        raise NotDefiniteError  # and PARDISO wants every diagonal entry stored
    handle, last = _analysed(A, ports)
    try:
        require_memory(_expected(handle, A))
        handle.factorize()
    except BaseException:
        handle.release()
        raise
    return PardisoFactorization(handle=handle, n=A.shape[0], last=last)


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
    nowhere = np.zeros(len(upper[2]) - 1, dtype=bool)
    handle = PardisoHandle(*upper, nowhere, INDEFINITE)
    try:
        require_memory(_expected(handle, A))
        handle.factorize()
        if handle.perturbed:
            raise NotDefiniteError
        check_signs(A, lambda b: _solved(handle, b))
        return handle.negative
    except NotDefiniteError:
        reason = "the matrix is singular but for round-off"
        raise InertiaError(reason) from None
    finally:
        handle.release()


def estimate_pardiso(A: SparseMatrix, ports: SparseMatrix | None = None) -> FactorMemory:
    """Tell what :func:`factorize_pardiso` would take, from the pattern alone."""
    handle, _ = _analysed(_with_diagonal(A), ports)
    try:
        return _expected(handle, A)
    finally:
        handle.release()


def _expected(handle: PardisoHandle, A: SparseMatrix) -> FactorMemory:
    return FactorMemory(
        backend="pardiso",
        order=A.shape[0],
        factor=handle.expected_memory,
        peak=handle.peak,
        counted=True,
    )


def _with_diagonal(A: SparseMatrix) -> SparseMatrix:
    """Store zeros on the diagonal too, where PARDISO wants every entry."""
    stored = sp.csr_array(A, copy=True)
    stored.setdiag(A.diagonal())
    return stored


def _solved(handle: PardisoHandle, b: Vector) -> Vector:
    """Solve for one right-hand side, padded to whole blocks."""
    padded = np.zeros((handle.n, 1), order="F")
    padded[: len(b), 0] = b
    solution: Vector = handle.solve(padded)[: len(b), 0]
    return solution


def _analysed(A: SparseMatrix, ports: SparseMatrix | None) -> tuple[PardisoHandle, Mask]:
    """Analyse the pattern, and return the rows to be eliminated last."""
    blocks, n = node_blocks(A), A.shape[0]
    if ports is not None:
        form, last = _with_rows_last(A, blocks, _touched(ports.T))
        handle, size = PardisoHandle(*upper_blocks(form), last), form.blocksize[0]
        if _pays(handle.entries, size * int(np.count_nonzero(last)), ports.shape[0]):
            return handle, np.repeat(last, size)[:n]
        handle.release()
    nowhere = np.zeros(len(blocks.indptr) - 1, dtype=bool)
    return PardisoHandle(*upper_blocks(blocks), nowhere), np.zeros(n, dtype=bool)


def _with_rows_last(
    A: SparseMatrix, blocks: sp.bsr_array, touched: Mask
) -> tuple[sp.bsr_array, Mask]:
    """Return A in the blocks in which to eliminate some rows last, and those blocks."""
    size = blocks.blocksize[0]
    padded = np.append(touched, np.zeros(-len(touched) % size, dtype=bool))
    last = np.asarray(padded.reshape(-1, size).any(axis=1))
    if size * np.count_nonzero(last) > MOST_UNTOUCHED * np.count_nonzero(touched):
        return single_rows(A), touched
    return blocks, last


def _pays(entries: int, front: int, n_port: int) -> bool:
    """Compare the Cholesky of a dense last front with the substitutions it makes unnecessary."""
    inner = entries - front**2 / 2
    return front**3 / 3 < 4 * inner * n_port


def _touched(columns: SparseMatrix) -> Mask:
    """Return which rows of sparse columns hold anything."""
    touched: Mask = np.diff(columns.tocsr().indptr) > 0
    return touched
