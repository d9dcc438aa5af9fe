"""Load histories: two columns of a csv file, time and value."""

from pathlib import Path

from faying.files.number_table import check_times, read_numbers
from faying.simulation.load import History
from faying.study.keys.ranges import LARGEST


def read_history(path: Path) -> History:
    """Read a load history: text with two columns separated by a comma, time and value.

    One header line, empty lines and comments after ``#`` are allowed.

    Raises
    ------
    FormatError
        If it cannot be read, or times do not increase; the message names the line.
    """
    columns = ("time", "value")
    table = read_numbers(path, "the load history", unnamed=columns, largest=LARGEST)
    times, values = table.values.T
    check_times(path, times, table.place, fewest=2)
    return History(times=times, values=values)
