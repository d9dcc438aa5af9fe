"""Text of a deck as it lies in its files: lines are split only of keywords whose data are read."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from faying._typing import Indices

_STEP = 2**16
"""Characters between those whose line numbers are kept."""

_COMMENTS = (b"**", b">*")
"""``**`` starts a comment, and so does ``>*``, before the first lines of some CalculiX decks."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TextFile:
    """A file with its text, whose lines end with a line feed, or return and line feed."""

    name: str
    text: bytes

    def line(self, offset: int) -> int:
        """Return the number of the line a character is in, from 1."""
        step = offset // _STEP
        return 1 + int(self._ended[step]) + self.text.count(b"\n", step * _STEP, offset)

    @cached_property
    def _ended(self) -> Indices:
        """Lines that end in front of every character of :data:`_STEP`."""
        letters = np.frombuffer(self.text, dtype=np.uint8)
        counts = [
            np.count_nonzero(letters[start : start + _STEP] == ord("\n"))
            for start in range(0, len(letters), _STEP)
        ]
        return np.cumsum([0, *counts])


@dataclass(frozen=True, eq=False, kw_only=True)
class Span:
    """Whole lines of a file, from one character up to another."""

    file: TextFile
    start: int
    end: int

    def starred(self) -> Iterator[tuple[int, int]]:
        """Yield where lines begin and end whose first visible character is an asterisk.

        Nothing but asterisks is looked for, of which data have none.
        """
        text = self.file.text
        star = text.find(b"*", self.start, self.end)
        while star >= 0:
            begin = max(text.rfind(b"\n", self.start, star) + 1, self.start)
            end = text.find(b"\n", star, self.end)
            end = self.end if end < 0 else end
            if not text[begin:star].strip():
                yield begin, end
            star = text.find(b"*", end, self.end)

    def content(self) -> Iterator[tuple[int, int]]:
        """Yield where lines begin and end that are neither blank nor comments."""
        text, begin = self.file.text, self.start
        while begin < self.end:
            end = text.find(b"\n", begin, self.end)
            end = self.end if end < 0 else end
            if is_content(text[begin:end]):
                yield begin, end
            begin = end + 1


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """The data lines of a keyword, as pieces of the deck."""

    spans: tuple[Span, ...]

    @cached_property
    def lines(self) -> list[bytes]:
        """Return the lines as written, without comments and blank lines."""
        return [line for part in self.spans for line in _content_lines(part)]

    def where(self, row: int) -> str:
        """Return file:line of a line."""
        for part in self.spans:
            content = [k for k, line in enumerate(_lines(part)) if is_content(line)]
            if row < len(content):
                return f"{part.file.name}:{part.file.line(part.start) + content[row]}"
            row -= len(content)
        message = f"the keyword has no data line {row}"
        raise IndexError(message)


def _lines(part: Span) -> list[bytes]:
    return part.file.text[part.start : part.end].splitlines()


def _content_lines(part: Span) -> list[bytes]:
    if part.file.text.find(b"*", part.start, part.end) < 0:
        return [line for line in _lines(part) if line and not line.isspace()]
    return [line for line in _lines(part) if is_content(line)]


def is_content(line: bytes) -> bool:
    """Whether a line is neither blank nor a comment."""
    mark = line.lstrip()[:2]
    return bool(mark) and mark not in _COMMENTS
