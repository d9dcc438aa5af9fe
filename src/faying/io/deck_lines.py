"""Lines of a deck as positions in its text, each with its file and line number."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import overload

import numpy as np
import numpy.typing as npt

from faying._typing import Indices
from faying.exceptions import FormatError, ModelError, refuse
from faying.files.contents import check_room, file_bytes

ABAQUS = (".inp",)
NASTRAN = (".bdf", ".nas", ".fem")
"""Suffixes of decks."""

_RETURN, _FEED, _BLANK = (ord(c) for c in "\r\n ")
_CHUNK = 2**24
"""Characters processed at a time."""

_LINES = 2**13
"""Lines whose characters are gathered at a time; they fit the processor's cache."""


@dataclass(frozen=True, eq=False)
class LineTexts(Sequence[bytes]):
    """Lines without line ends, in the order of a text.

    Attributes
    ----------
    data
        The text; it may contain more than these lines.
    begin, end : (n_line,)
        Positions of each line's first character and of the character after its last.
    """

    data: bytes
    begin: Indices
    end: Indices

    def __len__(self) -> int:
        return len(self.begin)

    @overload
    def __getitem__(self, which: int) -> bytes: ...

    @overload
    def __getitem__(self, which: slice) -> "LineTexts": ...

    def __getitem__(self, which: int | slice) -> "bytes | LineTexts":
        if isinstance(which, slice):
            return LineTexts(self.data, self.begin[which], self.end[which])
        return self.data[self.begin[which] : self.end[which]]

    def __iter__(self) -> Iterator[bytes]:
        return (self[line] for line in range(len(self)))

    def split(self) -> list[bytes]:
        """Return consecutive lines as a list, faster than one at a time."""
        return self.data[self.begin[0] : self.end[-1]].splitlines() if len(self) else []

    def upper(self) -> "LineTexts":
        """Return the lines in upper case."""
        return LineTexts(self.data.upper(), self.begin, self.end)

    def holding(self, word: bytes) -> Indices:
        """Return the indices of the lines that contain a word; fast where few lines do."""
        return np.unique(self._found(word)[0])

    def cut_at(self, letter: bytes) -> "LineTexts":
        """Return the lines up to the first occurrence of a letter in each."""
        lines, places = self._found(letter)
        end = self.end.copy()
        end[lines[::-1]] = places[::-1]  # the first of several counts
        return LineTexts(self.data, self.begin, end)

    def _found(self, word: bytes) -> tuple[Indices, Indices]:
        """Return lines (n,) and positions (n,) of a word."""
        places = _places_of(word, self.data)
        places = places[places >= self.begin[0]] if len(self) else places[:0]
        lines = np.searchsorted(self.begin, places, side="right") - 1
        inside = places + len(word) <= self.end[lines]
        return lines[inside], places[inside]

    def letters(self, width: int) -> npt.NDArray[np.uint8]:
        """Return the first characters (n_line, width) of the lines, padded with blanks."""
        last = max(len(self.data) - width, 0)
        windows: npt.NDArray[np.void] = np.ndarray(
            (last + 1,), dtype=f"V{width}", buffer=self.data.ljust(width), strides=(1,)
        )
        characters = np.empty((len(self), width), dtype=np.uint8)
        length = np.minimum(self.end - self.begin, width).astype(np.uint8)
        column = np.arange(width, dtype=np.uint8)
        for start in range(0, len(self), _LINES):
            part = slice(start, start + _LINES)
            letters = windows[np.minimum(self.begin[part], last)].view(np.uint8)
            letters = letters.reshape(-1, width)
            letters[column >= length[part, None]] = _BLANK
            characters[part] = letters
        for line in np.flatnonzero(self.begin > last).tolist():
            characters[line] = np.frombuffer(self[line][:width].ljust(width), dtype=np.uint8)
        return characters


