"""A deck with its INCLUDE files: case control, and bulk data as one flat table of fields.

A physical line has eight data fields, four in large field form. All lines are processed at once;
only free-field lines need a Python loop.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask
from faying.exceptions import refuse
from faying.io.deck_lines import Dialect, Lines, LineTexts, edited, read_lines
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Bulk
from faying.io.nastran.fields import Fields
from faying.io.nastran.replication import Edits, replicated, unfolded

_INCLUDE = re.compile(rb"^[ \t]*INCLUDE[ \t]*['\"]?", re.IGNORECASE)
_BEGIN = re.compile(rb"^\s*BEGIN(?:[\s,]*BULK)?\b(.*)$")
_CEND = re.compile(rb"^\s*CEND\b")
_END = re.compile(rb"^\s*ENDDATA\b")
_CONTROL = re.compile(rb"^\s*(?:CEND\b|SOL\s+\S|SUBCASE\s+\d)")


def read_source(path: Path) -> tuple[Lines, Lines]:
    """Return the lines before bulk data (up to case control), and the bulk data lines of a deck.

    A file without BEGIN BULK is bulk data from its first line, unless it has a CEND or SOL.
    """
    lines = read_lines(path, _DIALECT)
    return _sections(replace(lines, text=lines.text.upper()), path)


def _sections(lines: Lines, path: Path) -> tuple[Lines, Lines]:
    begin = 0
    # DMAP before CEND has its own BEGIN.
    cend = next(_matching(lines.text, b"CEND", _CEND), -1)
    begins = [i for i in _matching(lines.text, b"BEGIN", _BEGIN) if i > cend]
    if begins:
        begin = begins[0] + 1
        for i in begins:
            match = _BEGIN.match(lines.text[i])
            argument = match.group(1).partition(b"$")[0].strip() if match else b""
            if argument or i != begins[0]:
                shown = lines.text[i].decode("latin-1").strip()[:60]
                refuse(
                    f"{lines.where(i)}: '{shown}' starts another bulk data "
                    "section; superelement decks are not supported, merge them into one section"
                )
    elif any(_CONTROL.match(text) for text in lines.text[:2000]):
        refuse(f"{path}: executive or case control but no BEGIN BULK line; add it")
    ends = _matching(lines.text, b"ENDDATA", _END)
    end = next((i for i in ends if i >= begin), len(lines.text))
    return lines[: max(begin - 1, 0)], lines[begin:end]


def _matching(text: LineTexts, keyword: bytes, pattern: re.Pattern[bytes]) -> Iterator[int]:
    """Yield the lines with a keyword that match a pattern."""
    return (i for i in text.holding(keyword).tolist() if pattern.match(text[i]))


def _includes(text: LineTexts, where: Callable[[int], str]) -> Iterator[tuple[int, int, str]]:
    """Yield first line, next line and file name of each INCLUDE."""
    line = 0
    for candidate in text.upper().holding(b"INCLUDE").tolist():
        match = _INCLUDE.match(text[candidate])
        if match is not None and candidate >= line:
            name, line = _file_name(text, candidate, match.end(), where(candidate))
            yield candidate, line, name


def _file_name(lines: LineTexts, line: int, start: int, origin: str) -> tuple[str, int]:
    """Return the file name of an INCLUDE (bare, or quoted on several lines) and the next line."""
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
        refuse(f"{origin}: the quoted file name of INCLUDE does not end; close the quote")
    return _decoded(name.strip(), origin), line + 1


def _decoded(name: bytes, origin: str) -> str:
    if not name:
        refuse(f"{origin}: INCLUDE without a file name; give one in quotes")
    return name.decode("utf-8", "surrogateescape")


_DIALECT = Dialect(kind="Nastran deck", include="INCLUDE", statements=_includes)


_BLANK, _STAR, _PLUS, _COMMA = (ord(c) for c in " *+,")
_BLANKS = np.frombuffer(b" " * 8, dtype=np.uint64)[0]
_COLUMNS = 80
_DATA = 72
_NAME_AND_ID = re.compile(rb"([A-Z][A-Z0-9]{0,7}\*?) +(\d+)")
"""Text before the first comma; blanks separate fields too."""

_Letters = npt.NDArray[np.uint8]


def read_cards(lines: Lines) -> Bulk:
    """Split bulk data lines into cards and fields.

    Continuation lines must follow their parent (comments may lie between).

    Notes
    -----
    About 1 µs a line, 130 bytes of memory a line.
    """
    text = lines.text.cut_at(b"$")
    text, origin = edited(text, unfolded(text))
    text, standing = edited(text, replicated(text, lambda i: lines.where(int(origin[i]))))
    origin = origin[standing]
    text, _ = edited(text, _without_tabs(text, origin, lines))
    letters = text.letters(_COLUMNS)
    np.maximum(letters, np.uint8(_BLANK), out=letters)  # unprintable below the blank
    rows = np.flatnonzero((_words(letters) != _BLANKS).any(axis=1))
    if len(rows) < len(letters):
        letters, origin = letters[rows], origin[rows]
    source_lines = origin
    free = np.zeros(len(rows), dtype=bool)
    maybe = np.flatnonzero(np.isin(rows, text.holding(b",")))
    free[maybe] = (letters[maybe] == _COMMA).any(axis=1)
    split = {
        int(i): _split_free(text[rows[i]], lines, int(source_lines[i]))
        for i in np.flatnonzero(free)
    }
    head = letters[:, :8].copy()
    for i, parts in split.items():
        head[i] = np.frombuffer(parts[0].ljust(8)[:8], dtype=np.uint8)
    first = head[:, 0]
    continued = (first == _PLUS) | (first == _STAR) | (_words(head)[:, 0] == _BLANKS)
    if len(source_lines) and continued[0]:
        refuse(f"{lines.where(int(source_lines[0]))}: a continuation line without a card above it")
    _check_markers(letters, continued, free, source_lines, lines)
    _check_straddling(letters, continued, free, source_lines, lines)
    large = (head == _STAR).any(axis=1)
    count = np.where(large, 4, 8) + _padding(large, continued)
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    heads = np.flatnonzero(~continued)
    names = np.char.strip(np.ascontiguousarray(head[heads]).view("S8").ravel(), b"* \0")
    return Bulk(
        fields=_fields(letters, large, free, split, start),
        names=names,
        start=np.append(start[heads], start[-1]),
        line_start=start[:-1],
        line=source_lines,
        lines=lines,
    )


def _words(letters: _Letters) -> npt.NDArray[np.uint64]:
    """Return eight characters as one number."""
    return letters.view(np.uint64)


def _without_tabs(text: LineTexts, origin: Indices, lines: Lines) -> Edits:
    for i in text.holding(b"\t").tolist():
        yield i, i + 1, [_without_tab(text[i], lines, int(origin[i]))]


def _without_tab(line: bytes, lines: Lines, i: int) -> bytes:
    if b"," in line:
        return line.replace(b"\t", b" ")
    if b"*" in line[:8]:
        refuse(f"{lines.where(i)}: tabs in a large-field line; replace them by blanks")
    return line.expandtabs(8)


def _split_free(line: bytes, lines: Lines, i: int) -> list[bytes]:
    """Return name and exactly eight (large: four) data fields of a free-field line."""
    parts = [part.strip() for part in line.split(b",")]
    if match := _NAME_AND_ID.fullmatch(parts[0]):
        parts[:1] = match.groups()
    if len(parts[0]) > 8 or b" " in parts[0]:
        shown = parts[0][:24].decode("latin-1")
        refuse(
            f"{lines.where(i)}: a comma after '{shown}' in a line of fixed fields; write points "
            "for decimal commas, or separate all fields by commas"
        )
    size = 4 if b"*" in parts[0] else 8
    extra = [part for part in parts[size + 1 :] if part]
    if len(extra) > 1 or (extra and (parts[size + 1] == b"" or extra[0][:1] not in b"+*")):
        refuse(
            f"{lines.where(i)}: a free-field line with more than {size} data fields; "
            "continue it on a line that starts with a comma"
        )
    return (parts[: size + 1] + [b""] * size)[: size + 1]


def _check_markers(
    letters: _Letters, continued: Mask, free: Mask, source_lines: Indices, lines: Lines
) -> None:
    """Refuse continuations with the mark of another card, as in a deck sorted by name."""
    below = np.flatnonzero(continued & ~free)
    below = below[(below > 0) & ~free[below - 1]]
    words = _words(letters)
    below = below[(words[below, 0] != _BLANKS) & (words[below - 1, 9] != _BLANKS)]
    mark = np.ascontiguousarray(letters[below, :8]).view("S8").ravel()
    expected = np.ascontiguousarray(letters[below - 1, 72:80]).view("S8").ravel()
    # Nastran compares seven of the eight columns, without the first.
    named = np.char.strip(_behind_first(mark)) == np.char.strip(_behind_first(expected))
    mark, expected = np.char.strip(mark, b"+* "), np.char.strip(expected, b"+* ")
    wrong = below[(mark != b"") & (expected != b"") & (mark != expected) & ~named]
    if wrong.size:
        i = int(source_lines[wrong[0]])
        refuse(
            f"{lines.where(i)}: this continuation does not belong to the line above (its mark "
            "differs); put continuation lines directly below their card"
        )


def _behind_first(marks: Fields) -> Fields:
    """Return marks of eight columns without the first one."""
    remainder: Fields = np.ascontiguousarray(numbers.characters(marks)[:, 1:]).view("S7").ravel()
    return remainder


def _check_straddling(
    letters: _Letters, continued: Mask, free: Mask, source_lines: Indices, lines: Lines
) -> None:
    """Refuse numbers beyond column 72, whose last digits would be lost.

    If the continuation repeats columns 73 to 80, they are its mark.
    """
    tail, last = letters[:, _DATA], letters[:, _DATA - 1]
    digit = ((tail >= ord("0")) & (tail <= ord("9"))) | (tail == ord("."))
    over = np.flatnonzero(digit & (last != _BLANK) & ~free)
    for i in over.tolist():
        mark = letters[i, _DATA:].tobytes().strip()
        below = (
            letters[i + 1, :8].tobytes().strip(b"+* ") if continued[i + 1 : i + 2].any() else b""
        )
        if below != mark:
            shown = letters[i, _DATA - 8 :].tobytes().decode("latin-1").strip()
            refuse(
                f"{lines.where(int(source_lines[i]))}: '{shown}' runs over column {_DATA}, where "
                "the data fields end; are fields shifted?"
            )


def _padding(large: Mask, continued: Mask) -> Indices:
    """Return the blank fields to add to large-field lines continued by small-field lines."""
    padding = np.zeros(len(large), dtype=np.int64)
    joint = np.flatnonzero(large[:-1] & ~large[1:] & continued[1:])
    for i in joint:
        run = 1
        while continued[i - run + 1] and large[i - run]:
            run += 1
        padding[i] = 4 * (run % 2)
    return padding


def _fields(
    letters: _Letters, large: Mask, free: Mask, split: dict[int, list[bytes]], start: Indices
) -> Fields:
    longest = max((len(part) for parts in split.values() for part in parts[1:]), default=0)
    size = max(-(-longest // 8), 2 if large.any() else 1)
    table = np.full((int(start[-1]), size), _BLANKS)
    words = _words(letters)
    if large.any():
        rows = np.flatnonzero(~large)
        table[start[rows][:, None] + np.arange(8), 0] = words[rows, 1:9]
        rows = np.flatnonzero(large & ~free)
        table[start[rows][:, None] + np.arange(4), :2] = words[rows, 1:9].reshape(-1, 4, 2)
    else:
        table.reshape(-1, 8, size)[:, :, 0] = words[:, 1:9]
    fields: Fields = table.view(f"S{8 * size}").ravel()
    for i, parts in split.items():
        fields[start[i] : start[i] + len(parts) - 1] = parts[1:]
    return fields
