"""Atomic writing by one process at a time: a file is complete or absent, never half written.

The writer locks its temporary file, and the system releases the lock however the process ends:
a temporary file without a lock was left over by a process that was killed.
"""

import errno
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from faying.exceptions import FormatError, StudyError


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Lock a folder; the system releases the lock however the process ends.

    On file systems without locks, such as some network drives, nothing is locked.
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
    """Lock an open file or folder until it is closed.

    Raises
    ------
    BlockingIOError
        If another process, or another handle of this process, has locked it.
    OSError
        If the system or the file system has no locks.
    """
    try:
        import fcntl
    except ImportError:
        raise OSError(errno.ENOTSUP, os.strerror(errno.ENOTSUP)) from None
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


LEFT_OVER = re.compile(r"\.[^/]+(\.\w+)\.[a-z0-9_]{8}\1")
"""Names of temporary files: the name of the final file, and eight characters."""


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn errors of writing a file into a :class:`FormatError`."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        message = f"cannot write {path}: {reason}; check the folder and free space"
        raise FormatError(message) from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield the path of a temporary file in the same folder, which replaces ``path`` at the end."""
    temporary, handle = None, None
    try:
        with writing(path):
            temporary, handle = _temporary(path)
            yield temporary
            move_into_place(temporary, path)
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        if handle is not None:
            os.close(handle)


def _temporary(path: Path) -> tuple[Path, int | None]:
    """Make a temporary file, and lock it where the system has locks."""
    while True:
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix
        )
        try:
            hold(handle)
        except BlockingIOError:  # another process took it for left over before it was locked
            os.close(handle)
            continue
        except OSError:
            os.close(handle)
            return Path(name), None
        if os.fstat(handle).st_nlink:
            return Path(name), handle
        os.close(handle)


def remove_left_over(folder: Path) -> None:
    """Remove the temporary files of a folder that no process has locked."""
    for file in folder.iterdir() if folder.is_dir() else ():
        if not LEFT_OVER.fullmatch(file.name) or file.is_symlink() or not file.is_file():
            continue
        try:
            handle = os.open(file, os.O_RDWR)
        except OSError:
            continue
        try:
            hold(handle)
            file.unlink(missing_ok=True)
        except OSError:  # another process writes it, or the system has no locks
            pass
        finally:
            os.close(handle)


def move_into_place(temporary: Path, path: Path) -> Path:
    """Move a complete temporary file to its final path, and make it readable by all."""
    temporary.chmod(0o644)
    return temporary.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
