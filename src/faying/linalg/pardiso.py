"""Cholesky factorization by MKL PARDISO: the fastest that pip installs on x86-64."""

import threading
import weakref
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Mask, Matrix, SparseMatrix, Vector
from faying.linalg.blocks import node_blocks, single_rows, upper_blocks
from faying.linalg.cholesky import DenseFactorization
from faying.linalg.memory import FactorMemory, require_memory
from faying.linalg.mkl import INDEFINITE, POSITIVE_DEFINITE, PardisoHandle
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import column_blocks, solved_gram

AGREEMENT = 1e-9
"""Largest difference from complete substitution, over the result; 1e-12 is usual."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PardisoFactorization:
    """Cholesky factor inside PARDISO, freed with this object.

    Attributes
    ----------
    n
        Order of the matrix.
    kept : (n,)
        Degrees of freedom that ports touch, if the factorization was told them.
    complement
        Schur complement onto them; the whole inverse between them is its inverse.
    """

    handle: PardisoHandle
    n: int
    kept: Mask
    complement: DenseFactorization
    backend: str = "pardiso"
    _turn: threading.Lock = field(default_factory=threading.Lock, init=False, repr=False)

    def __post_init__(self) -> None:
        # At exit the system takes the memory back anyway, and MKL's threads may be gone.
        weakref.finalize(self, self.handle.release).atexit = False

    @property
    def memory(self) -> int:
        """Bytes of the factor, of its tables and of the Schur complement."""
        return self.handle.memory + self.complement.memory

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
        Columns that vanish outside ``kept`` take the Schur complement's factors alone. The complete
        substitution of one random combination of them checks it.
        """
        by_row = sp.csr_array(columns)
        if not self.kept.any() or _touched(by_row)[~self.kept].any():
            return solved_gram(self.solve, columns)
        gram = self.complement.gram(by_row[self.kept])
        probe = np.random.default_rng(0).standard_normal(columns.shape[1])
        expected = columns.T @ self.solve(columns @ probe)
        difference = np.abs(gram @ probe - expected).max(initial=0.0)
        if difference <= AGREEMENT * np.abs(expected).max(initial=0.0):
            return gram
        return solved_gram(self.solve, columns)

    def _padded(self, columns: Matrix) -> Matrix:
        padded = np.zeros((self.handle.n, columns.shape[1]), order="F")
        padded[: self.n] = columns
        return padded


def factorize_pardiso(A: SparseMatrix, ports: SparseMatrix | None = None) -> PardisoFactorization:
    """Factorize a symmetric positive definite matrix.

    Parameters
    ----------
    ports : (n_port, n)
        Rows between which the inverse will be wanted. Where it pays, the Schur complement onto the
        degrees of freedom they touch is formed on the way.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the memory that is free.
    """
    if not A.diagonal().min(initial=np.inf) > 0:
        raise NotDefiniteError  # and PARDISO wants every diagonal entry stored
    handle, kept = _analysed(A, ports)
    try:
        require_memory(_expected(handle, A))
        complement = la.cholesky(handle.factorize().T, lower=True, overwrite_a=True)
    except la.LinAlgError:
        handle.release()
        raise NotDefiniteError from None
    except BaseException:
        handle.release()
        raise
    return PardisoFactorization(
        handle=handle,
        n=A.shape[0],
        kept=kept,
        complement=DenseFactorization(factor=complement),
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
    handle = _in_blocks(_with_diagonal(A), INDEFINITE)
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
    """Analyse the pattern, and return the rows to form the Schur complement onto, if it pays."""
    if ports is not None:
        kept = _touched(ports.T)
        if kept.any() and not kept.all():
            # Of single rows: PARDISO crashes where Schur complements of blocks are asked for.
            handle = PardisoHandle(*upper_blocks(single_rows(A)), kept)
            if _pays(handle.entries, int(np.count_nonzero(kept)), ports.shape[0]):
                return handle, kept
            handle.release()
    return _in_blocks(A), np.zeros(A.shape[0], dtype=bool)


def _in_blocks(A: SparseMatrix, kind: int = POSITIVE_DEFINITE) -> PardisoHandle:
    upper = upper_blocks(node_blocks(A))
    return PardisoHandle(*upper, np.zeros(len(upper[2]) - 1, dtype=bool), kind)


def _pays(entries: int, front: int, n_port: int) -> bool:
    """Compare the elimination of a dense last front with the substitutions it makes unnecessary."""
    inner = entries - front**2 / 2
    return front**3 / 3 < 4 * inner * n_port


def _touched(columns: SparseMatrix) -> Mask:
    """Return which rows of sparse columns hold anything."""
    touched: Mask = np.diff(columns.tocsr().indptr) > 0
    return touched
