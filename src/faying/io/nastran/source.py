"""The lines of a deck with its INCLUDE files spliced in, split into case control and bulk data."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying._typing import Indices
from faying.exceptions import FormatError
from faying.io.deck_lines import DeckFiles, Lines
from faying.io.line_texts import LineTexts, joined, split_lines

_INCLUDE = re.compile(rb"^[ \t]*INCLUDE[ \t]*['\"]?", re.IGNORECASE)
_BEGIN = re.compile(rb"^\s*BEGIN(?:[\s,]*BULK)?\b(.*)$")
_CEND = re.compile(rb"^\s*CEND\b")
_END = re.compile(rb"^\s*ENDDATA\b")
_CONTROL = re.compile(rb"^\s*(?:CEND\b|SOL\s+\S|SUBCASE\s+\d)")


@dataclass(frozen=True, eq=False, kw_only=True)
class Source:
    """Case control lines (with everything before them) and bulk data lines of a deck."""

    control: Lines
    bulk: Lines


def read_source(path: Path) -> Source:
    """Read a deck and its includes and find where the bulk data begin and end.

    A file without BEGIN BULK is bulk data from its first line, unless it holds a CEND or SOL.
    """
    files = DeckFiles("Nastran deck", "INCLUDE")
    parts = _expand(path, files, ())
    lines = Lines(
        text=joined([text for text, _, _ in parts]),
        number=np.concatenate([number for _, number, _ in parts]),
        file=np.repeat([f for _, _, f in parts], [len(t) for t, _, _ in parts]).astype(np.int64),
        files=tuple(files.names),
    )
    return _sections(lines, path)


def _sections(lines: Lines, path: Path) -> Source:
    begin = 0
    # DMAP in front of CEND has a BEGIN of its own.
    cend = next(_matching(lines.text, b"CEND", _CEND), -1)
    begins = [i for i in _matching(lines.text, b"BEGIN", _BEGIN) if i > cend]
    if begins:
        begin = begins[0] + 1
        for i in begins:
            match = _BEGIN.match(lines.text[i])
            argument = match.group(1).partition(b"$")[0].strip() if match else b""
            if argument or i != begins[0]:
                message = (
                    f"{lines.where(i)}: '{_shown(lines.text[i])}' starts another bulk data "
                    "section; superelement decks are not supported, merge them into one section"
                )
                raise FormatError(message)
    elif any(_CONTROL.match(text) for text in lines.text[:2000]):
        message = f"{path}: executive or case control but no BEGIN BULK line; add it"
        raise FormatError(message)
    ends = _matching(lines.text, b"ENDDATA", _END)
    end = next((i for i in ends if i >= begin), len(lines.text))
    return Source(control=lines[: max(begin - 1, 0)], bulk=lines[begin:end])


def _matching(text: LineTexts, keyword: bytes, pattern: re.Pattern[bytes]) -> Iterator[int]:
    """Yield the lines that match a pattern, of those that hold its keyword."""
    return (i for i in text.holding(keyword).tolist() if pattern.match(text[i]))


def _shown(line: bytes) -> str:
    return line.decode("latin-1").strip()[:60]


_Part = tuple[LineTexts, Indices, int]
"""Lines in upper case, their numbers, and the index of their file."""


def _expand(
    path: Path, files: DeckFiles, parents: tuple[Path, ...], included_from: str = ""
) -> list[_Part]:
    """Parts of a file and of what it includes, in their order."""
    index = len(files.names)
    data = files.read(path, included_from, parents)
    original = split_lines(data)
    number = np.arange(1, len(original) + 1, dtype=np.int64)
    upper = original.upper()
    parts: list[_Part] = []
    start = line = 0
    for candidate in upper.holding(b"INCLUDE").tolist():
        match = _INCLUDE.match(original[candidate])
        if match is None or candidate < line:
            continue
        parts.append((upper[start:candidate], number[start:candidate], index))
        origin = f"{files.names[index]}:{number[candidate]}"
        name, line = _file_name(original, candidate, match.end(), origin)
        included = _included(name, path, parents)
        parts += _expand(included, files, (*parents, path.resolve()), origin)
        start = line
    parts.append((upper[start:], number[start:], index))
    return parts


def _included(name: str, path: Path, parents: tuple[Path, ...]) -> Path:
    """Return an included file: beside the one that includes it, else beside the deck."""
    neighbour = path.parent / name
    deck = (parents[0] if parents else path).parent / name
    try:
        return deck if deck.is_file() and not neighbour.is_file() else neighbour
    except (OSError, ValueError):  # no name of a file: refused when it is read
        return neighbour


def _file_name(lines: LineTexts, line: int, start: int, origin: str) -> tuple[str, int]:
    """File name of an INCLUDE (quoted, over several lines perhaps, or bare) and the next line."""
    quote = lines[line][start - 1 : start]
    if quote not in (b"'", b'"'):
        bare = lines[line][start:].partition(b"$")[0].strip()
        return _decoded(bare, origin), line + 1
    text = lines[line][start:]
    while quote not in text and line + 1 < len(lines):
        line += 1
        text = text.rstrip() + lines[line].strip()
    name, closing, _ = text.partition(quote)
    if not closing:
        message = f"{origin}: the quoted file name of INCLUDE does not end; close the quote"
        raise FormatError(message)
    return _decoded(name.strip(), origin), line + 1


def _decoded(name: bytes, origin: str) -> str:
    if not name:
        message = f"{origin}: INCLUDE names no file; give one in quotes"
        raise FormatError(message)
    return name.decode("utf-8", "surrogateescape")
