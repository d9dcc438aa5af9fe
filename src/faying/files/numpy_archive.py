"""Arrays of untrusted NumPy archives (``.npz``).

The size of every array is read from its header before memory is allocated. Pickled objects,
which could run code, are refused.
"""

import math
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from numpy.lib import format as npy

from faying._typing import SparseMatrix
from faying.exceptions import refuse_value
from faying.files.contents import check_room
from faying.linalg.pieces import PIECE_NUMBERS

_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of an archive by name."""
    with zipfile.ZipFile(path) as archive:
        check_room(sum(_size(archive, member) for member in archive.infolist()), path)
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def read_matrices(path: Path) -> dict[str, npt.NDArray[Any] | SparseMatrix]:
    """Return the arrays of an archive by name, large dense matrices as sparse ones.

    Their zeros take no memory.
    """
    arrays: dict[str, npt.NDArray[Any] | SparseMatrix] = {}
    with zipfile.ZipFile(path) as archive:
        for member in archive.infolist():
            size = _size(archive, member)
            with archive.open(member) as file:
                shape, by_columns, kind = _header(file, member.filename)
                name = member.filename.removesuffix(".npy")
                if math.prod(shape) > PIECE_NUMBERS and len(shape) == 2 and kind.kind in "fiub":
                    matrix = _by_rows(file, shape[::-1] if by_columns else shape, kind, path)
                    arrays[name] = matrix.T.tocsr() if by_columns else matrix
                    continue
                check_room(size, path)
                values = np.frombuffer(file.read(size), dtype=kind)
                arrays[name] = values.reshape(shape, order="F" if by_columns else "C")
    return arrays


def _by_rows(
    file: IO[bytes], shape: tuple[int, ...], kind: np.dtype[Any], path: Path
) -> SparseMatrix:
    parts, entries = [], 0
    width = shape[1] * kind.itemsize
    rows = max(PIECE_NUMBERS // shape[1], 1)
    for first in range(0, shape[0], rows):
        count = min(rows, shape[0] - first)
        check_room(16 * entries + 3 * width * count, path)
        values = np.frombuffer(file.read(width * count), dtype=kind)
        parts.append(sp.csr_array(values.reshape(count, shape[1])))
        entries += parts[-1].nnz
    check_room(16 * entries, path)
    return sp.csr_array(sp.vstack(parts, format="csr"))


def _size(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> int:
    """Return the bytes of an array, checked against the bytes after its header."""
    with archive.open(member) as file:
        shape, _, kind = _header(file, member.filename)
        n_bytes = math.prod(shape) * kind.itemsize
        if kind.hasobject:
            message = f"'{member.filename}' holds pickled objects, which may run code as they load"
            raise ValueError(message)
        if file.tell() + n_bytes != member.file_size:
            refuse_value(
                f"'{member.filename}' has shape {shape} of {kind}, which is {n_bytes} bytes, but "
                f"stores {member.file_size - file.tell()}"
            )
    return n_bytes


def _header(file: IO[bytes], name: str) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return shape, whether the order is by columns, and type of an array."""
    version = npy.read_magic(file)
    if version not in _HEADERS:
        refuse_value(f"'{name}' is not an array in the format of numpy.savez")
    shape, by_columns, kind = _HEADERS[version](file)
    return shape, by_columns, kind
