"""Rows of csv files, read and written."""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

from faying.exceptions import FormatError
from faying.files.atomic import replacing


def csv_rows(
    path: Path, lines: Iterable[str], *, first: int = 1
) -> Iterator[tuple[int, list[str]]]:
    """Yield the number of each row, counted from ``first``, and its cells.

    Raises
    ------
    FormatError
        If a cell is too long, as after a quote that is never closed.
    """
    rows = csv.reader(lines)
    try:
        yield from enumerate(rows, start=first)
    except csv.Error as error:
        line = first + rows.line_num - 1
        message = f"{path}, line {line}: {error}; close quotes, and separate cells by commas"
        raise FormatError(message) from None


def write_rows(path: Path, rows: Iterable[Iterable[object]], number: str = "%.7g") -> None:
    """Write rows of a table atomically; the first row holds the column names.

    Floating-point numbers have the format ``number``.
    """
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        for row in rows:
            table.writerow(number % value if isinstance(value, float) else value for value in row)
