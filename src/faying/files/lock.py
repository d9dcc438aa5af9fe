"""Folders and files that belong to one process at a time."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from faying.exceptions import StudyError


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder; the system lets go of it however the process ends.

    File systems without locks, as some network drives, hold nothing.
    """
    if os.name == "nt":  # folders have no handles there
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            hold(handle)
        except BlockingIOError:
            message = (
                f"another run is writing to {folder}; wait for its end, or choose another folder "
                "with --out"
            )
            raise StudyError(message) from None
        except OSError:
            pass
        yield
    finally:
        os.close(handle)


def hold(handle: int) -> None:
    """Hold what is open until it is closed.

    Raises
    ------
    BlockingIOError
        If another process, or another handle of this one, holds it.
    OSError
        If the system or the file system has no locks.
    """
    try:
        import fcntl
    except ImportError:
        raise OSError(errno.ENOTSUP, os.strerror(errno.ENOTSUP)) from None
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
