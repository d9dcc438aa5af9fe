"""Factorization of symmetric positive definite matrices, by the best available backend."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.backends import BACKENDS, Backend, chosen_backend
from faying.linalg.cholesky import factorize_condensed
from faying.linalg.interface import MatrixFactorization
from faying.linalg.singular import (
    MECHANISM,
    NotDefiniteError,
    SingularMatrixError,
    softest_motion,
)
from faying.linalg.substitution import dense
from faying.linalg.superlu import factorize_superlu

SHIFT = 1e-10
"""Part of the diagonal that makes the matrix of a free structure factorizable."""


def factorize(A: SparseMatrix | Matrix, *, backend: str | None = None) -> MatrixFactorization:
    """Factorize a symmetric positive definite matrix, sparse or dense.

    A matrix condensed from a larger one goes to :func:`factorize_condensed`.

    Parameters
    ----------
    backend
        ``"pardiso"`` or ``"superlu"``; by default the one that the environment variable
        ``FAYING_FACTORIZATION`` names, else the fastest. Dense matrices go to LAPACK.

    Raises
    ------
    SingularMatrixError
        If some motion meets no resistance; the error carries that motion.
    ModelError
        If the backend is unknown or not installed.
    NotEnoughMemoryError
        If the factors would not fit into the free memory.

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
    chosen = BACKENDS[chosen_backend(backend)]
    if sp.issparse(A) and A.shape[0] > 0:
        return _factorize_sparse(A, chosen)
    whole = dense(A)
    return factorize_condensed(whole, np.diag(whole))


def factorize_saddle(A: SparseMatrix) -> MatrixFactorization:
    """Factorize a sparse symmetric indefinite matrix with zeros on its diagonal.

    Raises
    ------
    NotDefiniteError
        If it is singular.
    """
    return BACKENDS[chosen_backend(None)].factorize_saddle(A)


def _factorize_sparse(A: SparseMatrix, backend: Backend) -> MatrixFactorization:
    try:
        factorization = backend.factorize(A)
    except NotDefiniteError:
        factorization = _factorize_indefinite(A, backend)
    motion, resistance = softest_motion(A, factorization)
    if resistance < MECHANISM:
        raise SingularMatrixError(motion)
    return factorization


def _factorize_indefinite(A: SparseMatrix, backend: Backend) -> MatrixFactorization:
    """Factorize an indefinite matrix; refuse one of a structure that can move freely."""
    diagonal = A.diagonal()
    shifted = A + SHIFT * sp.diags_array(diagonal + diagonal.mean())
    try:
        motion = softest_motion(A, backend.factorize(shifted))[0]
    except NotDefiniteError:
        return factorize_superlu(A)
    raise SingularMatrixError(motion)
