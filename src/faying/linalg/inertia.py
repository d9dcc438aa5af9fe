"""How many eigenvalues of a symmetric matrix are negative, by Sylvester's law of inertia.

A factorization A = L D Lᵀ leaves as many negative pivots as A has negative eigenvalues. For
A = K − σM of a vibrating structure these are its natural frequencies below √σ/2π: the count that
proves no mode was missed (B. N. Parlett, The Symmetric Eigenvalue Problem, §3.3).
"""

from collections.abc import Callable

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.linalg.backends import chosen_backend
from faying.linalg.pardiso import count_negative_pardiso
from faying.linalg.substitution import dense
from faying.linalg.superlu import count_negative_superlu

_COUNTS: dict[str, Callable[[SparseMatrix], int]] = {
    "pardiso": count_negative_pardiso,
    "superlu": count_negative_superlu,
}


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
        return _COUNTS[chosen_backend(backend)](A)
    return int(np.count_nonzero(la.eigvalsh(dense(A)) < 0))
