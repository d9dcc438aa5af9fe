"""Tables: columns that say what they hold, in which unit, and how it is read off a row.

One description makes the head, the text of a cell and the number that a csv file gets.
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
    """One cell: text, the number it stands for, and a grade that colours and marks it."""

    text: str
    value: float | None = None
    grade: str = ""

    @property
    def mark(self) -> str:
        """The grade as a character, for print and for eyes that see colours otherwise."""
        return MARKS[self.grade]


Entry = Cell | str | float | None


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes
    ----------
    title
    value
        Takes a row to its entry; None is none.
    dimension
        As ``"force/length²"``, or a unit such as ``"%"``.
    digits
        Significant ones that are shown.
    """

    title: str
    value: Callable[[Any], Entry]
    dimension: str = ""
    digits: int = 4


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table; the first column holds row heads.

    Attributes
    ----------
    columns
        Heads, with units.
    rows
    names
        Heads as a csv file has them, each different from the others.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    names: tuple[str, ...] = field(default=())


def described(
    head: str, rows: Iterable[tuple[str, Any]], columns: Iterable[Column], units: Units
) -> Table:
    """Return a table of named rows, without columns in which nothing stands; names alone are none.

    ``head`` is that of the first column, which has the names.
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
"""Whole numbers beyond are shown with their leading digits alone."""


def graded(fraction: float, grade: str, digits: int = 3) -> Cell:
    """Return a share in percent with its grade."""
    text = cell(100 * fraction, Column("", lambda row: row, "%", digits)).text
    return Cell(text=text, value=100 * fraction if np.isfinite(fraction) else None, grade=grade)


def largest(values: Mapping[str, float]) -> str | None:
    """Return the name of the largest of some values; None where there is none."""
    return max(values, key=values.__getitem__) if values else None