def split_lines(data: bytes) -> LineTexts:
    """Split text into lines that end with a line feed, a carriage return, or both."""
    if b"\r" in data and data.count(b"\r") != data.count(b"\r\n"):
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    parts = list(line_places(data))
    begin = np.concatenate([np.empty(0, dtype=np.int64), *(begin for begin, _ in parts)])
    end = np.concatenate([np.empty(0, dtype=np.int64), *(end for _, end in parts)])
    return LineTexts(data, begin, end)


def line_places(data: bytes) -> Iterator[tuple[Indices, Indices]]:
    """Yield begins and ends of lines without line ends, some hundred thousand at a time."""
    letters = np.frombuffer(data, dtype=np.uint8)
    start = 0
    while start < len(data):
        stop = data.find(b"\n", start + _CHUNK)
        stop = len(data) if stop < 0 else stop + 1
        feeds = start + np.flatnonzero(letters[start:stop] == _FEED)
        begin = np.concatenate([[start], feeds + 1])
        end = np.append(feeds, stop)
        whole = begin < stop
        begin, end = begin[whole], end[whole]
        yield begin, end - ((letters[end - 1] == _RETURN) & (end > begin))
        start = stop


def joined(parts: Sequence[Sequence[bytes]]) -> LineTexts:
    """Return the lines of all parts, concatenated."""
    if len(parts) == 1 and isinstance(parts[0], LineTexts):
        return parts[0]
    texts: list[bytes] = []
    begins, ends = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    size = 0
    for part in parts:
        if not len(part):
            continue
        if isinstance(part, LineTexts):
            first, last = int(part.begin[0]), int(part.end[-1])
            texts += [part.data[first:last], b"\n"]
            begin, end = part.begin - first, part.end - first
        else:
            texts += [line + b"\n" for line in part]
            length = np.array([len(line) + 1 for line in part], dtype=np.int64)
            end = np.cumsum(length) - 1
            begin = end + 1 - length
        begins.append(size + begin)
        ends.append(size + end)
        size += int(end[-1]) + 1
    return LineTexts(b"".join(texts), np.concatenate(begins), np.concatenate(ends))


def edited(
    text: LineTexts, edits: Iterable[tuple[int, int, Sequence[bytes]]]
) -> tuple[LineTexts, Indices]:
    """Return lines after replacements, and the index of the original of each.

    An edit is the first line, the line after the last, and the new lines. Edits ascend.
    """
    parts: list[Sequence[bytes]] = []
    origin: list[Indices] = []
    done = 0
    for start, end, lines in edits:
        parts += [text[done:start], lines]
        origin += [np.arange(done, start), np.minimum(start + np.arange(len(lines)), end - 1)]
        done = end
    return joined([*parts, text[done:]]), np.concatenate([*origin, np.arange(done, len(text))])


def _places_of(word: bytes, data: bytes) -> Indices:
    """Return the positions (n,) of a word; single letters may occur often."""
    if len(word) == 1:
        if word not in data:
            return np.empty(0, dtype=np.int64)
        letters = np.frombuffer(data, dtype=np.uint8)
        starts = range(0, len(data), _CHUNK)
        return np.concatenate(
            [start + np.flatnonzero(letters[start : start + _CHUNK] == word[0]) for start in starts]
        )
    places = []
    position = data.find(word)
    while position >= 0:
        places.append(position)
        position = data.find(word, position + 1)
    return np.array(places, dtype=np.int64)


_PLACED = re.compile(r"^\S.*:\d+: ")
LONGEST_WORD = 80
"""Most characters of a name or number; more are a mistake, and all fields of a table take as much
memory as the longest one."""

MOST_FILES = 1000
"""Most files of a deck, each counted as often as it is included: twenty files that each include the
next one twice make a million."""

DEEPEST = 20
"""Depth of nested includes from which they are taken as circular."""

