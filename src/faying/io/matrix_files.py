"""One matrix from one file, of this or another program, with row labels where it has them.

SciPy's readers of Matrix Market and MATLAB files are compiled and trust the file: damaged ones
ended the process by writes beyond its arrays (seen with SciPy 1.17). They have one of their own.
"""

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from faying._typing import SparseMatrix
from faying.exceptions import FayingError, FormatError
from faying.files.contents import check_room, check_rows, file_size, reason_of
from faying.files.numpy_archive import read_matrices
from faying.io.isolated import read_isolated
from faying.io.matrix_labels import LabelledMatrix

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


def read_matrix(path: str | PathLike[str], name: str) -> LabelledMatrix:
    """Read a sparse or dense real matrix from a file of a kind in :data:`READERS`, by its suffix.

    Where a file holds several the name, ``"M"``, ``"C"`` or ``"K"``, is the variable to take.
    """
    path = Path(path)
    if not path.is_file():
        message = f"matrix {name}: file '{path}' is not there; check the path"
        raise FormatError(message)
    reader_name = READERS.get(path.suffix.lower())
    if reader_name is None:
        message = (
            f"matrix {name}: '{path}' ends in '{path.suffix}'; readable are {', '.join(READERS)}"
        )
        raise FormatError(message)
    module, _, function = reader_name.partition(":")
    return _read(getattr(import_module(module), function), path, name)


def _read(reader: Callable[[Path, str], Any], path: Path, name: str) -> LabelledMatrix:
    try:
        labelled: LabelledMatrix = reader(path, name)
        return replace(labelled, matrix=_real(labelled.matrix, path, name))
    except FayingError:
        raise
    except Exception as error:  # readers raise whatever a damaged file meets
        message = f"matrix {name}: '{path}' cannot be read ({reason_of(error)}); write it again"
        raise FormatError(message) from error


def _real(matrix: Any, path: Path, name: str) -> SparseMatrix:
    if not sp.issparse(matrix):
        matrix = np.atleast_2d(np.asarray(matrix))
    else:
        _check_indices(matrix)
    if matrix.ndim != 2 or matrix.dtype.kind not in "fiub":
        message = (
            f"matrix {name}: '{path}' holds an array of shape {matrix.shape} and type "
            f"{matrix.dtype}; expected a real matrix"
        )
        raise FormatError(message)
    return sp.csr_array(matrix, dtype=np.float64)


def _check_indices(matrix: Any) -> None:
    """Refuse indices that are out of range, which compiled code follows wherever they point."""
    check_rows(matrix.shape)
    if matrix.format in ("csr", "csc", "bsr"):
        matrix.check_format(full_check=True)


def read_npz(path: Path, name: str) -> LabelledMatrix:
    """Read a matrix from ``scipy.sparse.save_npz`` or ``numpy.savez``."""
    if not zipfile.is_zipfile(path):
        message = "it is no .npz file"
        raise ValueError(message)
    arrays = read_matrices(path)
    if "format" in arrays and "data" in arrays:
        return LabelledMatrix(matrix=sp.load_npz(path))
    return LabelledMatrix(matrix=_chosen(arrays, path, name))


def read_market(path: Path, name: str) -> LabelledMatrix:
    """Read a Matrix Market file, or one of Abaqus, which has the same suffix but no heading."""
    with path.open("rb") as file:
        heading = file.read(14)
    if heading == b"%%MatrixMarket":
        return LabelledMatrix(matrix=read_market_matrix(path, f"matrix {name}"))
    from faying.io.abaqus.matrices import read_abaqus_matrix

    return read_abaqus_matrix(path, name)


def read_matlab(path: Path, name: str) -> LabelledMatrix:
    """Read a MATLAB file up to version 7; from 7.3 on it is HDF5 and refused."""
    matrices = read_matlab_matrices(path, f"matrix {name}")
    return LabelledMatrix(matrix=_chosen(matrices, path, name))


def _chosen(variables: Mapping[str, Any], path: Path, name: str) -> Any:
    """Return the matrix of the right name, or the only one."""
    if name in variables:
        return variables[name]
    if len(variables) == 1:
        return next(iter(variables.values()))
    names = ", ".join(variables) or "nothing"
    message = f"matrix {name}: '{path}' holds {names}; name one of them {name}"
    raise FormatError(message)


_SAVED = """
parts = {}
for name, value in matrices.items():
    entries = sp.coo_array(value)
    parts |= {name + "/row": entries.row, name + "/col": entries.col, name + "/data": entries.data}
    parts[name + "/shape"] = np.array(value.shape)
np.savez(sys.argv[2], **parts)
"""

_MARKET = """
import sys
import numpy as np, scipy.io, scipy.sparse as sp
rows, columns, _, layout, field, symmetry = scipy.io.mminfo(sys.argv[1])
if field not in ("real", "integer", "unsigned-integer"):
    sys.exit(f"it is {field} {symmetry}; expected real or integer, general or symmetric")
if layout == "array":  # of one that is cut off SciPy takes the remainder as zero
    sides = {"general": 2 * columns, "symmetric": rows + 1, "skew-symmetric": rows - 1}
    with open(sys.argv[1]) as file:
        lines = sum(1 for line in file if line.strip() and line[0] != "%") - 1
    if 2 * lines != rows * sides[symmetry]:
        sys.exit(f"it is a {symmetry} matrix {rows} x {columns} and holds {lines} numbers")
matrices = {"": scipy.io.mmread(sys.argv[1])}
"""

_MATLAB = """
import sys
import numpy as np, scipy.io, scipy.sparse as sp
try:
    variables = scipy.io.loadmat(sys.argv[1])
except NotImplementedError:
    sys.exit("it is a MATLAB 7.3 file; save it in MATLAB with save(..., '-v7')")
numbers = {
    name: value
    for name, value in variables.items()
    if name[:2] != "__" and getattr(value, "ndim", 0) == 2 and value.dtype.kind in "fiubc"
}
matrices = {name: value for name, value in numbers.items() if min(value.shape) > 1} or numbers
"""


def read_market_matrix(path: Path, what: str) -> SparseMatrix:
    """Read a real matrix, of coordinates or an array."""
    return _by_scipy(_MARKET, path, what)[""]


def read_matlab_matrices(path: Path, what: str) -> dict[str, SparseMatrix]:
    """Read the matrices of a MATLAB file up to version 7; vectors and numbers where it has none.

    Variables of other classes are left out.
    """
    return _by_scipy(_MATLAB, path, what)


def _by_scipy(script: str, path: Path, what: str) -> dict[str, SparseMatrix]:
    check_room(file_size(path), path)
    parts = read_isolated(script + _SAVED, path, what)
    names = [key.removesuffix("/shape") for key in parts if key.endswith("/shape")]
    return {
        name: sp.coo_array(
            (parts[f"{name}/data"], (parts[f"{name}/row"], parts[f"{name}/col"])),
            shape=tuple(parts[f"{name}/shape"].tolist()),
        )
        for name in names
    }
