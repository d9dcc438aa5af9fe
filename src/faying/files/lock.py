"""A folder that belongs to one process at a time."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from faying.exceptions import StudyError


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder; the system lets go of it however the process ends.

    File systems without locks, as some network drives, hold nothing.

    Raises
    ------
    StudyError
        If another process holds it.
    """
    try:
        import fcntl
    except ImportError:  # Windows has no locks of folders
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
