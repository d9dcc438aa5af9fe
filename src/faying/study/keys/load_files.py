"""Csv files of load cases: histories over time, and load factors of a path."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from faying.digits import LARGEST
from faying.exceptions import refuse
from faying.files.number_table import NumberTable, check_times, read_numbers
from faying.simulation.load import History
from faying.study.keys.errors import quoted
from faying.study.keys.section import LARGEST_COUNT


def read_history(path: Path) -> History:
    """Read a load history: text with two columns separated by a comma, time and value.

    One header line, empty lines and comments after ``#`` are allowed.
    """
    columns = ("time", "value")
    table = read_numbers(path, "the load history", unnamed=columns, largest=LARGEST)
    times, values = table.values.T
    check_times(path, times, table.place, fewest=2)
    return History(times=times, values=values)


ALL = "factor"
"""Name of the column that multiplies all loads of a case."""


def read_load_factors(path: Path, loads: Sequence[str]) -> NumberTable:
    """Read the load factors of a path.

    The file has a line of column names, then a line of numbers for each increment. Empty
    lines and comments after ``#`` are allowed. Each load of the case has a column, unless a
    column ``factor`` multiplies all loads. Other columns are factors on initial forces of
    bolts.
    """
    table = read_numbers(path, "load factors", largest=LARGEST)
    problems = list(_problems(table, loads))
    if problems:
        refuse(f"{path}: {'; '.join(problems)}")
    return table


def _problems(table: NumberTable, loads: Sequence[str]) -> Iterator[str]:
    """Yield loads without a factor or with two, and a wrong number of increments."""
    present = [load for load in loads if load in table.names]
    missing = [load for load in loads if load not in table.names]
    if "" in table.names:
        yield f"a column has no name; name it '{ALL}' or one of {quoted(loads)}"
    if ALL in table.names and present:
        yield f"found '{ALL}' and {quoted(present)}; give one factor for all loads, or each its own"
    elif ALL not in table.names and missing:
        yield (
            f"no column for {quoted(missing)}; add it, or call the only column '{ALL}' to multiply "
            "all loads"
        )
    if not 1 <= len(table.values) <= LARGEST_COUNT:
        yield f"found {len(table.values)} increments, expected 1 to {LARGEST_COUNT}"
