"""Memory of a factorization that has not been made."""

from collections.abc import Callable

import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.backends import chosen_backend
from faying.linalg.budget import DENSE_COPIES
from faying.linalg.memory import FactorMemory
from faying.linalg.pardiso import estimate_pardiso, estimate_stiffness_pardiso
from faying.linalg.superlu import estimate_superlu

_ESTIMATES: dict[str, Callable[[SparseMatrix], FactorMemory]] = {
    "pardiso": estimate_pardiso,
    "superlu": estimate_superlu,
}


def estimate_memory(A: SparseMatrix | Matrix, *, backend: str | None = None) -> FactorMemory:
    """Tell what :func:`~faying.linalg.factorization.factorize` of the same arguments would take.

    Notes
    -----
    PARDISO analyses the pattern, a tenth of the factorization; for SuperLU a law is fitted.
    """
    if sp.issparse(A) and A.shape[0] > 0:
        return _ESTIMATES[chosen_backend(backend)](A)
    size = 8 * A.shape[0] ** 2
    return FactorMemory(
        backend="lapack", order=A.shape[0], factor=size, peak=2 * size, counted=True
    )


def estimate_port_memory(
    A: SparseMatrix, ports: SparseMatrix, *, backend: str | None = None
) -> tuple[int, int]:
    """Tell the most bytes that ports Q (n_port, n) take beyond the factors of A.

    Those while all but the ports are eliminated (F14), zero where they are not, and those of
    matrices between them.

    Notes
    -----
    PARDISO analyses the pattern once more.
    """
    dense = DENSE_COPIES * 8 * int(ports.shape[0]) ** 2
    if chosen_backend(backend) != "pardiso":
        return 0, dense
    return estimate_stiffness_pardiso(A, ports), dense
