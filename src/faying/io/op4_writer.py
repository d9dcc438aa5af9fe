"""Binary OUTPUT4 of dense matrices, as any Nastran's INPUTT4 reads it."""

import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.named_matrices import REAL_DOUBLE, RECTANGULAR, SQUARE, SYMMETRIC


def write_op4(path: Path, matrices: Mapping[str, npt.ArrayLike]) -> None:
    """Write real matrices to one binary OP4 file: double precision, little endian, full columns.

    Parameters
    ----------
    matrices
        Name of up to eight letters and digits to (rows, columns); a vector is one column.

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
        message = f"'{name}' is no name for a Nastran matrix; use up to eight letters and digits"
        raise ModelError(message)
    values = np.asarray(matrix, dtype=np.float64)
    table = values[:, None] if values.ndim == 1 else values
    if table.ndim != 2 or table.size == 0 or not np.isfinite(table).all():
        message = f"matrix '{name}' of shape {values.shape} is empty, no matrix, or not finite"
        raise ModelError(message)
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
