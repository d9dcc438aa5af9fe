"""Contents of untrusted files, read only where they are regular files that fit in memory.

A deck may include a device or a pipe, which never end; a file may be larger than the memory. Both
are known before the first byte is read.
"""

import errno
import stat
from pathlib import Path

from faying.linalg.memory import free_memory, gigabytes

MOST_ROWS = 100_000_000
"""Rows above which the size of a matrix counts as damaged: its factors would take terabytes."""


def file_bytes(path: Path) -> bytes:
    """Return the contents of a file.

    Raises
    ------
    OSError
        If the file cannot be read, is not a regular one, or is larger than the free memory.
    ValueError
        If the path has a NUL character.
    """
    check_room(file_size(path), path)
    return path.read_bytes()


def file_size(path: Path) -> int:
    """Return the size of a file in bytes.

    Raises
    ------
    OSError
        If the file is not a regular one; reading a pipe would wait.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "it is a folder, device or pipe, not a file", str(path))
    return status.st_size


def file_text(path: Path) -> str:
    """Return the text of a UTF-8 file, without a byte order mark."""
    return file_bytes(path).decode("utf-8-sig")


def check_room(n_bytes: int, path: Path) -> None:
    """Refuse a file that is larger than the free memory."""
    check_fits(n_bytes, free_memory(), path)


def check_fits(n_bytes: int, free: int | None, path: Path) -> None:
    """Refuse a file larger than the free bytes of memory, where these are known."""
    if free is not None and n_bytes > free:
        reason = f"it holds {gigabytes(n_bytes)}, and {gigabytes(free)} of memory are free"
        raise OSError(errno.ENOMEM, reason, str(path))


def reason_of(error: BaseException) -> str:
    """Return the reason why reading failed, in one line."""
    if isinstance(error, MemoryError):
        return "a size in it asks for more memory than there is, so it is damaged"
    return " ".join((str(error) or type(error).__name__).split())[:200]


def check_rows(shape: tuple[int, ...]) -> None:
    """Refuse a matrix with more than :data:`MOST_ROWS` rows or columns."""
    if max(shape, default=0) > MOST_ROWS:
        message = f"it declares {max(shape)} rows or columns, more than the limit of {MOST_ROWS}"
        raise ValueError(message)
