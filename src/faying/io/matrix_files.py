"""One matrix from one file, of this or another program, with row labels where it has them."""

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse as sp

from faying._typing import SparseMatrix
from faying.exceptions import FormatError
from faying.io.labelled_matrix import LabelledMatrix

READERS: Mapping[str, str] = {
    ".npz": "faying.io.matrix_files:read_npz",
    ".mtx": "faying.io.matrix_files:read_market",
    ".mat": "faying.io.matrix_files:read_matlab",
    ".op4": "faying.io.op4:read_op4",
    ".pch": "faying.io.dmig:read_dmig",
    ".dmig": "faying.io.dmig:read_dmig",
    ".full": "faying.io.ansys_full:read_full",
    ".sti": "faying.io.abaqus.matrices:read_calculix_matrix",
    ".mas": "faying.io.abaqus.matrices:read_calculix_matrix",
}
"""Suffix to module:function (path, name) → labelled matrix; imported when needed."""


_MARKET = b"%%MatrixMarket"


def read_matrix(path: str | PathLike[str], name: str) -> LabelledMatrix:
    """Read a sparse or dense real matrix.

    Parameters
    ----------
    path
        A file of one of the kinds in :data:`READERS`, told by its suffix.
    name
        ``"M"``, ``"C"`` or ``"K"``: the variable to take where a file holds several.

    Raises
    ------
    FormatError
        If the file is missing, of another kind, damaged, or holds no such matrix.
    """
    path = Path(path)
    if not path.is_file():
        message = f"matrix {name}: file '{path}' is not there; check the path"
        raise FormatError(message)
    place = READERS.get(path.suffix.lower())
    if place is None:
        message = (
            f"matrix {name}: '{path}' ends in '{path.suffix}'; readable are {', '.join(READERS)}"
        )
        raise FormatError(message)
    module, _, function = place.partition(":")
    found: LabelledMatrix = _guarded(getattr(import_module(module), function), path, name)
    return replace(found, matrix=_real(found.matrix, path, name))


def _guarded(reader: Callable[[Path, str], Any], path: Path, name: str) -> Any:
    damage = (OSError, ValueError, KeyError, TypeError, EOFError, IndexError, OverflowError)
    try:
        return reader(path, name)
    except (*damage, zipfile.BadZipFile, MemoryError, scipy.io.matlab.MatReadError) as error:
        message = f"matrix {name}: '{path}' cannot be read ({error}); write it again"
        raise FormatError(message) from error


def _real(matrix: Any, path: Path, name: str) -> SparseMatrix:
    if not sp.issparse(matrix):
        matrix = np.atleast_2d(np.asarray(matrix))
    if matrix.ndim != 2 or matrix.dtype.kind not in "fiub":
        message = (
            f"matrix {name}: '{path}' holds an array of shape {matrix.shape} and type "
            f"{matrix.dtype}; expected a real matrix"
        )
        raise FormatError(message)
    return sp.csr_array(matrix, dtype=np.float64)


def read_npz(path: Path, name: str) -> LabelledMatrix:
    """Read a matrix from ``scipy.sparse.save_npz`` or ``numpy.savez``."""
    if not zipfile.is_zipfile(path):
        message = "it is no .npz file"
        raise ValueError(message)
    with np.load(path, allow_pickle=False) as file:
        if "format" in file.files and "data" in file.files:
            return LabelledMatrix(matrix=sp.load_npz(path))
        arrays = {key: file[key] for key in file.files}
        return LabelledMatrix(matrix=_chosen(arrays, path, name))


def read_market(path: Path, name: str) -> LabelledMatrix:
    """Read a Matrix Market file, or one of Abaqus, which has the same suffix but no heading."""
    with path.open("rb") as file:
        heading = file.read(len(_MARKET))
    if heading == _MARKET:
        return LabelledMatrix(matrix=scipy.io.mmread(path))
    from faying.io.abaqus.matrices import read_abaqus_matrix

    return read_abaqus_matrix(path, name)


def read_matlab(path: Path, name: str) -> LabelledMatrix:
    """Read a MATLAB file up to version 7; from 7.3 on it is HDF5 and refused."""
    try:
        found = scipy.io.loadmat(path, spmatrix=False)
    except NotImplementedError as error:
        message = (
            f"matrix {name}: '{path}' is a MATLAB 7.3 file; save it in MATLAB with save(..., '-v7')"
        )
        raise FormatError(message) from error
    matrices = {
        key: value
        for key, value in found.items()
        if not key.startswith("__") and getattr(value, "ndim", 0) == 2 and min(value.shape) > 1
    }
    chosen = matrices or {k: v for k, v in found.items() if k[:2] != "__"}
    return LabelledMatrix(matrix=_chosen(chosen, path, name))


def _chosen(found: Mapping[str, Any], path: Path, name: str) -> Any:
    """Return the matrix of the right name, or the only one."""
    if name in found:
        return found[name]
    if len(found) == 1:
        return next(iter(found.values()))
    held = ", ".join(found) or "nothing"
    message = f"matrix {name}: '{path}' holds {held}; name one of them {name}"
    raise FormatError(message)
