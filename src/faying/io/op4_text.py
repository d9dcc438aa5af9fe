"""Text OUTPUT4: integers in columns of eight, values in the columns the header announces."""

import re
from collections.abc import Iterator

import numpy as np

from faying._typing import Vector
from faying.io.matrix_labels import damaged
from faying.io.nastran.fields import reals
from faying.io.op4_values import BIG_ROWS, Header, Strings, checked_header, chunks, spread

_FORMAT = re.compile(r"(?:1P,)?(\d{1,3})[ED](\d{1,3})\.\d{1,3}")
_INTEGER = re.compile(r" *-?\d+")
_DEFAULT_FORMAT = (5, 16)

_PACKED_WIDTH = 18
"""A line with one integer, eight columns or wider, that holds row and length of a string."""


class TextFile:
    """An OP4 file of lines."""

    def __init__(self, content: bytes) -> None:
        if b"\t" in content or b"\0" in content:
            damaged("it is neither a binary nor a text OUTPUT4 file (it holds tabs or NUL)")
        plain = re.sub(rb"[ \r]+\n", b"\n", content).rstrip() + b"\n"
        self._letters = np.frombuffer(plain, dtype=np.uint8)
        self._content = plain
        ends = np.flatnonzero(self._letters == ord("\n"))
        self._first = np.concatenate([[0], ends[:-1] + 1])
        self._length = ends - self._first

    def matrices(self) -> Iterator[tuple[Header, Strings]]:
        """Yield headers and strings of the matrices."""
        line = 0
        while line < len(self._first):
            header = self._header(line)
            strings, line = self._columns(header, line + 1)
            yield header, strings

    def values(self, header: Header, strings: Strings) -> Vector:
        """Return the values of all strings, concatenated."""
        per_line, width = header.layout
        lines = -(-strings.count // per_line)
        numbers = spread(strings.start, lines)
        # All lines of a string but its last are full, so no character was inserted or lost.
        expected = np.full(len(numbers), per_line * width)
        expected[np.cumsum(lines) - 1] -= (lines * per_line - strings.count) * width
        wrong = np.flatnonzero(self._length[numbers] != expected)
        if wrong.size:
            line = int(numbers[wrong[0]])
            damaged(
                f"line {line + 1} has {self._length[line]} characters; its values take "
                f"{expected[wrong[0]]} ({width} each)"
            )
        parts = []
        for part in chunks(strings.count):
            count = strings.count[part]
            number = spread(np.zeros_like(count), count)
            line_of = np.repeat(strings.start[part], count) + number // per_line
            positions = (self._first[line_of] + number % per_line * width)[:, None]
            fields = self._letters[positions + np.arange(width)].view(f"S{width}").ravel()
            values, bad = reals(fields)
            if bad.any():
                first = int(np.flatnonzero(bad)[0])
                shown = fields[first].decode("latin-1").strip()
                damaged(f"line {line_of[first] + 1}: '{shown}' is not a number")
            parts.append(values)
        return np.concatenate([*parts, np.empty(0)])

    def _line(self, line: int) -> str:
        if line >= len(self._first):
            damaged(f"it ends after line {len(self._first)} within a matrix; it is incomplete")
        start = int(self._first[line])
        return self._content[start : start + int(self._length[line])].decode("latin-1")

    def _header(self, line: int) -> Header:
        text = self._line(line)
        wide = text.endswith("|I16")
        width = 16 if wide else 8
        text = text.removesuffix("|I16")
        columns, rows = self._integers(line, text[: 2 * width], 2, width)
        form, kind = self._integers(line, text[2 * width : 2 * width + 16], 2, 8)
        tail = text[2 * width + 16 :]
        name = "".join(tail[:8].split())
        header = Header(
            name=name,
            rows=abs(rows),
            columns=columns,
            form=form,
            kind=kind,
            big=rows < 0 or rows >= BIG_ROWS,
            position=f"line {line + 1}",
            layout=_layout(tail[8:].strip().upper(), line),
        )
        return checked_header(header, len(self._content))

    def _integers(self, line: int, text: str, count: int, width: int = 8) -> list[int]:
        """Return ``count`` integers of fixed width; refuse more or fewer."""
        fields = [text[i : i + width] for i in range(0, max(len(text), 1), width)]
        if len(fields) != count or not all(_INTEGER.fullmatch(field) for field in fields):
            damaged(
                f"line {line + 1}: expected {count} integers of {width} columns, found "
                f"'{text.strip()[:40]}'"
            )
        return [int(field) for field in fields]

    def _columns(self, header: Header, line: int) -> tuple[Strings, int]:
        """Scan the columns; the lines of each give the position of the next."""
        per_line, _ = header.layout
        strings: list[tuple[int, int, int, int]] = []
        last, dense = 0, None
        while True:
            column, row, length = self._integers(line, self._line(line), 3)
            if column == header.columns + 1:
                return self._ended(header, strings, line)
            if not last < column <= header.columns or length < 1:
                damaged(
                    f"line {line + 1}: column {column} of {length} words; expected one of the "
                    f"columns {last + 1} to {header.columns + 1}"
                )
            if dense not in (None, row != 0):
                damaged(f"line {line + 1}: matrix '{header.name}' has dense and sparse columns")
            last, dense = column, row != 0
            line += 1
            if dense:
                strings.append((column - 1, row - 1, length, line))
                line += -(-length // per_line)
            else:
                line = self._sparse_column(header, column, length, line, strings)

    def _sparse_column(
        self,
        header: Header,
        column: int,
        length: int,
        line: int,
        strings: list[tuple[int, int, int, int]],
    ) -> int:
        """Append the strings of a column and return the line after them."""
        per_line, _ = header.layout
        width = 2 if header.kind % 2 == 0 else 1
        while length > 0:
            if header.big:
                words, row = self._integers(line, self._line(line), 2)
                words, length = words - 1, length - words - 1
            else:
                (packed,) = self._integers(line, self._line(line).strip(), 1, _PACKED_WIDTH)
                words, row = packed // BIG_ROWS - 1, packed % BIG_ROWS
                length -= words + 1
            if words < 1 or words % width or length < 0:
                damaged(f"line {line + 1}: a string of {words} words overruns column {column}")
            strings.append((column - 1, row - 1, words // width, line + 1))
            line += 1 - (-(words // width) // per_line)
        return line

    def _ended(
        self, header: Header, strings: list[tuple[int, int, int, int]], line: int
    ) -> tuple[Strings, int]:
        """Join the strings after a check of the closing record."""
        closing = self._line(line + 1).split()
        if len(closing) != 1:
            damaged(
                f"line {line + 2}: matrix '{header.name}' does not close with one value after "
                f"column {header.columns}"
            )
        column, row, count, start = np.array(strings, dtype=np.int64).reshape(-1, 4).T
        if len(start) and int(start[-1]) >= len(self._first):
            self._line(int(start[-1]))
        return Strings(column=column, row=row, count=count, start=start), line + 2


def _layout(text: str, line: int) -> tuple[int, int]:
    """Return values per line and columns per value."""
    if not text:
        return _DEFAULT_FORMAT
    match = _FORMAT.fullmatch(text)
    if match is None or not (int(match[1]) > 0 and 1 < int(match[2]) <= 80):
        damaged(f"line {line + 1}: '{text}' is not a format of values such as 1P,3E23.16")
    return int(match[1]), int(match[2])
