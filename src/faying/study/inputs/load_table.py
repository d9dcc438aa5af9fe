"""Tables of loads: one row per static case, or one row per instant where there is a time column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import overload

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import StudyError
from faying.files.contents import check_room, file_text
from faying.files.csv_rows import csv_rows
from faying.joint.system import Joint, boundary_slices, initial_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.study.keys.errors import MOST_SHOWN, nearest
from faying.study.keys.parquet_files import parquet_cells
from faying.study.keys.ranges import LARGEST, LONGEST_NAME, MOST_PRELOAD_FACTOR

NAME = "case"
"""Column with the names of static cases; without it they are numbered from 1."""

TIME = "time"
"""Column that makes a table one history."""

FACTOR = "preload_factor"
"""Factor on the initial forces of all bolts, or with a bolt's name behind a dot of that one."""

OLD_FACTOR = "preload"
"""What it was called, and still may be: the name of a force in studies."""


@dataclass(frozen=True, kw_only=True)
class RowNumbers(Sequence[str]):
    """Names '1', '2' and so on of rows that have none; texts of millions would outweigh a table."""

    n_row: int

    def __len__(self) -> int:
        return self.n_row

    @overload
    def __getitem__(self, place: int) -> str: ...
    @overload
    def __getitem__(self, place: slice) -> list[str]: ...
    def __getitem__(self, place: int | slice) -> str | list[str]:
        numbers = range(1, self.n_row + 1)[place]
        return str(numbers) if isinstance(numbers, int) else list(map(str, numbers))


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadTable:
    """A table as read.

    Attributes
    ----------
    path
    names
        Of the rows.
    columns
        Name to values (n_row,), names and times left out.
    times : (n_row,) or None
    """

    path: Path
    names: Sequence[str]
    columns: Mapping[str, Vector]
    times: Vector | None

    @property
    def n_row(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values())))


def read_load_table(path: Path) -> LoadTable:
    """Read a csv file with a header line, or a Parquet file where pyarrow is installed.

    Raises
    ------
    StudyError
        If it cannot be read; the message names the line and the column.
    """
    header, cells, names = parquet_cells(path, NAME) if path.suffix == ".parquet" else _csv(path)
    if names is not None:
        _check_names(path, names)
    numeric = [name for name in header if name != NAME]
    if not set(numeric) - {TIME} or not len(cells):
        message = (
            f"{path.name}: found {len(cells)} rows of {', '.join(header) or 'nothing'}; expected "
            "a header with columns of loads such as 'tip.Fz', and one row per load case or instant"
        )
        raise StudyError(message)
    columns = dict(zip(numeric, np.ascontiguousarray(cells.T), strict=True))
    _check_range(path, columns)
    times = columns.pop(TIME, None)
    if times is not None:
        _check_times(path, times)
    rows = names or RowNumbers(n_row=len(cells))
    return LoadTable(path=path, names=rows, columns=columns, times=times)


def renamed_factors(table: LoadTable, joint: Joint) -> tuple[LoadTable, str]:
    """Return a table with the present names of preload factors, and what is to be said of it."""
    old = {OLD_FACTOR: FACTOR} | {f"{OLD_FACTOR}.{n}": f"{FACTOR}.{n}" for n in joint.bolts}
    there = [name for name in table.columns if name in old and name not in _force_columns(joint)]
    if not there:
        return table, ""
    said = (
        f"{table.path.name}: column '{there[0]}' is a factor on the initial force of bolts, not a "
        f"force; call it '{old[there[0]]}', the old name will go"
    )
    columns = {old.get(name, name): values for name, values in table.columns.items()}
    if len(columns) < len(table.columns):
        message = f"{table.path.name}: '{there[0]}' and '{old[there[0]]}' are the same; keep one"
        raise StudyError(message)
    return replace(table, columns=columns), said


