"""Lines of a deck, and the file and line each comes from."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath

from faying._typing import Indices
from faying.exceptions import FormatError

_PLACED = re.compile(r"^\S.*:\d+: ")
_UTF8_MARK, _UTF16_MARKS = b"\xef\xbb\xbf", (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Consecutive lines and where each comes from.

    Attributes
    ----------
    text
        Without line ends.
    number, file : (n_line,)
        Line number, counted from 1, in the file ``files[file]``.
    """

    text: list[bytes]
    number: Indices
    file: Indices
    files: tuple[str, ...]

    def __getitem__(self, part: slice) -> "Lines":
        return Lines(
            text=self.text[part], number=self.number[part], file=self.file[part], files=self.files
        )

    def where(self, line: int) -> str:
        """Return file:line."""
        return f"{self.files[self.file[line]]}:{self.number[line]}"


@contextmanager
def naming(path: str | PathLike[str]) -> Iterator[None]:
    """Put the deck's name before messages that name no place, of decks as a whole."""
    try:
        yield
    except FormatError as error:
        text = str(error)
        if _PLACED.match(text) or fspath(path) in text:
            raise
        message = f"{fspath(path)}: {text}"
        raise FormatError(message) from error


def deck_text(data: bytes, path: str | PathLike[str]) -> bytes:
    """Return the text of a deck without the byte order mark that some editors put before it.

    Raises
    ------
    FormatError
        If it is UTF-16 text, in which every other byte is zero.
    """
    if data.startswith(_UTF16_MARKS):
        message = f"{fspath(path)} is UTF-16 text; save it as UTF-8 or ASCII"
        raise FormatError(message)
    return data.removeprefix(_UTF8_MARK)
