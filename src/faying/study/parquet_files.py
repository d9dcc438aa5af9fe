"""Tables in Parquet files, where pyarrow is installed."""

from pathlib import Path
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.exceptions import StudyError
from faying.files.contents import check_room, file_size
from faying.study.errors import MOST_SHOWN


def pyarrow_for(what: str, otherwise: str) -> tuple[Any, Any]:
    """Return the modules pyarrow and pyarrow.parquet.

    Parameters
    ----------
    what, otherwise
        What needs them, and what to do in place of installing them.

    Raises
    ------
    StudyError
        If they are not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        message = (
            f"{what} needs pyarrow, which is not installed; pip install 'faying[parquet]', or "
            f"{otherwise}"
        )
        raise StudyError(message) from None
    return pyarrow, pyarrow.parquet


def parquet_cells(path: Path, label: str) -> tuple[list[str], Matrix, tuple[str, ...] | None]:
    """Return the names of the columns, the numbers (n_row, n_column), and the names of the rows.

    Parameters
    ----------
    path
    label
        Column with the names of the rows, which is no column of numbers.

    Raises
    ------
    StudyError
        If it cannot be read or a column holds anything but finite numbers; all are listed.
    """
    arrow, parquet = pyarrow_for(path.name, "save the table as csv")
    try:
        check_room(file_size(path), path)
        size = parquet.read_metadata(path)
        check_room(8 * size.num_rows * size.num_columns, path)
        table = parquet.read_table(path)
        header = [str(name) for name in table.column_names]
        names = _names(path, table, label)
    except (OSError, UnicodeDecodeError, arrow.ArrowException) as error:
        reason = (getattr(error, "strerror", None) or str(error)).splitlines()[0][:200]
        message = f"cannot read the loads {path}: {reason}; save it again as Parquet, or as csv"
        raise StudyError(message) from None
    twice = [name for place, name in enumerate(header) if name in header[:place]]
    if twice:
        message = f"{path.name}: column '{twice[0]}' is there twice; keep one"
        raise StudyError(message)
    numeric = [name for name in header if name != label]
    cells, wrong = np.empty((table.num_rows, len(numeric)), order="F"), []
    for place, name in enumerate(numeric):
        column, kinds = table.column(name), arrow.types
        if not any(
            kind(column.type) for kind in (kinds.is_integer, kinds.is_floating, kinds.is_decimal)
        ):
            wrong.append(f"column '{name}' holds {column.type}")
            continue
        cells[:, place] = column.cast(arrow.float64(), safe=False).to_numpy()
        bad = np.flatnonzero(~np.isfinite(cells[:, place]))
        wrong += [f"row {row + 1}: column '{name}' is empty or not finite" for row in bad[:1]]
    if wrong:
        listed = "\n".join(f"  - {text}" for text in wrong[:MOST_SHOWN])
        message = f"{path.name}: expected finite numbers\n{listed}"
        raise StudyError(message)
    return header, cells, names


def _names(path: Path, table: Any, label: str) -> tuple[str, ...] | None:
    if label not in table.column_names:
        return None
    names = table.column(label).to_pylist()
    if None in names:
        message = f"{path.name}, row {names.index(None) + 1}: column '{label}' is empty; name it"
        raise StudyError(message)
    return tuple(map(str, names))
