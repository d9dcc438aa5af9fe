"""Space for files that grow: taken before HDF5 writes, which cannot end a file on a full disk.

Whatever HDF5 has begun to write it tries again when the file is closed, and once more when the
program ends, each time with a report of its own; and the file is damaged.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

SLACK = 2**20
"""Bytes for what HDF5 writes of itself: groups, attributes, and an index of the chunks."""


@contextmanager
def growing(path: Path, *, new: bool) -> Iterator[h5py.File]:
    """Yield an HDF5 file to write to, once there is room to begin.

    Parameters
    ----------
    new
        Whether what the file holds is lost.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    with path.open("wb" if new else "ab") as probe:
        size = os.fstat(probe.fileno()).st_size
        _allocate(probe.fileno(), size, SLACK)
        probe.truncate(size)
    used = None
    try:
        with h5py.File(path, "w" if new or not size else "r+", track_order=True) as file:
            reserve(file, 0)
            try:
                yield file
            finally:
                file.flush()
                used = file.id.get_filesize()
    finally:
        if used is not None:
            os.truncate(path, used)


def reserve(file: h5py.File, n_bytes: int) -> None:
    """Take the space for so many more bytes, and for what HDF5 writes with them.

    Raises
    ------
    OSError
        If there is none; the file is as it was.
    """
    _allocate(file.id.get_vfd_handle(), file.id.get_filesize(), n_bytes + SLACK)


def _allocate(handle: int, offset: int, n_bytes: int) -> None:
    # Elsewhere a full disk is met by HDF5 itself.
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(handle, offset, n_bytes)
