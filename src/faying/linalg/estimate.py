"""Memory of a factorization that has not been made."""

from collections.abc import Callable

import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.backends import chosen_backend
from faying.linalg.dissected import has_many
from faying.linalg.memory import FactorMemory
from faying.linalg.pardiso import estimate_pardiso
from faying.linalg.superlu import estimate_superlu

_ESTIMATES: dict[str, Callable[[SparseMatrix, SparseMatrix | None], FactorMemory]] = {
    "pardiso": estimate_pardiso,
    "superlu": estimate_superlu,
}


def estimate_memory(
    A: SparseMatrix | Matrix, *, ports: SparseMatrix | None = None, backend: str | None = None
) -> FactorMemory:
    """Tell what :func:`~faying.linalg.factorization.factorize` of the same arguments would take.

    Notes
    -----
    PARDISO analyses the pattern, a tenth of the factorization; for SuperLU a law is fitted.
    """
    if sp.issparse(A) and A.shape[0] > 0:
        told = ports if ports is not None and not has_many(ports.shape) else None
        return _ESTIMATES[chosen_backend(backend)](A, told)
    size = 8 * A.shape[0] ** 2
    return FactorMemory(
        backend="lapack", order=A.shape[0], factor=size, peak=2 * size, counted=True
    )
