"""Atomic writing: a file is complete or absent, never half written."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path in the same folder that takes the place of ``path`` at the end."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        moved(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def moved(temporary: Path, path: Path) -> Path:
    """Put a complete file into its place, readable by all as temporary files are not."""
    temporary.chmod(0o644)
    return temporary.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
