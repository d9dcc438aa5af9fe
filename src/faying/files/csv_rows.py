"""Rows of csv files, whatever stands in them."""

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

from faying.exceptions import FormatError


def csv_rows(
    path: Path, lines: Iterable[str], *, first: int = 1
) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of each row.

    Parameters
    ----------
    first
        Number of the first line.

    Raises
    ------
    FormatError
        If a cell is longer than any number or name, as behind a quote that nothing closes.
    """
    rows = csv.reader(lines)
    try:
        yield from enumerate(rows, start=first)
    except csv.Error as error:
        line = first + rows.line_num - 1
        message = f"{path}, line {line}: {error}; close quotes, and separate cells by commas"
        raise FormatError(message) from None
