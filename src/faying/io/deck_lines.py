"""Lines of a deck, and the file and line each comes from."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path

from faying._typing import Indices
from faying.exceptions import FormatError, ModelError, refuse
from faying.files.contents import check_room, file_bytes
from faying.io.line_texts import LineTexts

_PLACED = re.compile(r"^\S.*:\d+: ")
MOST_FILES = 1000
"""Files of one deck, each counted as often as it is included: of twenty files that each include the
next one twice there are a million."""

DEEPEST = 20
"""Files that include one another, from which on they are taken for a circle."""

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

    text: LineTexts
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
    except (FormatError, ModelError) as error:
        text = str(error)
        if _PLACED.match(text) or fspath(path) in text:
            raise
        message = f"{fspath(path)}: {text}"
        raise type(error)(message) from error


class DeckFiles:
    """The files of a deck as they are read, the deck itself first.

    Attributes
    ----------
    names
        As messages show them.
    """

    def __init__(self, kind: str, include: str) -> None:
        self.names: list[str] = []
        self._kind, self._include, self._size = kind, include, 0

    def read(self, path: Path, included_from: str, parents: Sequence[Path]) -> bytes:
        """Return the text of the next file, included from a place unless that is empty.

        ``parents`` are the files, resolved, that include one another up to it.
        """
        try:
            data = deck_text(file_bytes(path), path)
            self._size += len(data)
            check_room(self._size, path)
        except ValueError as error:  # a path with a NUL character
            message = f"{included_from}: {self._include} names an impossible path; correct it"
            raise FormatError(message) from error
        except OSError as error:
            origin = f"{included_from}: {self._include}: " if included_from else ""
            reason = f"cannot be read ({error.strerror})"
            if isinstance(error, FileNotFoundError):
                reason = "is not there"
            message = f"{origin}{self._kind} '{path}' {reason}; check the path"
            raise FormatError(message) from error
        if path.resolve() in parents or len(parents) >= DEEPEST:
            refuse(
                f"{included_from}: {self._include} of '{path}' goes in a circle; remove one of them"
            )
        self.names.append(path.name if self.names else str(path))
        if len(self.names) > MOST_FILES:
            refuse(f"{included_from}: {self._include}: more than {MOST_FILES} files; merge them")
        return data


def deck_text(data: bytes, path: str | PathLike[str]) -> bytes:
    """Return the text of a deck without the byte order mark that some editors put before it."""
    if data.startswith(_UTF16_MARKS):
        refuse(f"{fspath(path)} is UTF-16 text; save it as UTF-8 or ASCII")
    return data.removeprefix(_UTF8_MARK)
