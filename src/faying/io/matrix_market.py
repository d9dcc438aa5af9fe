"""Matrix Market files, read with every size and index checked.

SciPy's reader is nine times as fast, but a damaged file can end the process by a write beyond its
arrays (seen with SciPy 1.17 on files cut off, lengthened or with another size).
"""

import warnings
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, Vector
from faying.files.contents import check_rows, file_bytes

HEADING = b"%%MatrixMarket"

_MIRRORED = {"general": 0.0, "symmetric": 1.0, "skew-symmetric": -1.0}
"""Symmetry to the factor of the entries below the diagonal that are not written above it."""


def read_market_matrix(path: Path) -> SparseMatrix | Matrix:
    """Read a real matrix: sparse from coordinates, dense from an array.

    Raises
    ------
    OSError
        If the file cannot be read, or is larger than the memory that is free.
    ValueError
        If it is complex or a pattern, or its sizes, numbers and heading contradict each other.

    Notes
    -----
    About a second for a million entries.
    """
    layout, symmetry, sizes, numbers = _parts(file_bytes(path))
    return {"coordinate": _coordinates, "array": _array}[layout](symmetry, sizes, numbers)


def _parts(content: bytes) -> tuple[str, str, list[int], Vector]:
    """Layout, symmetry, sizes and all numbers."""
    heading, _, remainder = content.partition(b"\n")
    words = heading.decode("latin-1").lower().split()
    if len(words) != 5 or words[1] != "matrix" or words[2] not in ("coordinate", "array"):
        message = f"its heading is '{heading[:80].decode('latin-1')}'"
        raise ValueError(message)
    if words[3] not in ("real", "double", "integer") or words[4] not in _MIRRORED:
        message = f"it is {words[3]} {words[4]}; expected real or integer, general or symmetric"
        raise ValueError(message)
    while remainder.lstrip().startswith(b"%"):
        remainder = remainder.lstrip().partition(b"\n")[2]
    line, _, body = remainder.lstrip().partition(b"\n")
    sizes = line.split()
    if len(sizes) != (3 if words[2] == "coordinate" else 2) or not all(map(_is_size, sizes)):
        message = f"its line of sizes is '{line[:80].decode('latin-1')}'"
        raise ValueError(message)
    return words[2], words[4], [int(size) for size in sizes], _numbers(body)


def _is_size(text: bytes) -> bool:
    return text.isdigit() and len(text) < 16


def _numbers(text: bytes) -> Vector:
    with warnings.catch_warnings():
        # NumPy 2.4 only warns of text that is no number and leaves away what follows.
        warnings.simplefilter("error", DeprecationWarning)
        return np.fromstring(text, sep=" ")


def _coordinates(symmetry: str, sizes: list[int], numbers: Vector) -> SparseMatrix:
    rows, columns, count = sizes
    if len(numbers) != 3 * count:
        message = f"it announces {count} entries and holds {len(numbers) / 3:g}"
        raise ValueError(message)
    table = numbers.reshape(-1, 3)
    indices, values = table[:, :2] - 1, table[:, 2]
    wrong = np.flatnonzero(
        ~((indices >= 0) & (indices < (rows, columns)) & (indices == np.floor(indices))).all(axis=1)
    )
    if wrong.size:
        row, column = table[wrong[0], :2].tolist()
        message = (
            f"entry {wrong[0] + 1} is at row {row:g}, column {column:g} of a matrix of {rows} rows "
            f"and {columns} columns"
        )
        raise ValueError(message)
    check_rows((rows, columns))
    matrix = sp.coo_array((values, indices.astype(np.int64).T), shape=(rows, columns)).tocsr()
    return _mirrored(matrix, symmetry)


def _array(symmetry: str, sizes: list[int], numbers: Vector) -> Matrix:
    rows, columns = sizes
    # Of a symmetric matrix the lower triangle is written, column by column.
    skewed = int(symmetry == "skew-symmetric")
    expected = rows * columns if symmetry == "general" else rows * (rows + 1 - 2 * skewed) // 2
    if len(numbers) != expected or (symmetry != "general" and rows != columns):
        message = f"it is a {symmetry} matrix {rows} x {columns} and holds {len(numbers)} numbers"
        raise ValueError(message)
    if symmetry == "general":
        return numbers.reshape(columns, rows).T
    upper = np.zeros((rows, columns))
    upper[np.triu_indices(rows, skewed)] = numbers
    return np.asarray(upper.T + _MIRRORED[symmetry] * np.triu(upper, 1))


def _mirrored(matrix: SparseMatrix, symmetry: str) -> SparseMatrix:
    """Add the half that a symmetric file leaves away."""
    if symmetry == "general":
        return matrix
    if matrix.shape[0] != matrix.shape[1]:
        message = f"it is {symmetry} and has {matrix.shape[0]} rows and {matrix.shape[1]} columns"
        raise ValueError(message)
    off = matrix - sp.diags_array(matrix.diagonal())
    return sp.csr_array(matrix + _MIRRORED[symmetry] * off.T)
