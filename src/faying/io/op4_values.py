"""What text and binary OUTPUT4 files have in common."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from faying._typing import Indices, Vector
from faying.io.matrix_labels import damaged
from faying.linalg.pieces import PIECE_NUMBERS

REAL, COMPLEX = (1, 2), (3, 4)
"""Types of matrices, single and double."""

UNCHECKED_ROWS = 1_000_000
"""Rows or columns that any file may claim; more must be justified by its size."""

BIG_ROWS = 65536
"""Rows from which Nastran writes strings in the BIGMAT form even where it does not say so; in the
other form row and length share an integer, row + 65536 (words + 1)."""


@dataclass(frozen=True, kw_only=True)
class Header:
    """What stands in front of a matrix.

    Attributes
    ----------
    big
        Whether strings are written in the BIGMAT form.
    position
        Line or byte where it stands, for messages.
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
        Column and first row from zero, and the number of values.
    start : (n_string,)
        Where the values begin: a word or a line of the file.
    """

    column: Indices
    row: Indices
    count: Indices
    start: Indices


class Op4File(Protocol):
    """A file whose matrices can be found and fetched."""

    def matrices(self) -> Iterator[tuple[Header, Strings]]:
        """Walk through the matrices."""

    def values(self, header: Header, strings: Strings) -> Vector:
        """Return the values of strings one after the other."""


def checked_header(header: Header, n_bytes: int) -> Header:
    """Return a header of a known type whose size the file's size can justify."""
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
            f"{matrix_label} claims {header.rows} rows and {header.columns} columns, which a "
            f"file of {n_bytes} bytes does not hold"
        )
    return header


def spread(starts: Indices, counts: Indices) -> Indices:
    """Return start, start + 1, … for each of several runs, joined."""
    ends = np.cumsum(counts)
    offsets = np.arange(int(ends[-1]) if len(ends) else 0, dtype=np.int64)
    return np.asarray(offsets + np.repeat(starts - (ends - counts), counts))


def chunks(counts: Indices) -> Iterator[slice]:
    """Divide strings so that each part holds about so many numbers as a piece."""
    ends = np.cumsum(counts)
    start = 0
    while start < len(ends):
        done = int(ends[start - 1]) if start else 0
        stop = max(int(np.searchsorted(ends, done + PIECE_NUMBERS)), start + 1)
        yield slice(start, stop)
        start = stop
