"""Load factors of a path: one column of a csv file for each load, one row for each increment."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from faying._typing import Matrix
from faying.exceptions import StudyError
from faying.files.contents import file_text
from faying.files.csv_rows import csv_rows
from faying.study.keys.errors import MOST_SHOWN, quoted
from faying.study.keys.ranges import LARGEST, MOST_LOADS

ALL = "factor"
"""Name of the column that multiplies all loads of a case."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadFactors:
    """A path as its file has it.

    Attributes
    ----------
    names
        Of the columns: a load of the case, a bolt, or :data:`ALL`.
    values : (n_increment, n_column)
    """

    names: tuple[str, ...]
    values: Matrix


def read_load_factors(path: Path, loads: Sequence[str]) -> LoadFactors:
    """Read the load factors of a path.

    Parameters
    ----------
    path
        Comma-separated text: a line of names, then a line of numbers for each increment. Empty
        lines and comments after ``#`` are allowed.
    loads
        Names of the loads of the case, each of which has a column unless one of the columns is
        called ``factor`` and multiplies all. Other columns are factors of bolts' initial forces.

    Raises
    ------
    StudyError
        If it cannot be read, a name is missing or there twice, a line has gaps, or a factor is no
        finite number; the message lists everything with its line.
    """
    rows = [(n, cells) for n, cells in _rows(path) if any(cells)]
    header, *body = rows or [(1, [])]
    problems = [*_names(header[1], loads), *_lines(header[1], body)]
    if problems:
        more = f"; and {len(problems) - MOST_SHOWN} more" * (len(problems) > MOST_SHOWN)
        message = f"{path}: {'; '.join(problems[:MOST_SHOWN])}{more}"
        raise StudyError(message)
    values = np.array([[float(cell) for cell in cells] for _, cells in body])
    return LoadFactors(names=tuple(header[1]), values=values)


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of each line."""
    try:
        text = file_text(path)
    except UnicodeDecodeError:
        reason = "it is no UTF-8 text"
    except OSError as error:
        reason = str(error.strerror)
    else:
        lines = [line.split("#", 1)[0] for line in text.splitlines()]
        for number, cells in csv_rows(path, lines):
            yield number, [cell.strip() for cell in cells]
        return
    message = f"cannot read load factors {path}: {reason}; give a csv file"
    raise StudyError(message)


def _names(names: Sequence[str], loads: Sequence[str]) -> Iterator[str]:
    """Say what is wrong with the names of the columns."""
    expected = f"a line of names first, '{ALL}' or {quoted(loads)}"
    if not names or all(_number(name) is not None for name in names):
        yield f"line 1: found {quoted(names) or 'nothing'}, expected {expected}"
        return
    for name, same in groupby(sorted(names)):
        if not name:
            yield f"a column has no name; expected {expected}"
        elif len(list(same)) > 1:
            yield f"column '{name}' is there twice; keep one"
    named = [load for load in loads if load in names]
    if ALL in names and named:
        yield f"found '{ALL}' and {quoted(named)}; give one factor for all loads, or one for each"
    missing = [load for load in loads if load not in names]
    if ALL not in names and missing and any(";" in name for name in names):
        yield "columns are separated by semicolons; separate them by commas, with decimal points"
    elif ALL not in names and missing:
        yield (
            f"no column for {quoted(missing)}; add it, or call the only column '{ALL}' to multiply "
            "all loads"
        )


def _lines(names: Sequence[str], body: Sequence[tuple[int, list[str]]]) -> Iterator[str]:
    """Say what is wrong with the numbers."""
    if not 1 <= len(body) <= MOST_LOADS:
        yield f"found {len(body)} increments, expected 1 to {MOST_LOADS}"
    for line, cells in body:
        if len(cells) != len(names):
            yield f"line {line}: found {len(cells)} cells, expected {len(names)} as in the first"
            continue
        for name, cell in zip(names, cells, strict=True):
            value = _number(cell)
            if not cell:
                yield f"line {line}: column '{name}' has a gap; give a factor"
            elif value is None or not abs(value) <= LARGEST:
                yield (
                    f"line {line}: column '{name}' has '{cell[:40]}', expected a number up to "
                    f"{LARGEST:g} in magnitude"
                )


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
