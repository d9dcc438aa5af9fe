"""Arrays of NumPy archives (``.npz``), whoever wrote them.

The size of every array is known from its header before there is memory for it, and pickled objects,
which run code as they are read, are refused.
"""

import math
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt
from numpy.lib import format as npy

from faying.files.contents import check_room

_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of an archive by name.

    Raises
    ------
    OSError
        If the file cannot be read, or its arrays are larger than the memory that is free.
    Exception
        Whatever a damaged archive makes ``zipfile``, ``zlib`` and NumPy raise.
    """
    with zipfile.ZipFile(path) as archive:
        check_room(sum(_size(archive, member) for member in archive.infolist()), path)
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _size(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> int:
    """Bytes of an array, which are those that follow its header."""
    with archive.open(member) as file:
        shape, kind = _header(file, member.filename)
        n_bytes = math.prod(shape) * kind.itemsize
        if kind.hasobject:
            message = f"'{member.filename}' holds pickled objects, which may run code as they load"
            raise ValueError(message)
        if file.tell() + n_bytes != member.file_size:
            message = (
                f"'{member.filename}' says shape {shape} of {kind}, which is {n_bytes} bytes, and "
                f"holds {member.file_size - file.tell()}"
            )
            raise ValueError(message)
    return n_bytes


def _header(file: IO[bytes], name: str) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = npy.read_magic(file)
    if version not in _HEADERS:
        message = f"'{name}' is no array as numpy.savez writes it"
        raise ValueError(message)
    shape, _, kind = _HEADERS[version](file)
    return shape, kind
