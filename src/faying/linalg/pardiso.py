"""Cholesky factorization by MKL PARDISO: the fastest that pip installs on x86-64."""

import logging
import threading
import weakref
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.blocks import node_blocks, single_rows, upper_blocks
from faying.linalg.cholesky import inverse
from faying.linalg.memory import FactorMemory, NotEnoughMemoryError, require_memory
from faying.linalg.mkl import INDEFINITE, PardisoHandle
from faying.linalg.relative_unknowns import with_relative_unknowns
from faying.linalg.singular import InertiaError, NotDefiniteError, check_signs
from faying.linalg.substitution import column_blocks, solved_gram

_log = logging.getLogger("faying")

FEW_PORTS = 100
"""Largest number of ports for which a substitution for each is faster than a second factorization.

Both took the same time at 110 to 250 ports on joints of 8000 to 49 000 degrees of freedom.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class PardisoFactorization:
    """Cholesky factor inside PARDISO, freed with this object.

    Attributes
    ----------
    order
        Rows of the matrix, without those that PARDISO adds to fill a block.
    matrix
        The matrix that was factorized.
    """

    order: int
    matrix: SparseMatrix
    handle: PardisoHandle
    backend: str = "pardiso"
    _turn: threading.Lock = field(default_factory=threading.Lock, init=False, repr=False)

    def __post_init__(self) -> None:
        # At exit the system frees the memory anyway, and MKL's threads may be gone.
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
                solution[:, block] = _solve_padded(self.handle, columns[:, block])
        return solution.reshape(B.shape)

    def stiffness(self, ports: SparseMatrix | Matrix) -> Matrix | None:
        """Return (Q A⁻¹ Qᵀ)⁻¹ (n_port, n_port) for many ports Q (n_port, n), by (F14).

        None for few ports, for ports without distinct degrees of freedom, and, with a log entry, if
        the elimination does not fit into the free memory.
        """
        if not sp.issparse(ports) or ports.shape[0] <= FEW_PORTS:
            return None
        try:
            return port_stiffness(self.matrix, ports)
        except NotDefiniteError:  # where rows are eliminated in another order
            return None
        except NotEnoughMemoryError as error:
            _log.warning("%d ports are solved for one by one, for %s", ports.shape[0], error)
            return None

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k)."""
        stiffness = self.stiffness(columns.T)
        return solved_gram(self.solve, columns) if stiffness is None else inverse(stiffness)


def factorize_pardiso(A: SparseMatrix) -> PardisoFactorization:
    """Factorize a symmetric positive definite matrix, in its precision.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the free memory.
    """
    if not A.diagonal().min(initial=np.inf) > 0:
        raise NotDefiniteError  # and PARDISO wants every diagonal entry stored
    return _factorize_handle(A, PardisoHandle(*upper_blocks(node_blocks(A))))


def factorize_saddle_pardiso(A: SparseMatrix) -> PardisoFactorization:
    """Factorize a symmetric indefinite matrix, with zeros on its diagonal.

    Raises
    ------
    NotDefiniteError
        If it is singular but for round-off.
    NotEnoughMemoryError
        If the factor would not fit into the free memory.
    """
    blocks = upper_blocks(single_rows(_with_diagonal(A)))
    return _factorize_handle(A, PardisoHandle(*blocks, kind=INDEFINITE))


def _factorize_handle(A: SparseMatrix, handle: PardisoHandle) -> PardisoFactorization:
    try:
        require_memory(_expected_memory(handle, A.shape[0]))
        handle.factorize()
        if handle.perturbed:
            raise NotDefiniteError
    except BaseException:
        handle.release()
        raise
    return PardisoFactorization(order=A.shape[0], matrix=A, handle=handle)


def port_stiffness(A: SparseMatrix, ports: SparseMatrix) -> Matrix | None:
    """Return (Q A⁻¹ Qᵀ)⁻¹ (n_port, n_port) for ports Q (n_port, n), by (F14).

    None where ports have no distinct degrees of freedom.

    Raises
    ------
    NotDefiniteError
        If a pivot is not positive.
    NotEnoughMemoryError
        If the factor would not fit into the free memory.
    """
    handle = _analyse_bordered(A, ports)
    if handle is None:
        return None
    try:
        require_memory(_expected_memory(handle, A.shape[0], ports.shape[0]))
        return handle.schur_complement()
    finally:
        handle.release()


def _analyse_bordered(A: SparseMatrix, ports: SparseMatrix) -> PardisoHandle | None:
    """Return the analysis of A with relative displacements as its last unknowns."""
    unknowns = with_relative_unknowns(ports)
    if unknowns is None:
        return None
    upper = upper_blocks(single_rows(unknowns.T.tocsr() @ (A @ unknowns)))
    return PardisoHandle(*upper, border=ports.shape[0])


def count_negative_pardiso(A: SparseMatrix) -> int:
    """Return the number of negative eigenvalues of a symmetric matrix.

    Raises
    ------
    InertiaError
        If a pivot was too small to have a sign, or some grew too large.
    NotEnoughMemoryError
        If the factor would not fit into the free memory.
    """
    blocks = upper_blocks(node_blocks(_with_diagonal(A)))
    try:
        factorization = _factorize_handle(A, PardisoHandle(*blocks, kind=INDEFINITE))
    except NotDefiniteError:
        reason = "the matrix is singular but for round-off"
        raise InertiaError(reason) from None
    check_signs(A, factorization.solve)
    return factorization.handle.negative


def estimate_pardiso(A: SparseMatrix) -> FactorMemory:
    """Return the memory of :func:`factorize_pardiso`, from the pattern alone."""
    handle = PardisoHandle(*upper_blocks(node_blocks(_with_diagonal(A))))
    try:
        return _expected_memory(handle, A.shape[0])
    finally:
        handle.release()


def estimate_stiffness_pardiso(A: SparseMatrix, ports: SparseMatrix) -> int:
    """Return the peak bytes of (Q A⁻¹ Qᵀ)⁻¹ beyond the factors of A, from patterns."""
    handle = _analyse_bordered(_with_diagonal(A), ports) if ports.shape[0] > FEW_PORTS else None
    if handle is None:
        return 0
    try:
        return _expected_memory(handle, A.shape[0], ports.shape[0]).peak
    finally:
        handle.release()


def _expected_memory(handle: PardisoHandle, order: int, n_port: int = 0) -> FactorMemory:
    return FactorMemory(
        backend="pardiso",
        order=order,
        factor=handle.expected_memory,
        peak=handle.peak + 8 * n_port**2,
        counted=True,
    )


def _with_diagonal(A: SparseMatrix) -> SparseMatrix:
    """Return a matrix with all diagonal entries stored, as PARDISO requires."""
    stored = sp.csr_array(A, copy=True)
    stored.setdiag(A.diagonal())
    return stored


def _solve_padded(handle: PardisoHandle, columns: Matrix) -> Matrix:
    """Solve for right-hand sides, padded to whole blocks."""
    padded = np.zeros((handle.n, columns.shape[1]), dtype=handle.precision, order="F")
    padded[: len(columns)] = columns
    return handle.solve(padded)[: len(columns)]
