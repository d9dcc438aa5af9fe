"""HDF5 files that others wrote, opened for reading."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from faying.exceptions import FayingError, FormatError
from faying.files.contents import reason_of
from faying.files.hdf5_watch import look_through


@contextmanager
def open_hdf5(path: Path, expected: str, remedy: str) -> Iterator[h5py.File]:
    """Open a file whose data are all its own and fit in memory.

    Another process has looked through it before: see :mod:`faying.files.hdf5_walk`.

    Parameters
    ----------
    expected, remedy
        End of the messages for what is no such file, and for one that is damaged.

    Raises
    ------
    FormatError
        If it cannot be read; also if what is done with it inside meets damage.
    """
    check_hdf5(path, expected, remedy)
    try:
        with h5py.File(path, "r") as file:
            yield file
    except FayingError:
        raise
    except Exception as error:  # HDF5 and h5py raise whatever a damaged file meets
        raise damaged(path, error, remedy) from None


def check_hdf5(path: Path, expected: str, remedy: str, *, whole: bool = True) -> None:
    """Refuse a file that is damaged or leads elsewhere, before this process opens it.

    Parameters
    ----------
    whole
        Whether all its data are to be read: then they must be there, and fit in memory.

    Raises
    ------
    FormatError
    """
    try:
        look_through(path, whole=whole)
    except FileNotFoundError:
        message = f"{path} is not an HDF5 file, or was cut off; expected {expected}"
        raise FormatError(message) from None
    except OSError as error:
        raise damaged(path, error, remedy) from None


def damaged(path: Path, error: Exception, remedy: str) -> FormatError:
    """Return the message about a file in which an error was met."""
    reason = f"{path} is damaged, or another program wrote it ({reason_of(error)}); {remedy}"
    return FormatError(reason)
