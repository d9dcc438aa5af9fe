"""Binary OUTPUT4: Fortran records of 32- or 64-bit integers, little or big endian."""

import struct
from collections.abc import Iterator

import numpy as np

from faying._typing import Indices, Vector
from faying.io.matrix_labels import damaged
from faying.io.op4_values import BIG_ROWS, Header, Strings, checked_header, chunks, spread

_HEADER_BYTES = {24: 4, 48: 8}
"""Bytes per integer, by length of the header record."""

_Record = tuple[int, int]


def looks_binary(content: bytes) -> bool:
    """Return whether a file begins with the record length of a binary header."""
    return b"\0" in content[:4]


class BinaryFile:
    """An OP4 file of Fortran records: length, content, length."""

    def __init__(self, content: bytes) -> None:
        orders = [
            (order, size)
            for order in "<>"
            for length, size in _HEADER_BYTES.items()
            if content[:4] == struct.pack(f"{order}i", length)
        ]
        if not orders:
            damaged(
                "it begins like a binary file, but not with an OUTPUT4 header of 24 or 48 bytes"
            )
        if len(content) % 4:
            damaged(f"its {len(content)} bytes are not a whole number of words; it is incomplete")
        self._order, self._size = orders[0]
        self._content = content
        self._words = np.frombuffer(content, dtype=np.uint32)
        code = {4: "i", 8: "q"}[self._size]
        self._marker = struct.Struct(f"{self._order}i")
        self._start = struct.Struct(f"{self._order}3{code}")
        self._head = struct.Struct(f"{self._order}4{code}")

    def matrices(self) -> Iterator[tuple[Header, Strings]]:
        """Yield headers and strings of the matrices."""
        position = 0
        while position < len(self._content):
            header = self._header(self._record(position))
            strings, position = self._columns(header, position + 8 + 6 * self._size)
            yield header, strings

    def values(self, header: Header, strings: Strings) -> Vector:
        """Return the values of all strings, concatenated."""
        width = self._words_per_value(header)
        kind = np.dtype(f"{self._order}f{4 * width}")
        parts = []
        for part in chunks(strings.count):
            positions = spread(strings.start[part], strings.count[part] * width)
            parts.append(self._words[positions].view(kind).astype(np.float64))
        return np.concatenate([*parts, np.empty(0)])

    def _words_per_value(self, header: Header) -> int:
        """Return four-byte words per value; with 8-byte integers, singles have 8 bytes too."""
        single, parts = header.kind % 2 == 1 and self._size == 4, 1 + (header.kind > 2)
        return parts * (1 if single else 2)

    def _record(self, position: int) -> _Record:
        """Return start and end of the content of a record."""
        end = -1
        if position + 4 <= len(self._content):
            (length,) = self._marker.unpack_from(self._content, position)
            end = position + 4 + length
        if end < position + 4 or end + 4 > len(self._content) or length % 4:
            damaged(f"the record at byte {position} does not end within the file; it is damaged")
        if self._marker.unpack_from(self._content, end)[0] != length:
            damaged(f"the record at byte {position} does not end with its length {length}")
        return position + 4, end

    def _header(self, record: _Record) -> Header:
        start, end = record
        if end - start != 6 * self._size:
            damaged(f"expected the header of a matrix at byte {start - 4}")
        columns, rows, form, kind = self._head.unpack_from(self._content, start)
        # Two words of four letters, or eight with 64-bit integers, padded with blanks.
        text = self._content[start + 4 * self._size : end].replace(b"\0", b" ")
        name = "".join(text.decode("latin-1").split())
        header = Header(
            name=name,
            rows=abs(rows),
            columns=columns,
            form=form,
            kind=kind,
            big=rows < 0 or rows >= BIG_ROWS,
            position=f"byte {start - 4}",
        )
        return checked_header(header, len(self._content))

    def _columns(self, header: Header, position: int) -> tuple[Strings, int]:
        """Scan the column records; the length of each gives the position of the next."""
        strings: list[tuple[int, int, int, int]] = []
        last = 0
        while True:
            start, end = self._record(position)
            if end - start < 3 * self._size:
                damaged(f"the record at byte {position} is too short for a column")
            column, row, length = self._start.unpack_from(self._content, start)
            if column == header.columns + 1:
                break
            if not last < column <= header.columns:
                damaged(
                    f"the record at byte {position} is of column {column}; expected one from "
                    f"{last + 1} to {header.columns + 1}"
                )
            if end - start != (3 + length) * self._size:
                damaged(
                    f"the record of column {column} at byte {position} declares {length} words and "
                    f"holds {(end - start) // self._size - 3}"
                )
            last = column
            strings.append((column, row, (start + 3 * self._size) // 4, end // 4))
            position = end + 4
        table = np.array(strings, dtype=np.int64).reshape(-1, 4).T
        column, row, first, stop = table
        return self._strings(header, column - 1, row, first, stop), end + 4

    def _strings(
        self, header: Header, column: Indices, row: Indices, first: Indices, stop: Indices
    ) -> Strings:
        """Divide columns into strings: a dense column is one; sparse columns have row 0."""
        width = self._words_per_value(header)
        dense = row != 0
        if dense.any() and not dense.all():
            damaged(f"matrix '{header.name}' ({header.position}) has dense and sparse columns")
        if dense.all():
            return Strings(
                column=column,
                row=row - 1,
                count=_whole(header, stop - first, width),
                start=first,
            )
        return self._sparse_strings(header, column, first, stop)

    def _sparse_strings(
        self, header: Header, column: Indices, first: Indices, stop: Indices
    ) -> Strings:
        """Read the strings of sparse columns, the next string of all columns at once."""
        width, step = self._words_per_value(header), self._size // 4
        heads = (2 if header.big else 1) * step
        parts: list[tuple[Indices, Indices, Indices, Indices]] = []
        while len(column):
            if (first + heads > stop).any():
                damaged(f"matrix '{header.name}' ({header.position}): a string is cut off")
            length, row = self._string_heads(header, first)
            first = first + heads
            words = length * step
            if (length < 1).any() or (first + words > stop).any():
                bad_column = (
                    int(column[np.flatnonzero((length < 1) | (first + words > stop))[0]]) + 1
                )
                damaged(
                    f"matrix '{header.name}': a string of column {bad_column} overruns its record"
                )
            parts.append((column, row - 1, _whole(header, words, width), first))
            first = first + words
            more = first < stop
            column, first, stop = column[more], first[more], stop[more]
        joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
        order = np.argsort(joined[0], kind="stable")
        column, row, count, start = (part[order] for part in joined)
        return Strings(column=column, row=row, count=count, start=start)

    def _string_heads(self, header: Header, first: Indices) -> tuple[Indices, Indices]:
        """Return word counts and first rows of the strings that begin at words of the file."""
        head = self._integers(first)
        if header.big:
            return head - 1, self._integers(first + self._size // 4)
        return head // BIG_ROWS - 1, head % BIG_ROWS

    def _integers(self, positions: Indices) -> Indices:
        width = self._size // 4
        words = spread(positions, np.full(len(positions), width))
        return self._words[words].view(f"{self._order}i{self._size}").astype(np.int64)


def _whole(header: Header, words: Indices, width: int) -> Indices:
    if (words % width).any() or (words <= 0).any():
        damaged(f"matrix '{header.name}' ({header.position}) has a string that ends within a value")
    return words // width
