"""Factorization of symmetric positive definite matrices, by the best backend at hand."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.backends import VARIABLE, available_backends, chosen_backend
from faying.linalg.cholesky import factorize_condensed
from faying.linalg.dissected import DissectedFactorization, SparseBackend, has_many
from faying.linalg.interface import Factorization, MatrixFactorization
from faying.linalg.pardiso import factorize_pardiso
from faying.linalg.singular import (
    MECHANISM,
    NotDefiniteError,
    SingularMatrixError,
    softest_motion,
)
from faying.linalg.substitution import dense
from faying.linalg.superlu import factorize_superlu

__all__ = [
    "MECHANISM",
    "VARIABLE",
    "Factorization",
    "MatrixFactorization",
    "SingularMatrixError",
    "available_backends",
    "factorize",
    "factorize_condensed",
]

SHIFT = 1e-10
"""Part of the diagonal that makes a structure factorizable which can move freely."""

_BACKENDS: dict[str, SparseBackend] = {"pardiso": factorize_pardiso, "superlu": factorize_superlu}


def factorize(
    A: SparseMatrix | Matrix,
    *,
    ports: SparseMatrix | None = None,
    backend: str | None = None,
) -> MatrixFactorization:
    """Factorize a symmetric positive definite matrix, sparse or dense.

    A matrix condensed from a larger one goes to :func:`factorize_condensed`.

    Parameters
    ----------
    ports : (n_port, n)
        Rows Q whose compliance Q A⁻¹ Qᵀ will be wanted, so that
        :func:`~faying.linalg.partial.port_compliance` needs no complete back-substitutions: a
        backend that can orders the elimination for it, and many ports are dissected.
    backend
        ``"pardiso"`` or ``"superlu"``; by default what the environment variable
        ``FAYING_FACTORIZATION`` names, else the fastest there is. Dense matrices go to LAPACK.

    Raises
    ------
    SingularMatrixError
        If some motion meets no resistance; the error carries that motion.
    ModelError
        If the backend is unknown or not installed.
    NotEnoughMemoryError
        If the factors would not fit into the memory that is free.

    Notes
    -----
    About O(n²) for solids. A matrix that is regular but indefinite is accepted and given to
    SuperLU.

    Examples
    --------
    >>> import numpy as np
    >>> factorize(np.diag([2.0, 4.0])).solve(np.array([1.0, 1.0]))
    array([0.5 , 0.25])
    """
    chosen = _BACKENDS[chosen_backend(backend)]
    if sp.issparse(A) and A.shape[0] > 0:
        return _factorize_sparse(A, ports, chosen)
    whole = dense(A)
    return factorize_condensed(whole, np.diag(whole))


def _factorize_sparse(
    A: SparseMatrix, ports: SparseMatrix | None, backend: SparseBackend
) -> MatrixFactorization:
    try:
        factorization = _factorize_definite(A, ports, backend)
    except NotDefiniteError:
        factorization = _factorize_indefinite(A, backend)
    motion, resistance = softest_motion(A, factorization)
    if resistance < MECHANISM:
        raise SingularMatrixError(motion)
    return factorization


def _factorize_definite(
    A: SparseMatrix, ports: SparseMatrix | None, backend: SparseBackend
) -> MatrixFactorization:
    if ports is None or not has_many(ports.shape):
        return backend(A, ports)
    return DissectedFactorization(factor=backend(A, None), A=sp.csr_array(A), factorize=backend)


def _factorize_indefinite(A: SparseMatrix, backend: SparseBackend) -> MatrixFactorization:
    """Tell a structure that can move from a matrix that is merely indefinite."""
    diagonal = A.diagonal()
    shifted = A + SHIFT * sp.diags_array(diagonal + diagonal.mean())
    try:
        motion = softest_motion(A, backend(shifted, None))[0]
    except NotDefiniteError:
        return factorize_superlu(A)
    raise SingularMatrixError(motion)
