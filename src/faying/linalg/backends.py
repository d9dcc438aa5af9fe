"""Libraries that factorize sparse matrices: which are here, and which is to be used.

A factorization A = L D Lᵀ leaves as many negative pivots as A has negative eigenvalues (Sylvester's
law of inertia). For A = K − σM of a vibrating structure these are its natural frequencies below
√σ/2π: the count that proves no mode was missed (B. N. Parlett, The Symmetric Eigenvalue Problem,
§3.3).
"""

import os
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.exceptions import ModelError
from faying.linalg.budget import DENSE_COPIES
from faying.linalg.interface import MatrixFactorization
from faying.linalg.memory import FactorMemory
from faying.linalg.mkl import load_mkl
from faying.linalg.pardiso import (
    count_negative_pardiso,
    estimate_pardiso,
    estimate_stiffness_pardiso,
    factorize_pardiso,
    factorize_saddle_pardiso,
)
from faying.linalg.substitution import dense
from faying.linalg.superlu import (
    count_negative_superlu,
    estimate_superlu,
    factorize_saddle_superlu,
    factorize_superlu,
)

VARIABLE = "FAYING_FACTORIZATION"
"""Environment variable that names the backend of sparse factorizations."""


class Backend(NamedTuple):
    """What a library does with symmetric sparse matrices.

    Attributes
    ----------
    factorize
        A definite one.
    factorize_saddle
        An indefinite one, with zeros on its diagonal.
    count_negative
        Eigenvalues, by a factorization that is not kept.
    estimate
        Memory of a factorization.
    estimate_border
        Most bytes while all but ports Q (n_port, n) are eliminated (F14); zero where they are not.
    """

    factorize: Callable[[SparseMatrix], MatrixFactorization]
    factorize_saddle: Callable[[SparseMatrix], MatrixFactorization]
    count_negative: Callable[[SparseMatrix], int]
    estimate: Callable[[SparseMatrix], FactorMemory]
    estimate_border: Callable[[SparseMatrix, SparseMatrix], int]


BACKENDS = {
    "pardiso": Backend(
        factorize_pardiso,
        factorize_saddle_pardiso,
        count_negative_pardiso,
        estimate_pardiso,
        estimate_stiffness_pardiso,
    ),
    "superlu": Backend(
        factorize_superlu,
        factorize_saddle_superlu,
        count_negative_superlu,
        estimate_superlu,
        lambda _, __: 0,
    ),
}
"""Name to library, the fastest first."""


def available_backends() -> tuple[str, ...]:
    """Return the backends for sparse matrices that work here, the fastest first."""
    return tuple(BACKENDS) if load_mkl() is not None else ("superlu",)


def chosen_backend(backend: str | None = None) -> str:
    """Return the backend asked for, else what the environment names, else the fastest."""
    available = available_backends()
    name = backend or os.environ.get(VARIABLE) or available[0]
    if name not in available:
        remedy = "pip install mkl" if name == "pardiso" else f"choose among {', '.join(BACKENDS)}"
        source = "backend" if backend else VARIABLE
        message = f"{source} = {name!r}: no such factorization here; {remedy}"
        raise ModelError(message)
    return name


def count_negative(A: SparseMatrix | Matrix, *, backend: str | None = None) -> int:
    """Count the negative eigenvalues of a symmetric matrix, sparse or dense.

    Raises
    ------
    InertiaError
        If round-off could have changed the sign of a pivot.

    Notes
    -----
    One factorization, which is not kept.
    """
    if sp.issparse(A) and A.shape[0] > 0:
        return BACKENDS[chosen_backend(backend)].count_negative(A)
    return int(np.count_nonzero(la.eigvalsh(dense(A)) < 0))


def estimate_memory(A: SparseMatrix | Matrix, *, backend: str | None = None) -> FactorMemory:
    """Tell what :func:`~faying.linalg.factorization.factorize` of the same arguments would take.

    Notes
    -----
    PARDISO analyses the pattern, a tenth of the factorization; for SuperLU a law is fitted.
    """
    if sp.issparse(A) and A.shape[0] > 0:
        return BACKENDS[chosen_backend(backend)].estimate(A)
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
    border = BACKENDS[chosen_backend(backend)].estimate_border(A, ports)
    return border, DENSE_COPIES * 8 * int(ports.shape[0]) ** 2
