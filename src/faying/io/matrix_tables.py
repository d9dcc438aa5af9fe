"""Matrices from files, with row labels where present; node, dof and set tables.

SciPy's readers of Matrix Market and MATLAB files are compiled and trust the file: damaged files
crashed the process by writes beyond arrays (SciPy 1.17). They run in a separate process.
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

from faying._typing import Indices, Matrix, SparseMatrix
from faying.exceptions import FayingError, FormatError, refuse, refuse_value
from faying.files.contents import (
    check_room,
    check_rows,
    file_size,
    reason_of,
)
from faying.files.number_table import lines_of, numbers_in
from faying.files.numpy_archive import read_arrays, read_matrices
from faying.io.deck_lines import lines_of_file
from faying.io.isolated import read_isolated
from faying.io.matrix_labels import LabelledMatrix
from faying.io.nastran.cards import Card
from faying.io.nastran.fields import integer
from faying.io.nastran.tokenizer import read_cards

READERS: Mapping[str, str] = {
    ".npz": "faying.io.matrix_tables:read_npz",
    ".mtx": "faying.io.matrix_tables:read_market",
    ".mat": "faying.io.matrix_tables:read_matlab",
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

    If the file holds several matrices, the name ``"M"``, ``"C"`` or ``"K"`` selects one.
    """
    path = Path(path)
    if not path.is_file():
        refuse(f"matrix {name}: file '{path}' does not exist; check the path")
    reader_name = READERS.get(path.suffix.lower())
    if reader_name is None:
        refuse(
            f"matrix {name}: '{path}' ends in '{path.suffix}'; readable are {', '.join(READERS)}"
        )
    module, _, function = reader_name.partition(":")
    return _read(getattr(import_module(module), function), path, name)


def _read(reader: Callable[[Path, str], Any], path: Path, name: str) -> LabelledMatrix:
    try:
        labelled: LabelledMatrix = reader(path, name)
        return replace(labelled, matrix=_real(labelled.matrix, path, name))
    except FayingError:
        raise
    except Exception as error:  # readers raise any error for a damaged file
        message = f"matrix {name}: '{path}' cannot be read ({reason_of(error)}); write it again"
        raise FormatError(message) from error


def _real(matrix: Any, path: Path, name: str) -> SparseMatrix:
    if not sp.issparse(matrix):
        matrix = np.atleast_2d(np.asarray(matrix))
    else:
        check_rows(matrix.shape)
        # Compiled code follows indices wherever they point.
        if matrix.format in ("csr", "csc", "bsr"):
            matrix.check_format(full_check=True)
    if matrix.ndim != 2 or matrix.dtype.kind not in "fiub":
        refuse(
            f"matrix {name}: '{path}' holds an array of shape {matrix.shape} and type "
            f"{matrix.dtype}; expected a real matrix"
        )
    return sp.csr_array(matrix, dtype=np.float64)


def read_npz(path: Path, name: str) -> LabelledMatrix:
    """Read a matrix from ``scipy.sparse.save_npz`` or ``numpy.savez``."""
    if not zipfile.is_zipfile(path):
        refuse_value("it is not an .npz file")
    arrays = read_matrices(path)
    if "format" in arrays and "data" in arrays:
        return LabelledMatrix(matrix=sp.load_npz(path))
    return LabelledMatrix(matrix=_chosen(arrays, path, name))


def read_market(path: Path, name: str) -> LabelledMatrix:
    """Read a Matrix Market file, or an Abaqus file of the same suffix without heading."""
    with path.open("rb") as file:
        heading = file.read(14)
    if heading == b"%%MatrixMarket":
        return LabelledMatrix(matrix=_by_scipy(_MARKET, path, f"matrix {name}")[""])
    from faying.io.abaqus.matrices import read_abaqus_matrix

    return read_abaqus_matrix(path, name)


def read_matlab(path: Path, name: str) -> LabelledMatrix:
    """Read a MATLAB file up to version 7; from 7.3 on it is HDF5 and refused."""
    matrices = _by_scipy(_MATLAB, path, f"matrix {name}")
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
if layout == "array":  # SciPy takes missing lines as zero
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


def read_node_table(path: str | PathLike[str]) -> tuple[Indices, Matrix]:
    """Return ids (n,) and coordinates (n, 3) from rows of id, x, y, z.

    Text files (``.csv``, ``.txt``, ``.dat``) use commas, semicolons or blanks as separators and may
    have a heading line and comments after ``#``. An ``.npz`` holds one array (n, 4).
    """
    table = _numbers(Path(path), "node table", ("id", "x", "y", "z"))
    return _whole(table[:, :1], Path(path), "node id")[:, 0], table[:, 1:]


def read_dof_table(path: str | PathLike[str]) -> Indices:
    """Return node id and component 1..6 (n, 2) of each matrix row.

    Files are like those of :func:`read_node_table`, or the ``.pch`` of an external superelement of
    Nastran with its EXTRN card.
    """
    if Path(path).suffix.lower() == ".pch" and Path(path).is_file():
        return read_extrn(Path(path))
    table = _numbers(Path(path), "dof table", ("node", "component"))
    return _whole(table, Path(path), "dof table entry")