def table_inputs(table: LoadTable, joint: Joint) -> Matrix:
    """Return the inputs (n_row, n_input) of the static cases of a table, as those of a load.

    Raises
    ------
    StudyError
        If columns are of nothing that the joint has, all of which are listed; or a preload factor
        is none.
    """
    targets = known_columns(joint)
    wrong = [
        f"no column '{name}'; {nearest(name, targets)}"
        for name in table.columns
        if name not in targets
    ]
    if wrong:
        listed = "\n".join(f"  - {text}" for text in wrong[:MOST_SHOWN])
        message = f"{table.path.name}: columns that the model does not have\n{listed}"
        raise StudyError(message)
    places = boundary_slices(joint.boundaries)
    n_boundary = sum(len(boundary.dofs) for boundary in joint.boundaries.values())
    bolts, patterns = list(joint.bolts), list(joint.load_patterns)
    first = n_boundary + len(bolts)
    check_room(table.n_row * 8 * (first + len(patterns)), table.path)
    inputs = np.zeros((table.n_row, first + len(patterns)))
    locked = initial_bolt_forces(joint)
    inputs[:, n_boundary:first] = locked
    if FACTOR in table.columns:
        _check_factors(table, FACTOR)
        inputs[:, n_boundary:first] *= table.columns[FACTOR][:, None]
    for name, values in table.columns.items():
        owner, _, part = name.rpartition(".")
        if name in patterns:
            inputs[:, first + patterns.index(name)] = values
        elif owner in places:
            pattern = joint.boundaries[owner].pattern(part)
            for column in np.flatnonzero(pattern):  # one at a time: tables have millions of rows
                inputs[:, places[owner].start + column] += values * pattern[column]
        elif name != FACTOR:
            _check_factors(table, name)
            bolt = bolts.index(name.removeprefix(f"{FACTOR}."))
            inputs[:, n_boundary + bolt] = values * locked[bolt]
    return inputs


def known_columns(joint: Joint) -> list[str]:
    """Return the columns of loads that a table for a joint may have."""
    factors = [FACTOR, *(f"{FACTOR}.{name}" for name in joint.bolts)] if joint.bolts else []
    return [*_force_columns(joint), *factors]


def _force_columns(joint: Joint) -> list[str]:
    forces = [
        f"{name}.{FORCE_NAMES[component]}"
        for name, boundary in joint.boundaries.items()
        for component in sorted(set(boundary.components.tolist()))
    ]
    return [*forces, *joint.load_patterns]


def _check_factors(table: LoadTable, name: str) -> None:
    """Refuse preload factors that are none."""
    values = table.columns[name]
    wrong = np.flatnonzero(~((values >= 0) & (values <= MOST_PRELOAD_FACTOR)))
    if wrong.size:
        message = (
            f"{table.path.name}, row {wrong[0] + 1}: column '{name}' has {values[wrong[0]]:g}, "
            f"expected a factor from 0 to {MOST_PRELOAD_FACTOR:g} on the initial force of bolts; "
            "divide the force that is meant by the preload of the study"
        )
        raise StudyError(message)


def _csv(path: Path) -> tuple[list[str], Matrix, tuple[str, ...] | None]:
    lines = _lines(path)
    if not lines:
        return [], np.empty((0, 0)), None
    header = _cells(path, *lines[0])
    _check_header(path, header)
    rows = [line for _, line in lines[1:]]
    _check_width(path, lines, len(header))
    numeric = [position for position, name in enumerate(header) if name != NAME]
    if not rows or not numeric:
        return header, np.empty((0, len(numeric))), None
    try:
        cells = np.loadtxt(
            rows, delimiter=",", usecols=numeric, ndmin=2, quotechar='"', comments=None
        )
    except ValueError:
        raise _bad_cells(path, header, lines[1:], numeric) from None
    if not np.isfinite(cells).all():
        raise _bad_cells(path, header, lines[1:], numeric)
    if NAME not in header:
        return header, cells, None
    column = header.index(NAME)
    names = np.loadtxt(
        rows, delimiter=",", usecols=[column], dtype=str, ndmin=1, quotechar='"', comments=None
    )
    return header, cells, tuple(map(str.strip, names.tolist()))


