"""Curves of pressure over closure from csv files."""

from pathlib import Path

from faying.contact.laws import TableClosure
from faying.exceptions import FormatError, ModelError
from faying.files.number_table import read_number_table

COLUMNS = ("closure", "pressure")


def read_closure_table(path: str | Path) -> TableClosure:
    """Read a curve from a csv file with the columns ``closure,pressure``.

    Parameters
    ----------
    path
        First line names the columns, in any order; lines that start with # are skipped.

    Raises
    ------
    FormatError
        If the file is missing, has other columns, or its rows are no curve.
    """
    header, rows = read_number_table(Path(path), [COLUMNS], "the curve")
    closures, pressures = (tuple(rows[:, header.index(name)].tolist()) for name in COLUMNS)
    try:
        return TableClosure(closures, pressures)
    except ModelError as error:
        message = f"{path}: {error}"
        raise FormatError(message) from None
