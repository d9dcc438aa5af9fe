"""Tables: columns with a title, a dimension, and a function from a row to the entry.

Titles, texts of cells and the numbers of csv files come from the same columns.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying.digits import SOLVED
from faying.display.quantities import number
from faying.units import Units

MARKS = {"good": "✓", "fair": "~", "poor": "✗", "": ""}
NONE = "—"
PRESSURE, FL = "force/length²", "force·length"


@dataclass(frozen=True, kw_only=True)
class Cell:
    """A cell: its text, its number, and a grade that sets its colour and mark."""

    text: str
    value: float | None = None
    grade: str = ""

    @property
    def mark(self) -> str:
        """The grade as a character, for print and for colour-blind readers."""
        return MARKS[self.grade]


Entry = Cell | str | float | None


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    title
    value
        Function from a row to its entry; None leaves the cell empty.
    dimension
        A dimension such as ``"force/length²"``, or a unit such as ``"%"``.
    digits
        Number of significant digits.
    """

    title: str
    value: Callable[[Any], Entry]
    dimension: str = ""
    digits: int = 4


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table whose first column holds the names of the rows.

    Attributes
    ----------
    columns
        Heads, with units.
    rows
    names
        Column names of a csv file, all different.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    names: tuple[str, ...] = field(default=())


def described(
    head: str, rows: Iterable[tuple[str, Any]], columns: Iterable[Column], units: Units
) -> Table:
    """Return a table of named rows, without empty columns; without rows if all are empty.

    ``head`` is the title of the first column, which holds the names.
    """
    named = list(rows)
    entries = [(definition, [definition.value(row) for _, row in named]) for definition in columns]
    filled = [
        (definition, values) for definition, values in entries if any(v is not None for v in values)
    ]
    named = named if filled else []
    heads, names = [head], [head]
    for column, _ in filled:
        unit = units.of(column.dimension)
        text = f"{column.title} [{unit}]" if unit not in ("", "1") else column.title
        heads.append(text)
        names.append(f"{names[-1].partition(' [')[0]}, load case" if text == "in" else text)
    cells = [
        (Cell(text=name), *(cell(values[row_number], column) for column, values in filled))
        for row_number, (name, _) in enumerate(named)
    ]
    return Table(columns=tuple(heads), rows=tuple(cells), names=tuple(names))


def cell(entry: Entry, column: Column) -> Cell:
    """Return the entry of a column as a cell."""
    if isinstance(entry, Cell):
        return entry
    if entry is None:
        return Cell(text=NONE)
    if isinstance(entry, str):
        return Cell(text=entry)
    value = float(entry)
    if column.dimension == "%" and 0 < abs(value) < 100 * SOLVED:
        return Cell(text=f"< {100 * SOLVED:.0e}".replace("e-0", "e-"), value=value)
    text = number(value, column.digits) if value % 1 or abs(value) > LARGE else f"{value:.0f}"
    return Cell(text=text.replace("-", "−") if value < 0 else text, value=value)


LARGE = 1e6
"""Whole numbers above this are rounded to their leading digits."""


def graded(fraction: float, grade: str, digits: int = 3) -> Cell:
    """Return the cell of a fraction in percent with its grade."""
    text = cell(100 * fraction, Column("", lambda row: row, "%", digits)).text
    return Cell(text=text, value=100 * fraction if np.isfinite(fraction) else None, grade=grade)


def largest(values: Mapping[str, float]) -> str | None:
    """Return the name of the largest value; None without values."""
    return max(values, key=values.__getitem__) if values else None