def read_id_sets(path: str | PathLike[str], what: str) -> dict[str, list[Indices]]:
    """Return named rows of node ids, from rows of name, id, … or an ``.npz`` of named arrays."""
    path = Path(path)
    if path.suffix.lower() == ".npz":
        return {
            name: list(_whole(np.atleast_2d(array), path, f"{what} '{name}'"))
            for name, array in _arrays(path, what).items()
        }
    sets: dict[str, list[Indices]] = {}
    rows = ((number, line.split(",")) for number, line in enumerate(_lines(path, what), 1) if line)
    for i, (line, texts) in enumerate(rows):
        ids = [text for text in texts[1:] if text]
        if not ids or not all(text.isascii() and text.isdigit() for text in ids):
            if i == 0:
                continue  # a heading
            refuse(f"{path}:{line}: {what} '{texts[0]}': expected name, node id, node id, …")
        sets.setdefault(texts[0], []).append(np.array([int(text[:18]) for text in ids]))
    return sets


def _arrays(path: Path, what: str) -> dict[str, Matrix]:
    _check_there(path, what)
    try:
        return read_arrays(path)
    except Exception as error:  # any error of a damaged archive
        message = (
            f"{what} '{path}' cannot be read ({reason_of(error)}); write it again by numpy.savez"
        )
        raise FormatError(message) from error


def _check_there(path: Path, what: str) -> None:
    if not path.is_file():
        refuse(f"{what} '{path}' does not exist; check the path")
    if path.suffix.lower() not in (".npz", ".csv", ".txt", ".dat"):
        refuse(f"{what} '{path}' ends in '{path.suffix}'; readable are .csv, .txt, .npz")


def _lines(path: Path, what: str) -> list[str]:
    """Return the lines of a table without comments, separated by commas alone."""
    _check_there(path, what)
    lines = (line.partition("#")[0].replace(";", ",") for line in lines_of(path, what))
    cells = (line.split(",") if "," in line else line.split() for line in lines)
    return [",".join(map(str.strip, row)) for row in cells]


def _numbers(path: Path, what: str, columns: tuple[str, ...]) -> Matrix:
    if path.suffix.lower() == ".npz":
        arrays = list(_arrays(path, what).values())
        table = arrays[0] if len(arrays) == 1 else np.zeros(0)
        if table.ndim != 2 or table.shape[1] != len(columns) or table.dtype.kind not in "fiu":
            refuse(
                f"{what} '{path}': expected one array of {len(columns)} columns: "
                f"{', '.join(columns)}"
            )
        return table.astype(np.float64)
    table = numbers_in(_lines(path, what), path, unnamed=columns).values
    if not len(table):
        refuse(f"{what} '{path}' has no rows of {', '.join(columns)}; add them")
    return table


def _whole(table: Matrix, path: Path, what: str) -> Indices:
    if table.dtype.kind not in "fiu":
        refuse(f"{what} in '{path}': expected whole numbers, found {table.dtype}")
    # Doubles hold whole numbers up to 2⁵³ exactly.
    wrong = ~(np.abs(table) < 2.0**53) | (table != np.floor(table))
    if wrong.any():
        refuse(f"{what} {table[wrong][0]:g} in '{path}' is not a whole number")
    return table.astype(np.int64)


def read_extrn(path: Path) -> Indices:
    """Return node id and component 1..6 (n, 2) of the rows of an external superelement's matrices.

    Nastran writes them to the ``.pch`` beside the OP4 file (EXTSEOUT with MATOP4 or
    DMIGOP4). Scalar points get component 1.
    """
    cards = read_cards(lines_of_file(path)).cards().get("EXTRN")
    if cards is None or len(cards) != 1:
        refuse(
            f"dof table '{path}' has {0 if cards is None else len(cards)} EXTRN cards; "
            "expected the punch file of one external superelement"
        )
    card = next(iter(cards))
    rows = [row for field in range(0, len(card), 2) for row in _rows_of_pair(card, field)]
    table = np.array(rows, dtype=np.int64).reshape(-1, 2)
    if len(np.unique(table, axis=0)) != len(table):
        card.refuse("a grid component occurs twice; keep one")
    return table


def _rows_of_pair(card: Card, field: int) -> list[tuple[int, int]]:
    """Return the rows of one pair of grid and components; scalar points have component 0."""
    grid, components = card.text(field), card.text(field + 1)
    if not grid and not components:
        return []
    number = integer(grid)
    digits = components or "0"
    good = digits == "0" or (set(digits) <= set("123456") and len(set(digits)) == len(digits))
    if number is None or number < 1 or not good:
        card.refuse(f"'{grid} {components}' is not a grid with its components", field)
    return [(number, max(int(digit), 1)) for digit in sorted(digits)]
