"""What files of others hold, taken into memory only where it is a file and fits.

A deck may include a device or a pipe, which never end; a file may be larger than the memory. Both
are known before the first byte is read.
"""

import errno
import stat
from pathlib import Path

from faying.linalg.memory import free_memory, gigabytes

MOST_ROWS = 100_000_000
"""Rows of a matrix from which its size is taken for damage: its factors would take terabytes."""


def file_bytes(path: Path) -> bytes:
    """Return what a file holds.

    Raises
    ------
    OSError
        If it cannot be read, is no regular file, or is larger than the memory that is free.
    ValueError
        If the path has a NUL character.
    """
    check_room(file_size(path), path)
    return path.read_bytes()


def file_size(path: Path) -> int:
    """Return the bytes of a file.

    Raises
    ------
    OSError
        If it is no regular file; a pipe would be waited for.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "it is a folder, device or pipe and no file", str(path))
    return status.st_size


def file_text(path: Path, errors: str = "strict") -> str:
    """Return the text of a UTF-8 file, without a byte order mark.

    Raises
    ------
    OSError
        As :func:`file_bytes`.
    UnicodeDecodeError
        If it is no UTF-8, unless ``errors`` says otherwise.
    """
    return file_bytes(path).decode("utf-8-sig", errors)


def check_room(n_bytes: int, path: Path) -> None:
    """Refuse what is larger than the memory that is free.

    Raises
    ------
    OSError
        With both figures.
    """
    check_fits(n_bytes, free_memory(), path)


def check_fits(n_bytes: int, free: int | None, path: Path) -> None:
    """Refuse what is larger than so many bytes; None is not known."""
    if free is not None and n_bytes > free:
        reason = f"it holds {gigabytes(n_bytes)}, and {gigabytes(free)} of memory are free"
        raise OSError(errno.ENOMEM, reason, str(path))


def reason_of(error: BaseException) -> str:
    """Return in a line why a reader gave up."""
    if isinstance(error, MemoryError):
        return "a size in it asks for more memory than there is, so it is damaged"
    return " ".join((str(error) or type(error).__name__).split())[:200]


def check_rows(shape: tuple[int, ...]) -> None:
    """Refuse a matrix with more rows or columns than any structure has."""
    if max(shape, default=0) > MOST_ROWS:
        message = f"it says {max(shape)} rows or columns, and {MOST_ROWS} are the most"
        raise ValueError(message)
