"""Nastran OUTPUT4 files: dense, sparse and BIGMAT, text and binary, either byte order.

An OP4 file is a list of named matrices. Each has a header (columns, rows, form, type, name), a
record for every nonzero column, and one record for the column after the last. A column
holds *strings*, runs of consecutive rows. Rows have no labels; faying's dof table assigns
degrees of freedom to rows.

Sizes in the file are checked before memory is allocated: every string must lie in its record and in
its matrix, and rows must ascend, so that a damaged file is refused and not misread.
"""

import struct
from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.exceptions import refuse_model
from faying.files.contents import file_bytes
from faying.io.matrix_labels import (
    REAL_DOUBLE,
    RECTANGULAR,
    SQUARE,
    SYMMETRIC,
    LabelledMatrix,
    chosen_name,
    damaged,
    reading,
)
from faying.io.op4_binary import BinaryFile, looks_binary
from faying.io.op4_text import TextFile
from faying.io.op4_values import COMPLEX, Header, Op4File, Strings, spread

FORMS = {SQUARE: "square", RECTANGULAR: "rectangular", SYMMETRIC: "symmetric"}
"""Matrix forms that are read; diagonal, triangular and other forms are refused."""


def read_op4_matrices(path: str | PathLike[str]) -> dict[str, SparseMatrix]:
    """Read all matrices of an OP4 file, by names as written without blanks.

    Raises
    ------
    FormatError
        If the file is missing, damaged, or holds a complex matrix, one of another form than
        square, rectangular or symmetric, or two of one name.

    Notes
    -----
    Format: OUTPUT4 and INPUTT4 in any Nastran's DMAP manual. Binary files are scanned record by
    record and read in batches; half a million columns take seconds.
    """
    return _read(Path(path), None)


def read_op4(path: Path, name: str) -> LabelledMatrix:
    """Read the matrix ``"M"``, ``"C"`` or ``"K"`` of an OP4 file.

    :func:`faying.io.matrix_labels.chosen_name` chooses it by its name. Other matrices of the file
    may be of any kind.
    """
    return LabelledMatrix(matrix=next(iter(_read(path, name).values())))


def _read(path: Path, letter: str | None) -> dict[str, SparseMatrix]:
    with reading("OP4", path):
        content = file_bytes(path)
        file: Op4File = BinaryFile(content) if looks_binary(content) else TextFile(content)
        stored = list(file.matrices())
        names = [header.name for header, _ in stored]
        chosen = names if letter is None else [chosen_name(names, letter)]
        for name in chosen:
            if (count := names.count(name)) > 1:
                damaged(f"it holds {count} matrices named {name}; write each to its own file")
        return {name: _assembled(file, *stored[names.index(name)]) for name in chosen}


def _check_readable(header: Header) -> None:
    matrix_label = f"matrix '{header.name}' ({header.position})"
    if header.kind in COMPLEX:
        damaged(f"{matrix_label} is complex; faying needs real matrices: write its real part")
    if header.form not in FORMS:
        readable = ", ".join(f"{number} ({text})" for number, text in FORMS.items())
        damaged(f"{matrix_label} has form {header.form}; readable are {readable}")
    if header.form == SYMMETRIC and header.rows != header.columns:
        damaged(
            f"{matrix_label} is symmetric (form 6) but has {header.rows} rows and "
            f"{header.columns} columns"
        )


def _check_strings(header: Header, strings: Strings) -> None:
    """Refuse strings outside the matrix and rows that do not ascend within a column."""
    last = strings.row + strings.count
    wrong = (strings.row < 0) | (strings.count < 1) | (last > header.rows)
    same = strings.column[1:] == strings.column[:-1]
    wrong[1:] |= same & (strings.row[1:] < last[:-1])
    if wrong.any():
        first = int(np.flatnonzero(wrong)[0])
        damaged(
            f"matrix '{header.name}' ({header.position}): column {strings.column[first] + 1} has "
            f"{strings.count[first]} values from row {strings.row[first] + 1} on; expected "
            f"ascending rows from 1 to {header.rows}"
        )


def _assembled(file: Op4File, header: Header, strings: Strings) -> SparseMatrix:
    _check_readable(header)
    _check_strings(header, strings)
    values = file.values(header, strings)
    if not np.isfinite(values).all():
        damaged(f"matrix '{header.name}' ({header.position}) holds NaN or infinity")
    starts = np.zeros(header.columns + 1, dtype=np.int64)
    np.add.at(starts, strings.column + 1, strings.count)
    rows = spread(strings.row, strings.count)
    shape = (header.rows, header.columns)
    matrix = sp.csc_array((values, rows, np.cumsum(starts)), shape=shape)
    matrix.eliminate_zeros()
    return sp.csr_array(matrix)


def write_op4(path: Path, matrices: Mapping[str, npt.ArrayLike]) -> None:
    """Write real matrices to one binary OP4 file: double precision, little endian, full columns.

    Names have up to eight letters and digits; a vector is one column.

    Raises
    ------
    ModelError
        If a name has more than eight letters or digits or does not begin with a letter, or a
        matrix is empty or not finite.
    """
    with path.open("wb") as file:
        for name, matrix in matrices.items():
            file.write(b"".join(_records(name, _checked(name, matrix))))


def _checked(name: str, matrix: npt.ArrayLike) -> Matrix:
    if not (name.isascii() and name.isalnum() and name[0].isalpha() and len(name) <= 8):
        refuse_model(f"'{name}' cannot name a Nastran matrix; use up to eight letters and digits")
    values = np.asarray(matrix, dtype=np.float64)
    table = values[:, None] if values.ndim == 1 else values
    if table.ndim != 2 or table.size == 0 or not np.isfinite(table).all():
        refuse_model(f"matrix '{name}' of shape {values.shape} is empty, no matrix, or not finite")
    return table


def _records(name: str, table: Matrix) -> list[bytes]:
    rows, columns = table.shape
    head = struct.pack("<4i", columns, rows, _form(table), REAL_DOUBLE)
    records = [_record(head + name.upper().ljust(8).encode())]
    for number, column in enumerate(table.T, start=1):
        filled = np.flatnonzero(column)
        if len(filled):
            first, last = int(filled[0]), int(filled[-1])
            records.append(_column(number, first + 1, column[first : last + 1]))
    # One value after the last column ends the matrix.
    records.append(_column(columns + 1, 1, np.ones(1)))
    return records


def _column(number: int, row: int, values: Matrix) -> bytes:
    words = 2 * len(values)
    return _record(struct.pack("<3i", number, row, words) + values.astype("<f8").tobytes())


def _record(content: bytes) -> bytes:
    length = struct.pack("<i", len(content))
    return length + content + length


def _form(table: Matrix) -> int:
    if table.shape[0] != table.shape[1]:
        return RECTANGULAR
    return SYMMETRIC if np.array_equal(table, table.T) else SQUARE
