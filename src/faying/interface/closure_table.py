"""Curves of pressure over closure in csv files."""

from pathlib import Path

from faying.contact.laws import GasketClosure, TableClosure
from faying.exceptions import FormatError, ModelError
from faying.files.number_table import read_number_table

COLUMNS = {"table": ("closure", "pressure"), "gasket": ("closure", "pressure", "unloading")}
"""Columns of a file by the name of its curve, in the order of its parameters."""


def read_closure_table(path: str | Path, name: str = "table") -> TableClosure | GasketClosure:
    """Read a curve from a csv file with the columns ``closure,pressure``.

    Parameters
    ----------
    path
        File whose first line names the columns, in any order; lines that start with # are skipped.
    name
        ``"table"``, or ``"gasket"`` with a third column, ``unloading``.

    Raises
    ------
    FormatError
        If the file is missing, has other columns, or its rows do not form a curve.
    """
    columns = COLUMNS[name]
    table = read_number_table(Path(path), [columns], "the curve")
    values = [tuple(table.column(column).tolist()) for column in columns]
    try:
        return GasketClosure(*values) if name == "gasket" else TableClosure(*values)
    except ModelError as error:
        message = f"{path}: {error}"
        raise FormatError(message) from None