def _lines(path: Path) -> list[tuple[int, str]]:
    """Return the lines that are not empty, with their numbers."""
    try:
        text = file_text(path)
    except UnicodeDecodeError:
        message = f"cannot read the loads {path}: it is no UTF-8 text; save it as csv in UTF-8"
        raise StudyError(message) from None
    except OSError as error:
        message = f"cannot read the loads {path}: {error.strerror}; check the path"
        raise StudyError(message) from None
    numbered = enumerate(map(str.strip, text.splitlines()), start=1)
    return [(number, line) for number, line in numbered if line and not line.startswith("#")]


def _cells(path: Path, number: int, line: str) -> list[str]:
    """Split a line; commas within quotes belong to a name."""
    quoted = '"' in line
    cells = next(csv_rows(path, [line], first=number))[1] if quoted else line.split(",")
    return [cell.strip() for cell in cells]


def _check_header(path: Path, header: Sequence[str]) -> None:
    twice = [name for column, name in enumerate(header) if name in header[:column]]
    if twice:
        message = f"{path.name}, line 1: column '{twice[0]}' is there twice; keep one"
        raise StudyError(message)
    if all(_is_number(cell) for cell in header):
        message = (
            f"{path.name}, line 1: found numbers, expected the names of the columns, such as "
            "'tip.Fz'; add a header line"
        )
        raise StudyError(message)


def _check_width(path: Path, lines: Sequence[tuple[int, str]], expected: int) -> None:
    wrong = [(n, line) for n, line in lines[1:] if len(_cells(path, n, line)) != expected]
    if wrong:
        width = len(_cells(path, *wrong[0]))
        message = (
            f"{path.name}, line {wrong[0][0]}: found {width} cells, expected {expected} as in the "
            "header; separate them by commas and write decimal points"
        )
        raise StudyError(message)


def _bad_cells(
    path: Path, header: Sequence[str], lines: Sequence[tuple[int, str]], numeric: Sequence[int]
) -> StudyError:
    """Return the message that lists cells that are no finite numbers."""
    wrong = [
        f"  - line {number}: found '{cell[:40]}' in column '{header[column]}'"
        for number, line in lines
        for column, cell in enumerate(_cells(path, number, line))
        if column in numeric and not _is_number(cell)
    ]
    listed = "\n".join(wrong[:MOST_SHOWN])
    more = f"\n  ... and {len(wrong) - MOST_SHOWN} more" if len(wrong) > MOST_SHOWN else ""
    return StudyError(f"{path.name}: expected finite numbers\n{listed}{more}")


def _is_number(cell: str) -> bool:
    try:
        # Python also takes 1_000 and the digits of other scripts.
        return bool(np.isfinite(float(cell))) and cell.isascii() and "_" not in cell
    except ValueError:
        return False


def _check_range(path: Path, columns: Mapping[str, Vector]) -> None:
    """Refuse numbers whose products with others overflow."""
    for name, values in columns.items():
        large = np.flatnonzero(np.abs(values) > LARGEST)
        if large.size:
            message = (
                f"{path.name}, row {large[0] + 1}: column '{name}' has {values[large[0]]:g}, "
                f"expected a magnitude up to {LARGEST:g}; correct it or use other units"
            )
            raise StudyError(message)


def _check_names(path: Path, names: Sequence[str]) -> None:
    """Refuse names that cannot be shown, or that two rows have."""
    for row, name in enumerate(names, start=1):
        if not name.isprintable() or len(name) > LONGEST_NAME:
            message = (
                f"{path.name}, row {row}: the name {name[:40]!a} has {len(name)} characters, "
                f"expected at most {LONGEST_NAME}, all of which can be shown; change it"
            )
            raise StudyError(message)
    if len(set(names)) < len(names):
        in_order = sorted(names)
        twice = next(earlier for earlier, later in pairwise(in_order) if earlier == later)
        message = f"{path.name}: two rows have the name '{twice}'; names of cases must differ"
        raise StudyError(message)


def _check_times(path: Path, times: Vector) -> None:
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(times) < 2 or times[0] < 0 or back.size:
        row = int(back[0]) + 2 if back.size else 1
        message = (
            f"{path.name}, row {row}: the column '{TIME}' must have two or more values, begin at 0 "
            "or later, and increase"
        )
        raise StudyError(message)
