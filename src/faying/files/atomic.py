"""Writing by one process at a time: a file is complete or absent, never half written.

Who writes holds the temporary file by a lock, of which the system lets go however the process ends:
what nobody holds was left over by one that was killed.
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


LEFT_OVER = re.compile(r"\.[^/]+(\.\w+)\.[a-z0-9_]{8}\1")
"""Names of temporary files: those of the files whose places they take, and eight characters."""


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Say in words that something cannot be written."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        message = f"cannot write {path}: {reason}; check the folder and free space"
        raise FormatError(message) from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path in the same folder that takes the place of ``path`` at the end.

    Raises
    ------
    FormatError
        If it cannot be written, inside too.
    """
    temporary, handle = None, None
    try:
        with writing(path):
            temporary, handle = _temporary(path)
            yield temporary
            moved(temporary, path)
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        if handle is not None:
            os.close(handle)


def _temporary(path: Path) -> tuple[Path, int | None]:
    """Make a temporary file and hold it, where the system has locks."""
    while True:
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix
        )
        try:
            hold(handle)
        except BlockingIOError:  # taken for left over before it was held
            os.close(handle)
            continue
        except OSError:
            os.close(handle)
            return Path(name), None
        if os.fstat(handle).st_nlink:
            return Path(name), handle
        os.close(handle)


def remove_left_over(folder: Path) -> None:
    """Remove temporary files of a folder, where there is one, that no process holds any more."""
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
        except OSError:  # somebody writes it, or the system cannot tell
            pass
        finally:
            os.close(handle)


def moved(temporary: Path, path: Path) -> Path:
    """Put a complete file into its place, readable by all as temporary files are not."""
    temporary.chmod(0o644)
    return temporary.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically.

    Raises
    ------
    FormatError
        If it cannot be written.
    """
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
