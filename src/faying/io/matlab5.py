"""Numeric variables of MATLAB 5 files (``save -v6`` and ``-v7``), read with every size checked.

SciPy's reader is compiled and trusts the file: a damaged one can end the process. The format is
that of MathWorks, *MAT-File Format*, "Level 5 MAT-File Format".
"""

import math
import struct
import zlib
from pathlib import Path
from typing import Any, final

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

_PIECE = 2**22
"""Bytes that are decompressed at once; a few megabytes of zeros may stand for gigabytes."""


@final
class _Stream:
    """Bytes one after the other, of the file or of a compressed variable in it."""

    def __init__(self, content: memoryview, *, packed: bool = False) -> None:
        self._left, self._waiting = content, b""
        self._inflate, self.count = zlib.decompressobj() if packed else None, 0

    def read(self, count: int) -> bytearray:
        """Return so many bytes.

        Raises
        ------
        ValueError
            If there are fewer, or what is compressed is damaged.
        """
        content = bytearray() if self._inflate else bytearray(self._left[:count])
        if self._inflate is None:
            self._left = self._left[count:]
        else:
            while len(content) < count and not self._inflate.eof and (self._left or self._waiting):
                content += self._piece(self._inflate, count - len(content))
        if len(content) != count:
            message = "it ends in the middle of a variable"
            raise ValueError(message)
        return content

    def _piece(self, inflate: Any, limit: int) -> bytes:
        if not self._waiting:
            self._waiting, self._left = bytes(self._left[:_PIECE]), self._left[_PIECE:]
        try:
            content: bytes = inflate.decompress(self._waiting, min(limit, _PIECE))
        except zlib.error as error:
            raise ValueError(str(error)) from None
        self._waiting, self.count = inflate.unconsumed_tail, self.count + len(content)
        return content

    def end(self, size: int) -> None:
        """Go to the end of what is compressed, so many bytes and a checksum.

        Raises
        ------
        ValueError
            If it ends elsewhere.
        """
        while self._inflate is not None and not self._inflate.eof and self.count <= size:
            if not self._piece(self._inflate, _PIECE) and not (self._left or self._waiting):
                break
        if self._inflate is not None and (self.count != size or not self._inflate.eof):
            message = f"a compressed variable announces {size} bytes and holds others"
            raise ValueError(message)


def read_matlab5(path: Path) -> dict[str, npt.NDArray[Any] | SparseMatrix]:
    """Return arrays and sparse matrices by name; variables of other classes are left out.

    Large full matrices are returned as sparse ones, so that zeros take no memory.

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
    variables: dict[str, npt.NDArray[Any] | SparseMatrix] = {}
    position = HEADER
    while position + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}2I", content, position)
        if kind >> 16:  # short ones, which hold no variable, share eight bytes with their tag
            kind, size = 0, 0
        position += 8 + size
        if position > len(content):
            message = f"a piece of {size} bytes at byte {position - size - 8} goes beyond its end"
            raise ValueError(message)
        stream = _Stream(
            memoryview(content)[position - size : position], packed=kind == _COMPRESSED
        )
        if kind == _COMPRESSED:
            kind, size = struct.unpack(f"{order}2I", stream.read(8))
        if kind == _MATRIX:
            named = _variable(stream, order, path)
            if named:
                stream.end(8 + size)
            variables |= named
    return variables


def _tag(stream: _Stream, order: str) -> tuple[int, int, bytearray | None]:
    """Return type and bytes of the next piece of a variable, and what a short one holds."""
    words = stream.read(8)
    kind, size = struct.unpack(f"{order}2I", words)
    if not kind >> 16:
        return kind, size, None
    if kind >> 16 > 4:
        message = f"a short piece says {kind >> 16} bytes"
        raise ValueError(message)
    return kind & 0xFFFF, kind >> 16, words[4 : 4 + (kind >> 16)]


def _element(stream: _Stream, order: str, path: Path) -> tuple[int, bytearray]:
    """Return type and content of the next piece of a variable, padded to eight bytes."""
    kind, size, short = _tag(stream, order)
    if short is not None:
        return kind, short
    check_room(2 * size, path)
    content = stream.read(size)
    stream.read(-size % 8)
    return kind, content


def _variable(
    stream: _Stream, order: str, path: Path
) -> dict[str, npt.NDArray[Any] | SparseMatrix]:
    """Return name and value of a variable that is an array of numbers and has a name."""
    flags = _element(stream, order, path)[1]
    if len(flags) != 8:
        message = "a variable does not begin with its class"
        raise ValueError(message)
    kind = struct.unpack_from(f"{order}I", flags)[0]
    if kind & 0xFF != _SPARSE and kind & 0xFF not in _NUMERIC:
        return {}
    shape = tuple(_numbers(*_element(stream, order, path), order).tolist())
    check_rows(shape)
    if len(shape) < 2 or min(shape) < 0:
        message = f"a variable has shape {shape}"
        raise ValueError(message)
    name = _element(stream, order, path)[1].decode("latin-1")
    if not name:  # data of the program itself
        return {}
    read = _sparse if kind & 0xFF == _SPARSE else _dense
    value = read(stream, shape, order, path)
    # Of complex variables it is only said that they are complex, which nothing here can use.
    return {name: value.astype(np.complex128) if kind & _COMPLEX else value}


def _numbers(kind: int, content: bytearray, order: str) -> npt.NDArray[Any]:
    name = _TYPES.get(kind)
    if name is None or len(content) % np.dtype(name).itemsize:
        message = f"found {len(content)} bytes of type {kind}, no whole numbers"
        raise ValueError(message)
    values = np.frombuffer(content, dtype=f"{order}{name}")
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def _dense(
    stream: _Stream, shape: tuple[int, ...], order: str, path: Path
) -> npt.NDArray[Any] | SparseMatrix:
    kind, size, short = _tag(stream, order)
    width = np.dtype(_TYPES.get(kind, "u1")).itemsize
    if kind not in _TYPES or size != width * math.prod(shape):
        message = f"an array of shape {shape} has {size} bytes of type {kind}"
        raise ValueError(message)
    if short is not None or size <= _PIECE or len(shape) > 2:
        check_room(2 * size, path)
        content = stream.read(size) if short is None else short
        return _numbers(kind, content, order).reshape(shape, order="F")
    # Column by column, some at once.
    columns, parts, entries = max(_PIECE // (width * shape[0]), 1), [], 0
    for first in range(0, shape[1], columns):
        count = min(columns, shape[1] - first)
        check_room(16 * entries + 3 * width * shape[0] * count, path)
        values = _numbers(kind, stream.read(width * shape[0] * count), order)
        parts.append(sp.csc_array(values.reshape((shape[0], count), order="F")))
        entries += parts[-1].nnz
    check_room(16 * entries, path)
    return sp.hstack(parts, format="csc")


def _sparse(stream: _Stream, shape: tuple[int, ...], order: str, path: Path) -> SparseMatrix:
    """Read a matrix by columns: rows of the entries, first entry of each column, entries."""
    index, first, entries = (_numbers(*_element(stream, order, path), order) for _ in range(3))
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
