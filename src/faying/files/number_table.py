"""CSV files of numbers below a line of column names."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from faying._typing import Matrix
from faying.exceptions import FormatError
from faying.files.contents import file_text
from faying.files.csv_rows import csv_rows


def read_number_table(
    path: Path, columns: Sequence[Sequence[str]], what: str
) -> tuple[list[str], Matrix]:
    """Read a CSV file of numbers below a line of column names.

    Parameters
    ----------
    columns
        Names that the file may have, in any order; several sets of which it has one.
    what
        What the file is, for messages.

    Returns
    -------
    tuple of list of str, ndarray (n, n_column)
        The names in the order of the file, and the numbers.

    Raises
    ------
    FormatError
        If the file is missing, has other columns, or holds something that is no finite number.
    """
    try:
        lines = file_text(path).splitlines()
    except (OSError, UnicodeDecodeError) as error:
        message = f"{path}: {what} cannot be read ({error})"
        raise FormatError(message) from None
    numbered = [
        (number, [entry.strip() for entry in row])
        for number, row in csv_rows(path, lines)
        if row and not row[0].lstrip().startswith("#")
    ]
    header = [name.lower() for name in numbered[0][1]] if numbered else []
    if sorted(header) not in [sorted(names) for names in columns]:
        headers = " or ".join(",".join(names) for names in columns)
        message = (
            f"{path}: the columns are '{','.join(header)}'; the first line must name "
            f"{'either ' * (len(columns) > 1)}{headers}"
        )
        raise FormatError(message)
    rows = [_numbers(path, number, row, len(header)) for number, row in numbered[1:]]
    if not rows:
        message = f"{path}: {what} has no lines below its column names"
        raise FormatError(message)
    return header, np.array(rows)


def _numbers(path: Path, number: int, row: list[str], count: int) -> list[float]:
    try:
        values = [float(entry) for entry in row]
    except ValueError:
        values = []
    if len(values) != count or not all(math.isfinite(value) for value in values):
        message = f"{path}:{number}: '{','.join(row)}' is not {count} finite numbers"
        raise FormatError(message)
    return values
