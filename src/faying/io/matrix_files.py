"""One matrix from one file: NumPy/SciPy ``.npz``, Matrix Market ``.mtx``, MATLAB ``.mat``."""

import zipfile
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io
import scipy.sparse as sp

from faying._typing import SparseMatrix
from faying.exceptions import FormatError


def read_matrix(path: str | PathLike[str], name: str) -> SparseMatrix:
    """Read a sparse or dense real matrix.

    Parameters
    ----------
    path
        ``.npz`` (``scipy.sparse.save_npz``, or one dense array), ``.mtx`` (Matrix Market) or
        ``.mat`` (MATLAB up to version 7; from 7.3 on the file is HDF5 and refused).
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
    readers = {".npz": _npz, ".mtx": _market, ".mat": _matlab}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        message = (
            f"matrix {name}: '{path}' ends in '{path.suffix}'; readable are {', '.join(readers)}"
        )
        raise FormatError(message)
    return _real(_guarded(reader, path, name), path, name)


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


def _npz(path: Path, name: str) -> Any:
    if not zipfile.is_zipfile(path):
        message = "it is no .npz file"
        raise ValueError(message)
    with np.load(path, allow_pickle=False) as file:
        if "format" in file.files and "data" in file.files:
            return sp.load_npz(path)
        return _chosen({key: file[key] for key in file.files}, path, name)


def _market(path: Path, _: str) -> Any:
    return scipy.io.mmread(path)


def _matlab(path: Path, name: str) -> Any:
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
    return _chosen(matrices or {k: v for k, v in found.items() if k[:2] != "__"}, path, name)


def _chosen(found: Mapping[str, Any], path: Path, name: str) -> Any:
    """Return the matrix of the right name, or the only one."""
    if name in found:
        return found[name]
    if len(found) == 1:
        return next(iter(found.values()))
    held = ", ".join(found) or "nothing"
    message = f"matrix {name}: '{path}' holds {held}; name one of them {name}"
    raise FormatError(message)