_UTF8_MARK, _UTF16_MARKS = b"\xef\xbb\xbf", (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Consecutive lines with file and line number.

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
    """Put the deck's name before messages without a place."""
    try:
        yield
    except (FormatError, ModelError) as error:
        text = str(error)
        if _PLACED.match(text) or fspath(path) in text:
            raise
        message = f"{fspath(path)}: {text}"
        raise type(error)(message) from error


@dataclass(frozen=True, kw_only=True)
class Dialect:
    """How decks of a program include files.

    Attributes
    ----------
    kind, include
        Names of a deck and of the statement that includes a file, for messages.
    statements
        Function of lines and of a function that returns file:line of a line. It yields the first
        line of each statement, the line after it, and the name of the file.
    deck_first
        Whether files are searched beside the deck first, then beside the including file.
    """

    kind: str
    include: str
    statements: Callable[[LineTexts, Callable[[int], str]], Iterator[tuple[int, int, str]]]
    deck_first: bool = False


def read_lines(path: Path, dialect: Dialect) -> Lines:
    """Read the lines of a deck and of the files that it includes, in order."""
    names: list[str] = []
    parts: list[tuple[LineTexts, Indices, int]] = []
    size = 0

    def expand(path: Path, parents: tuple[Path, ...], included_from: str) -> None:
        nonlocal size
        data = _file_text(path, dialect, parents, included_from, size)
        size += len(data)
        names.append(path.name if names else str(path))
        if len(names) > MOST_FILES:
            refuse(f"{included_from}: {dialect.include}: more than {MOST_FILES} files; merge them")
        index, text = len(names) - 1, split_lines(data)
        number = np.arange(1, len(text) + 1, dtype=np.int64)
        start = 0
        for begin, end, name in dialect.statements(text, lambda i: f"{names[index]}:{i + 1}"):
            parts.append((text[start:begin], number[start:begin], index))
            expand(
                _included(path.parent, home, name, dialect),
                (*parents, path.resolve()),
                f"{names[index]}:{begin + 1}",
            )
            start = end
        parts.append((text[start:], number[start:], index))

    home = path.parent
    expand(path, (), "")
    return Lines(
        text=joined([text for text, _, _ in parts]),
        number=np.concatenate([number for _, number, _ in parts]),
        file=np.repeat([f for _, _, f in parts], [len(t) for t, _, _ in parts]).astype(np.int64),
        files=tuple(names),
    )


def lines_of_file(path: str | PathLike[str]) -> Lines:
    """Return the lines of a file of cards in upper case."""
    text = split_lines(file_bytes(Path(path)).upper())
    return Lines(
        text=text,
        number=np.arange(1, len(text) + 1, dtype=np.int64),
        file=np.zeros(len(text), dtype=np.int64),
        files=(fspath(path),),
    )


def _included(folder: Path, home: Path, name: str, dialect: Dialect) -> Path:
    places = [home / name, folder / name] if dialect.deck_first else [folder / name, home / name]
    try:
        return next((place for place in places if place.is_file()), places[0])
    except (OSError, ValueError):  # not a file name: refused when it is read
        return places[0]


def _file_text(
    path: Path, dialect: Dialect, parents: Sequence[Path], included_from: str, read: int
) -> bytes:
    """Return the text of a file, included from a place unless that is empty.

    ``parents`` are the resolved paths of the files that include it; bytes read before count.
    """
    try:
        data = deck_text(file_bytes(path), path)
        check_room(read + len(data), path)
    except ValueError as error:  # a path with a NUL character
        message = f"{included_from}: {dialect.include} names an impossible path; correct it"
        raise FormatError(message) from error
    except OSError as error:
        origin = f"{included_from}: {dialect.include}: " if included_from else ""
        reason = f"cannot be read ({error.strerror})"
        if isinstance(error, FileNotFoundError):
            reason = "does not exist"
        message = f"{origin}{dialect.kind} '{path}' {reason}; check the path"
        raise FormatError(message) from error
    if path.resolve() in parents or len(parents) >= DEEPEST:
        refuse(f"{included_from}: {dialect.include} of '{path}' is circular; remove an include")
    return data


def deck_text(data: bytes, path: str | PathLike[str]) -> bytes:
    """Return the text of a deck without the byte order mark that some editors put before it."""
    if data.startswith(_UTF16_MARKS):
        refuse(f"{fspath(path)} is UTF-16 text; save it as UTF-8 or ASCII")
    return data.removeprefix(_UTF8_MARK)
