"""Headers and strings of text and binary OUTPUT4 files."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from faying._typing import Indices, Vector
from faying.io.matrix_labels import damaged
from faying.linalg.pieces import PIECE_NUMBERS

REAL, COMPLEX = (1, 2), (3, 4)
"""Type numbers of single and double precision."""

UNCHECKED_ROWS = 1_000_000
"""Rows or columns that any file may declare; more must agree with its size."""

BIG_ROWS = 65536
"""Rows from which Nastran uses the BIGMAT form without declaring it; in the
other form row and length share an integer, row + 65536 (words + 1)."""


@dataclass(frozen=True, kw_only=True)
class Header:
    """Header of a matrix.

    Attributes
    ----------
    big
        Whether strings have the BIGMAT form.
    position
        Line or byte of the header, for messages.
    layout
        Values per line and columns per value of a text file.
    """

    name: str
    rows: int
    columns: int
    form: int
    kind: int
    big: bool
    position: str
    layout: tuple[int, int] = (0, 0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Strings:
    """Runs of consecutive rows.

    Attributes
    ----------
    column, row, count : (n_string,)
        Column and first row, counted from 0, and number of values.
    start : (n_string,)
        Word or line of the file where the values begin.
    """

    column: Indices
    row: Indices
    count: Indices
    start: Indices


class Op4File(Protocol):
    """A file whose matrices can be listed and read."""

    def matrices(self) -> Iterator[tuple[Header, Strings]]:
        """Yield headers and strings of the matrices."""

    def values(self, header: Header, strings: Strings) -> Vector:
        """Return the values of all strings, concatenated."""


def checked_header(header: Header, n_bytes: int) -> Header:
    """Return a header after a check of type and of size against the file's size."""
    matrix_label = f"matrix '{header.name}' ({header.position})"
    if not (header.name and header.name.isascii() and header.name.isprintable()):
        damaged(f"no matrix name at {header.position}, where a header is expected")
    if header.kind not in (*REAL, *COMPLEX):
        damaged(
            f"{matrix_label} has type {header.kind}; expected 1 (real single) or 2 (real double)"
        )
    limit = max(UNCHECKED_ROWS, n_bytes)
    if not (0 < header.rows <= limit and 0 < header.columns <= limit):
        damaged(
            f"{matrix_label} declares {header.rows} rows and {header.columns} columns, which a "
            f"file of {n_bytes} bytes does not hold"
        )
    return header


def spread(starts: Indices, counts: Indices) -> Indices:
    """Return start, start + 1, … for each of several runs, joined."""
    ends = np.cumsum(counts)
    offsets = np.arange(int(ends[-1]) if len(ends) else 0, dtype=np.int64)
    return np.asarray(offsets + np.repeat(starts - (ends - counts), counts))


def chunks(counts: Indices) -> Iterator[slice]:
    """Divide strings into parts with about the same number of values."""
    ends = np.cumsum(counts)
    start = 0
    while start < len(ends):
        done = int(ends[start - 1]) if start else 0
        stop = max(int(np.searchsorted(ends, done + PIECE_NUMBERS)), start + 1)
        yield slice(start, stop)
        start = stop
