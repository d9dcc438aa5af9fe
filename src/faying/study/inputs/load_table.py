"""Tables of loads: one row per static case, or per instant if there is a time column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import LARGEST
from faying.display.facts import bulleted
from faying.exceptions import refuse_study
from faying.files.contents import check_room
from faying.files.number_table import check_times, read_numbers
from faying.joint.system import Joint, boundary_slices, initial_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.study.keys.errors import nearest
from faying.study.keys.parquet_files import parquet_table
from faying.study.keys.section import LONGEST_NAME, MOST_PRELOAD_FACTOR

NAME = "case"
"""Column with the names of static cases; without it they are numbered from 1."""

TIME = "time"
"""Column of times, which makes a table a load over time."""

REPETITIONS = "repetitions"
"""Column with the occurrences of each static case in the life of the joint, for fatigue."""

FACTOR = "preload_factor"
"""Column with a factor on the initial forces of all bolts; ``.BOLT`` appended: of one bolt."""


@dataclass(frozen=True, kw_only=True)
class RowNumbers(Sequence[str]):
    """Row numbers from '1' as names, made on access to save memory."""

    n_row: int

    def __len__(self) -> int:
        return self.n_row

    def __getitem__(self, row: Any) -> Any:
        numbers = range(1, self.n_row + 1)[row]
        return str(numbers) if isinstance(numbers, int) else list(map(str, numbers))


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadTable:
    """A table of loads read from a file.

    Attributes
    ----------
    path
    names
        Names of the rows.
    columns
        Values (n_row,) by column name, without names and times.
    times : (n_row,) or None
    repetitions : (n_row,) or None
        Occurrences of each static case.
    """

    path: Path
    names: Sequence[str]
    columns: Mapping[str, Vector]
    times: Vector | None
    repetitions: Vector | None = None


def read_load_table(path: Path) -> LoadTable:
    """Read a csv file with a header line, or a Parquet file where pyarrow is installed."""
    parquet = path.suffix == ".parquet"
    table = parquet_table(path, NAME) if parquet else read_numbers(path, "the loads", label=NAME)
    names = table.labels
    if names is not None:
        _check_names(path, names)
    if not set(table.names) - {TIME, REPETITIONS} or not len(table.values):
        refuse_study(
            f"{path.name}: found {len(table.values)} rows of {', '.join(table.names) or 'nothing'};"
            " expected a header with columns of loads such as 'tip.Fz', and one row per load case "
            "or instant"
        )
    columns = dict(zip(table.names, np.ascontiguousarray(table.values.T), strict=True))
    _check_range(path, columns)
    times = columns.pop(TIME, None)
    if times is not None:
        check_times(path, times, lambda row: f"{path.name}, row {row + 1}", fewest=2)
    repeated = columns.pop(REPETITIONS, None)
    if repeated is not None:
        _check_repetitions(path, repeated, timed=times is not None)
    rows = names or RowNumbers(n_row=len(table.values))
    return LoadTable(path=path, names=rows, columns=columns, times=times, repetitions=repeated)


def table_inputs(table: LoadTable, joint: Joint) -> Matrix:
    """Return the inputs (n_row, n_input) of the static cases of a table."""
    factors = [FACTOR, *(f"{FACTOR}.{name}" for name in joint.bolts)] if joint.bolts else []
    targets = [*force_columns(joint), *factors]
    wrong = [
        f"no column '{name}'; {nearest(name, targets)}"
        for name in table.columns
        if name not in targets
    ]
    if wrong:
        refuse_study(f"{table.path.name}: columns without a load of the model\n{bulleted(wrong)}")
    places = boundary_slices(joint.boundaries)
    n_boundary = sum(len(boundary.dofs) for boundary in joint.boundaries.values())
    bolts, patterns = list(joint.bolts), list(joint.load_patterns)
    first = n_boundary + len(bolts)
    shape = len(table.names), first + len(patterns)
    check_room(8 * shape[0] * shape[1], table.path)
    inputs = np.zeros(shape)
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
            for column in np.flatnonzero(pattern):  # tables have millions of rows
                inputs[:, places[owner].start + column] += values * pattern[column]
        elif name != FACTOR:
            _check_factors(table, name)
            bolt = bolts.index(name.removeprefix(f"{FACTOR}."))
            inputs[:, n_boundary + bolt] = values * locked[bolt]
    return inputs


def force_columns(joint: Joint) -> list[str]:
    """Return the column names of boundary components, and of loads of the deck."""
    forces = [
        f"{name}.{FORCE_NAMES[component]}"
        for name, boundary in joint.boundaries.items()
        for component in sorted(set(boundary.components.tolist()))
    ]
    return [*forces, *joint.load_patterns]


def _check_factors(table: LoadTable, name: str) -> None:
    """Refuse preload factors out of range."""
    values = table.columns[name]
    wrong = np.flatnonzero(~((values >= 0) & (values <= MOST_PRELOAD_FACTOR)))
    if wrong.size:
        refuse_study(
            f"{table.path.name}, row {wrong[0] + 1}: column '{name}' has {values[wrong[0]]:g}, "
            f"expected a factor from 0 to {MOST_PRELOAD_FACTOR:g} on the initial bolt force; "
            "divide the intended force by the preload of the study"
        )


def _check_range(path: Path, columns: Mapping[str, Vector]) -> None:
    """Refuse numbers so large that products may overflow."""
    for name, values in columns.items():
        large = np.flatnonzero(np.abs(values) > LARGEST)
        if large.size:
            refuse_study(
                f"{path.name}, row {large[0] + 1}: column '{name}' has {values[large[0]]:g}, "
                f"expected a magnitude up to {LARGEST:g}; correct it or use other units"
            )


def _check_names(path: Path, names: Sequence[str]) -> None:
    """Refuse names that are not printable, too long or not unique."""
    for row, name in enumerate(names, start=1):
        if not name.isprintable() or len(name) > LONGEST_NAME:
            refuse_study(
                f"{path.name}, row {row}: the name {name[:40]!a} has {len(name)} characters, "
                f"expected at most {LONGEST_NAME} printable ones; change it"
            )
    if len(set(names)) < len(names):
        in_order = sorted(names)
        twice = next(earlier for earlier, later in pairwise(in_order) if earlier == later)
        refuse_study(f"{path.name}: two rows have the name '{twice}'; names of cases must differ")


def _check_repetitions(path: Path, repeated: Vector, *, timed: bool) -> None:
    wrong = np.flatnonzero(repeated < 0)
    if timed or wrong.size:
        found = "this table is one load over time"
        if wrong.size:
            found = f"row {wrong[0] + 1} has {repeated[wrong[0]]:g}"
        refuse_study(
            f"{path.name}: column '{REPETITIONS}' counts occurrences of static cases, but {found}; "
            "give 0 or more for static cases; loads over time have 'repetitions' in a TOML file"
        )
