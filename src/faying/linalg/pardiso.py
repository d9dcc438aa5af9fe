"""Cholesky factorization by MKL PARDISO: the fastest that pip installs on x86-64."""

import threading
import weakref
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.linalg.blocks import blocks_with_last, node_blocks, upper_blocks
from faying.linalg.memory import FactorMemory, require_memory
from faying.linalg.mkl import INDEFINITE, PardisoHandle
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import agrees, column_blocks, solved_gram


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PardisoFactorization:
    """Cholesky factor inside PARDISO, freed with this object.

    Attributes
    ----------
    place : (n,)
        Where its rows are among those that PARDISO was given.
    last : (n,)
        Degrees of freedom eliminated last, because ports touch them.
    """

    handle: PardisoHandle
    place: Indices
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
        if len(B) != len(self.place):
            message = f"the right-hand side has {len(B)} rows and the matrix {len(self.place)}"
            raise ValueError(message)
        columns = B if B.ndim == 2 else B[:, None]
        solution = np.empty(columns.shape, order="F")
        for block in column_blocks(*columns.shape):
            with self._turn:
                solution[:, block] = self.handle.solve(self._padded(columns[:, block]))[self.place]
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
        if agrees(gram, columns, self.solve):
            return gram
        return solved_gram(self.solve, columns)

    def _confines(self, columns: SparseMatrix) -> bool:
        return bool(self.last.any() and not _touched(columns)[~self.last].any())

    def _halves(self, columns: SparseMatrix) -> Matrix:
        """Return the rows ``last`` of L⁻¹B, where all others vanish."""
        last = self.place[self.last]
        halves = np.empty((len(last), columns.shape[1]))
        for block in column_blocks(*columns.shape):
            some = columns[:, block]
            shape = (self.handle.n, some.shape[1])
            some = sp.csc_array((some.data, self.place[some.indices], some.indptr), shape=shape)
            # In PARDISO's order of numbers at once: turning a dense block around takes as long as
            # the substitution.
            padded = some.toarray(order="F")
            with self._turn:
                halves[:, block] = self.handle.forward(padded)[last]
        return halves

    def _padded(self, columns: Matrix) -> Matrix:
        padded = np.zeros((self.handle.n, columns.shape[1]), order="F")
        padded[self.place] = columns
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
    handle, place, last = _analysed(A, ports)
    try:
        require_memory(_expected(handle, A))
        handle.factorize()
    except BaseException:
        handle.release()
        raise
    return PardisoFactorization(handle=handle, place=place, last=last)


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
    handle, *_ = _analysed(_with_diagonal(A), ports)
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


def _analysed(A: SparseMatrix, ports: SparseMatrix | None) -> tuple[PardisoHandle, Indices, Mask]:
    """Analyse the pattern; return the place of its rows, and those to be eliminated last."""
    n = A.shape[0]
    nowhere = np.zeros(n, dtype=bool)
    if ports is not None and n:
        touched = _touched(ports.T)
        form, last, place = blocks_with_last(A, touched)
        handle, size = PardisoHandle(*upper_blocks(form), last), form.blocksize[0]
        if _pays(handle.entries, size * int(np.count_nonzero(last)), ports.shape[0]):
            return handle, place, touched
        handle.release()
    blocks = node_blocks(A)
    handle = PardisoHandle(*upper_blocks(blocks), np.zeros(len(blocks.indptr) - 1, dtype=bool))
    return handle, np.arange(n), nowhere


def _pays(entries: int, front: int, n_port: int) -> bool:
    """Compare the Cholesky of a dense last front with the substitutions it makes unnecessary."""
    inner = entries - front**2 / 2
    return front**3 / 3 < 4 * inner * n_port


def _touched(columns: SparseMatrix) -> Mask:
    """Return which rows of sparse columns hold anything."""
    touched: Mask = np.diff(columns.tocsr().indptr) > 0
    return touched
