"""Numeric variables of MATLAB 5 files (``save -v6`` and ``-v7``), read with every size checked.

SciPy's reader is compiled and trusts the file: a damaged one can end the process. The format is
that of MathWorks, *MAT-File Format*, "Level 5 MAT-File Format".
"""

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from faying._typing import SparseMatrix
from faying.files.contents import check_room, check_rows, file_bytes

HEADER = 128

_TYPES = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
"""Number of a type in the file to NumPy's name."""

_MATRIX, _COMPRESSED = 14, 15
_SPARSE, _NUMERIC = 5, range(6, 16)
"""Classes of variables; the others are cells, structures, objects and text."""

_COMPLEX = 0x800


@dataclass(frozen=True)
class _Element:
    """A typed piece of the file, and where the next begins."""

    kind: int
    content: bytes
    end: int


def read_matlab5(path: Path) -> dict[str, npt.NDArray[Any] | SparseMatrix]:
    """Return arrays and sparse matrices by name; variables of other classes are left out.

    Raises
    ------
    OSError
        If the file cannot be read, or a variable is larger than the memory that is free.
    ValueError
        If a size, shape or index contradicts the others, or what is compressed is damaged.
    """
    content = file_bytes(path)
    order = {b"IM": "<", b"MI": ">"}.get(content[126:HEADER])
    if order is None:
        message = "its header does not say the order of bytes"
        raise ValueError(message)
    return dict(_variables(content, order, path))


def _variables(
    content: bytes, order: str, path: Path
) -> Iterator[tuple[str, npt.NDArray[Any] | SparseMatrix]]:
    place = HEADER
    while place + 8 <= len(content):
        element = _element(content, place, order, padded=False)
        place = element.end
        if element.kind == _COMPRESSED:
            element = _element(_decompressed(element.content, order, path), 0, order, padded=False)
        if element.kind == _MATRIX:
            yield from _variable(element.content, order)


def _element(content: bytes, place: int, order: str, *, padded: bool = True) -> _Element:
    """Read the piece at a place; pieces of a variable are padded to eight bytes."""
    if place + 8 > len(content):
        message = f"it ends at byte {len(content)}, in the middle of a variable"
        raise ValueError(message)
    kind, size = struct.unpack_from(f"{order}2I", content, place)
    start, end = place + 8, place + 8 + size
    if kind >> 16:  # short ones share eight bytes with their tag
        kind, size = kind & 0xFFFF, kind >> 16
        start, end = place + 4, place + 8
    if start + size > min(end, len(content)):
        message = f"a piece of {size} bytes at byte {place} goes beyond its end"
        raise ValueError(message)
    return _Element(kind, content[start : start + size], end + (-end % 8 if padded else 0))


def _decompressed(packed: bytes, order: str, path: Path) -> bytes:
    """Decompress one variable, whose first eight bytes say how long it is."""
    stream = zlib.decompressobj()
    try:
        tag = stream.decompress(packed, 8)
        if len(tag) < 8:
            message = "a compressed variable is cut off"
            raise ValueError(message)
        size = struct.unpack(f"{order}2I", tag)[1]
        check_room(2 * size, path)
        # One byte more than announced, to notice a variable that does not end there.
        found = stream.decompress(stream.unconsumed_tail, size + 1)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if len(found) != size or not stream.eof:
        message = f"a compressed variable announces {size} bytes and holds {len(found)}"
        raise ValueError(message)
    return tag + found


def _variable(content: bytes, order: str) -> Iterator[tuple[str, npt.NDArray[Any] | SparseMatrix]]:
    """Yield name and value of a variable that is an array of numbers and has a name."""
    flags = _element(content, 0, order)
    if len(flags.content) != 8:
        message = "a variable does not begin with its class"
        raise ValueError(message)
    kind = struct.unpack_from(f"{order}I", flags.content)[0]
    if kind & 0xFF != _SPARSE and kind & 0xFF not in _NUMERIC:
        return
    sizes = _element(content, flags.end, order)
    shape = tuple(_numbers(sizes, order).tolist())
    check_rows(shape)
    if len(shape) < 2 or min(shape) < 0:
        message = f"a variable has shape {shape}"
        raise ValueError(message)
    name = _element(content, sizes.end, order)
    if not name.content:  # data of the program itself
        return
    text = name.content.decode("latin-1")
    read = _sparse if kind & 0xFF == _SPARSE else _dense
    value = read(content, name.end, shape, order)
    # Of complex variables it is only said that they are complex, which nothing here can use.
    yield text, value.astype(np.complex128) if kind & _COMPLEX else value


def _numbers(element: _Element, order: str) -> npt.NDArray[Any]:
    kind = _TYPES.get(element.kind)
    if kind is None or len(element.content) % np.dtype(kind).itemsize:
        message = f"found {len(element.content)} bytes of type {element.kind}, no whole numbers"
        raise ValueError(message)
    values = np.frombuffer(element.content, dtype=f"{order}{kind}")
    return values.astype(values.dtype.newbyteorder("="))


def _dense(content: bytes, place: int, shape: tuple[int, ...], order: str) -> npt.NDArray[Any]:
    values = _numbers(_element(content, place, order), order)
    if len(values) != math.prod(shape):
        message = f"an array of shape {shape} has {len(values)} numbers"
        raise ValueError(message)
    return values.reshape(shape, order="F")


def _sparse(content: bytes, place: int, shape: tuple[int, ...], order: str) -> SparseMatrix:
    """Read a matrix by columns: rows of the entries, first entry of each column, entries."""
    rows = _element(content, place, order)
    starts = _element(content, rows.end, order)
    entries = _numbers(_element(content, starts.end, order), order)
    index, first = _numbers(rows, order), _numbers(starts, order)
    if len(shape) != 2 or len(first) != shape[1] + 1 or not len(entries) <= len(index):
        message = (
            f"a sparse matrix of shape {shape} has {len(first)} column starts, {len(index)} row "
            f"indices and {len(entries)} entries"
        )
        raise ValueError(message)
    # MATLAB may keep room for more entries than there are.
    count = int(first[-1])
    if not 0 <= count <= len(entries):
        message = f"a sparse matrix announces {count} entries and has {len(entries)}"
        raise ValueError(message)
    return sp.csc_array((entries[:count], index[:count], first), shape=shape)
