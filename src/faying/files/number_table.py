"""CSV files of numbers below a line of column names."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.display.facts import bulleted
from faying.exceptions import FormatError, refuse
from faying.files.contents import file_text
from faying.files.csv_rows import csv_rows


@dataclass(frozen=True, eq=False, kw_only=True)
class NumberTable:
    """A table of numbers read from a file.

    Attributes
    ----------
    path
    names
        Names of the columns of numbers.
    values : (n_row, n_column)
    lines : (n_row,)
        Line number of each row.
    labels
        Names of the rows; None without a column of names.
    """

    path: Path
    names: tuple[str, ...]
    values: Matrix
    lines: Indices
    labels: tuple[str, ...] | None = None

    def column(self, name: str) -> Vector:
        """Return the numbers of a column (n_row,)."""
        return self.values[:, self.names.index(name)]

    def place(self, row: int) -> str:
        """Return file and line of a row."""
        return f"{self.path}, line {self.lines[row]}"


def read_numbers(
    path: Path,
    what: str,
    *,
    label: str | None = None,
    unnamed: tuple[str, ...] = (),
    largest: float = inf,
) -> NumberTable:
    """Read a CSV file of numbers; empty lines and comments after # are left out.

    Messages call the file ``what``. The column ``label`` holds names, which may contain # except
    at the beginning of a line. The first line names the columns; it may be missing where
    ``unnamed`` gives their names. No magnitude may exceed ``largest``.
    """
    lines = lines_of(path, what)
    if label is None:
        lines = [line.split("#", 1)[0] for line in lines]
    return numbers_in(lines, path, label=label, unnamed=unnamed, largest=largest)


def lines_of(path: Path, what: str) -> list[str]:
    """Return the lines of a text file, which messages call ``what``."""
    try:
        return file_text(path).splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        message = f"cannot read {what} {path}: {reason}; give a csv file in UTF-8"
        raise FormatError(message) from None


def numbers_in(
    lines: Sequence[str],
    path: Path,
    *,
    label: str | None = None,
    unnamed: tuple[str, ...] = (),
    largest: float = inf,
) -> NumberTable:
    """Return the numbers of the lines of a file, as :func:`read_numbers`."""
    numbered = enumerate(map(str.strip, lines), start=1)
    rows = [(number, line) for number, line in numbered if line.strip(",#") and line[0] != "#"]
    if not rows:
        refuse(f"{path} is empty; give a line of column names, and numbers below it")
    first = _cells(path, *rows[0])
    names = list(unnamed) or first
    if not unnamed or not any(map(_is_number, first)):
        _check_names(path, rows[0][0], first)
        del rows[0]
    numeric = [number for number, name in enumerate(names) if name != label]
    values = None
    if all(_width(path, *row) == len(names) for row in rows):
        values = _column_values(rows, numeric, float)
    if values is None or not (np.abs(values) <= largest).all() or not np.isfinite(values).all():
        raise _wrong_cells(path, names, rows, label, largest)
    labels = _column_values(rows, [names.index(label)], str) if label in names and rows else None
    return NumberTable(
        path=path,
        names=tuple(names[number] for number in numeric),
        values=values,
        lines=np.array([number for number, _ in rows], dtype=np.int64),
        labels=None if labels is None else tuple(map(str.strip, labels[:, 0].tolist())),
    )


def read_number_table(path: Path, columns: Sequence[Sequence[str]], what: str) -> NumberTable:
    """Read a CSV file that must have one of several sets of columns, in any order.

    Messages call the file ``what``.

    Raises
    ------
    FormatError
        As :func:`read_numbers`, or if the file has other columns or no numbers.
    """
    table = read_numbers(path, what)
    table = replace(table, names=tuple(name.lower() for name in table.names))
    if sorted(table.names) not in [sorted(names) for names in columns]:
        headers = " or ".join(",".join(names) for names in columns)
        refuse(
            f"{path}: the columns are '{','.join(table.names)}'; the first line must name "
            f"{'either ' * (len(columns) > 1)}{headers}"
        )
    if not len(table.lines):
        refuse(f"{path}: {what} has no lines below its column names")
    return table


def check_times(path: Path, times: Vector, place: Callable[[int], str], *, fewest: int = 1) -> None:
    """Refuse times that do not increase, or are too few.

    ``place`` returns file and line of an instant. Where at least two instants are needed, the
    first must not be negative.
    """
    if len(times) < fewest:
        refuse(f"{path}: found {len(times)} instants, expected {fewest} or more")
    if fewest > 1 and times[0] < 0:
        refuse(f"{place(0)}: time {times[0]:g} is negative; loads act from t = 0, shift the times")
    back = np.flatnonzero(np.diff(times) <= 0)
    if back.size:
        row = int(back[0]) + 1
        refuse(
            f"{place(row)}: time {times[row]:g} does not come after {times[row - 1]:g}; times must "
            "increase"
        )


def _cells(path: Path, number: int, line: str) -> list[str]:
    """Return the cells of a line; commas within quotes belong to a name."""
    row = next(csv_rows(path, [line], first=number))[1] if '"' in line else line.split(",")
    return [cell.strip() for cell in row]


def _width(path: Path, number: int, line: str) -> int:
    return len(_cells(path, number, line)) if '"' in line else line.count(",") + 1


def _column_values(
    rows: Sequence[tuple[int, str]], columns: Sequence[int], kind: type
) -> np.ndarray[Any, Any] | None:
    """Return columns (n_row, n_column) of lines; None where a cell has another type."""
    if not rows or not columns:
        return np.empty((len(rows), len(columns)))
    try:
        return np.loadtxt(
            [line for _, line in rows],
            delimiter=",",
            usecols=columns,
            dtype=kind,
            ndmin=2,
            quotechar='"',
            comments=None,
        )
    except ValueError:
        return None


def _is_number(cell: str) -> bool:
    try:
        # Python also takes 1_000 and the digits of other scripts.
        return isfinite(float(cell)) and cell.isascii() and "_" not in cell
    except ValueError:
        return False


def _check_names(path: Path, line: int, names: Sequence[str]) -> None:
    wrong = ""
    if all(map(_is_number, names)):
        wrong = "found numbers, expected the names of the columns; add a line with them"
    elif any(";" in name for name in names):
        wrong = "columns are separated by semicolons; separate them by commas, with decimal points"
    twice = [name for number, name in enumerate(names) if name in names[:number]]
    if twice:
        wrong = f"column '{twice[0]}' occurs twice; keep one"
    if wrong:
        refuse(f"{path}, line {line}: {wrong}")


def _wrong_cells(
    path: Path,
    names: Sequence[str],
    rows: Sequence[tuple[int, str]],
    label: str | None,
    largest: float,
) -> FormatError:
    every = ((line, _cells(path, line, text)) for line, text in rows)
    wrong = [text for line, row in every for text in _wrong(names, line, row, label, largest)]
    limit = f" up to {largest:g} in magnitude" if largest < inf else ""
    return FormatError(
        f"{path}: expected finite numbers{limit}, with decimal points and separated by commas\n"
        f"{bulleted(wrong)}"
    )


def _wrong(
    names: Sequence[str], line: int, row: Sequence[str], label: str | None, largest: float
) -> Iterator[str]:
    if len(row) != len(names):
        yield f"line {line}: found {len(row)} cells, expected {len(names)}"
        return
    for name, cell in zip(names, row, strict=True):
        if name != label and not (_is_number(cell) and abs(float(cell)) <= largest):
            yield f"line {line}: found '{cell[:40]}' in column '{name}'"
