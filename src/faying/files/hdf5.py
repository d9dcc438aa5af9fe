"""HDF5 files that others wrote, opened for reading.

Such a file may lead elsewhere, to other files by links, external or virtual storage, or round in
circles; and a few bytes may announce terabytes. None of this is followed or taken into memory.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from faying.exceptions import FayingError, FormatError
from faying.files.contents import check_room

MOST_PACKED = 1100
"""Bytes that a compressed byte can stand for: deflate reaches 1032."""

AT_ONCE = 2**28
"""Bytes of texts looked at together; each is at most as long as the file."""


@contextmanager
def open_hdf5(path: Path, expected: str, remedy: str) -> Iterator[h5py.File]:
    """Open a file whose data are all its own and fit in memory.

    Parameters
    ----------
    expected, remedy
        End of the messages for what is no such file, and for one that is damaged.

    Raises
    ------
    FormatError
        If it cannot be read; also if what is done with it inside meets damage.
    """
    try:
        file = h5py.File(path, "r")
    except Exception:  # HDF5 and h5py raise whatever a damaged file meets
        message = f"{path} is not an HDF5 file, or was cut off; expected {expected}"
        raise FormatError(message) from None
    try:
        with file:
            _check(file, path)
            yield file
    except FayingError:
        raise
    except Exception as error:
        reason = " ".join((str(error) or type(error).__name__).split())[:200]
        message = f"{path} is damaged, or another program wrote it ({reason}); {remedy}"
        raise FormatError(message) from None


def _check(file: h5py.File, path: Path) -> None:
    """Walk through the groups, each of which has one name."""
    total, groups = 0, [file]
    while groups:
        group = groups.pop()
        for name in group:
            place = f"'{group.name.rstrip('/')}/{name}'"
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                message = f"{place} is a link to another place; nothing but its own data is read"
                raise ValueError(message)
            node = group[name]
            if h5py.h5o.get_info(node.id).rc > 1:
                message = f"{place} has a second name, so its groups may go round in circles"
                raise ValueError(message)
            if isinstance(node, h5py.Group):
                groups.append(node)
            else:
                total += _size(node, place, path)
    check_room(total, path)


def _size(node: h5py.Dataset | h5py.Datatype, place: str, path: Path) -> int:
    """Bytes of a dataset in memory."""
    if not isinstance(node, h5py.Dataset) or node.is_virtual or node.external:
        message = f"{place} is no dataset that holds its own data"
        raise ValueError(message)
    announced, stored = node.size * node.dtype.itemsize, node.id.get_storage_size()
    if announced > MOST_PACKED * stored:
        message = f"{place} says shape {node.shape}, {announced:.3g} bytes, and holds {stored}"
        raise ValueError(message)
    text = h5py.check_string_dtype(node.dtype)
    if (text is None and node.dtype.kind not in "fiub") or (text is not None and node.ndim > 1):
        message = f"{place} holds neither numbers nor a list of texts"
        raise ValueError(message)
    if text is None or text.length is not None or node.shape == ():
        return int(announced)
    return int(announced) + _text_size(node, path)


def _text_size(node: h5py.Dataset, path: Path) -> int:
    """Bytes of texts, many of which may be the same place in the file."""
    total, step = 0, max(AT_ONCE // path.stat().st_size, 1)
    for first in range(0, len(node), step):
        total += sum(map(len, node[first : first + step]))
        if first:
            check_room(total, path)
    return total
