"""Backends: the libraries that factorize sparse matrices, and the choice between them.

A factorization A = L D Lᵀ has as many negative pivots as A has negative eigenvalues (Sylvester's
law of inertia). For A = K − σM of a vibrating structure these are its natural frequencies below
√σ/2π: the count that proves that no mode was missed (B. N. Parlett, The Symmetric Eigenvalue
Problem, §3.3).
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
    """Functions of a library for symmetric sparse matrices.

    Attributes
    ----------
    factorize
        Factorize a definite matrix.
    factorize_saddle
        Factorize an indefinite matrix with zeros on its diagonal.
    count_negative
        Count negative eigenvalues, by a factorization that is not kept.
    estimate
        Estimate the memory of a factorization.
    estimate_border
        Peak bytes of the elimination of all but ports Q (n_port, n) (F14); zero without it.
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
    """Return the names of the installed backends for sparse matrices, the fastest first."""
    return tuple(BACKENDS) if load_mkl() is not None else ("superlu",)


def chosen_backend(backend: str | None = None) -> str:
    """Return the given backend, else that of the environment variable, else the fastest."""
    available = available_backends()
    name = backend or os.environ.get(VARIABLE) or available[0]
    if name not in available:
        remedy = "pip install mkl" if name == "pardiso" else f"choose among {', '.join(BACKENDS)}"
        source = "backend" if backend else VARIABLE
        message = f"{source} = {name!r}: no such factorization here; {remedy}"
        raise ModelError(message)
    return name


def count_negative(A: SparseMatrix | Matrix, *, backend: str | None = None) -> int:
    """Return the number of negative eigenvalues of a symmetric matrix, sparse or dense.

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
    """Return the memory that :func:`~faying.linalg.factorization.factorize` would take.

    Notes
    -----
    PARDISO analyses the pattern, a tenth of the factorization; for SuperLU by a fitted law.
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
    """Return the peak bytes for ports Q (n_port, n) beyond the factors of A, in two parts.

    The first is for the elimination of all but the ports (F14), zero if there is none; the second
    for dense matrices between the ports.

    Notes
    -----
    PARDISO analyses the pattern once more.
    """
    border = BACKENDS[chosen_backend(backend)].estimate_border(A, ports)
    return border, DENSE_COPIES * 8 * int(ports.shape[0]) ** 2
