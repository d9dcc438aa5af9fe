"""Atomic writing: a file is complete or absent, never half written."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from faying.exceptions import FormatError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path in the same folder that takes the place of ``path`` at the end.

    Raises
    ------
    FormatError
        If it cannot be written, inside too.
    """
    temporary = None
    try:
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix
        )
        os.close(handle)
        temporary = Path(name)
        yield temporary
        moved(temporary, path)
    except OSError as error:
        reason = error.strerror or error
        message = f"cannot write {path}: {reason}; check the folder and free space"
        raise FormatError(message) from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


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
