"""Array types and the frozen-array rule shared by every value of faying.

Dimensions used in shapes throughout the package:

====================  ==========================================================
``n_node``            nodes of the mesh
``n_dof``             free degrees of freedom of a system (full or reduced)
``n_point``           contact points (quadrature points of all interfaces)
``n_pair``            node pairs of an interface
``n_boundary``        boundary degrees of freedom, where loads enter
``n_bolt``            bolts
``n_pattern``         load patterns
``n_input``           boundary forces, initial bolt forces, amplitudes of load patterns
``n_mode``            columns of a basis
``n_time``            instants of a transient solution
``n_case``            load cases
====================  ==========================================================
"""

from dataclasses import fields
from types import UnionType
from typing import Any, TypeAlias, cast, get_args

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

# Written out: files are read by these annotations, and NDArray is an alias of another kind in each
# version of NumPy.
Vector = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
ComplexVector = np.ndarray[tuple[Any, ...], np.dtype[np.complex128]]
ComplexMatrix = np.ndarray[tuple[Any, ...], np.dtype[np.complex128]]
Indices = np.ndarray[tuple[Any, ...], np.dtype[np.int64]]
Mask = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
SparseMatrix: TypeAlias = sp.csr_array


def frozen(array: npt.ArrayLike, dtype: Any = np.float64) -> npt.NDArray[Any]:
    """Return ``array`` as a read-only contiguous NumPy array (copied only if it is writable)."""
    result = np.ascontiguousarray(array, dtype=dtype)
    if result.flags.writeable:
        result = result.copy() if result is array else result
        result.setflags(write=False)
    return result


_DTYPES = {
    Matrix: np.float64,
    ComplexMatrix: np.complex128,
    Indices: np.int64,
    Mask: np.bool_,
}


class Frozen:
    """Base of frozen dataclasses whose arrays are read-only, of the type that they are said to be.

    Sparse matrices and single numbers stay as they are given.
    """

    def __post_init__(self) -> None:
        for field in fields(cast("Any", self)):
            value = getattr(self, field.name)
            union = get_args(field.type) if isinstance(field.type, UnionType) else (field.type,)
            kinds = [kind for kind in union if kind in _DTYPES]
            if kinds and np.ndim(value) and not sp.issparse(value):
                object.__setattr__(self, field.name, frozen(value, _DTYPES[kinds[0]]))


def read_only(matrix: SparseMatrix) -> SparseMatrix:
    """Mark the arrays of a sparse matrix read-only and return it."""
    for part in (matrix.data, matrix.indices, matrix.indptr):
        part.setflags(write=False)
    return matrix
