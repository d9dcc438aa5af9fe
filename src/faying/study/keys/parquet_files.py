"""Tables in Parquet files, read with pyarrow."""

from pathlib import Path
from typing import Any

import numpy as np

from faying.display.facts import bulleted
from faying.exceptions import StudyError, refuse_study
from faying.files.contents import check_room, file_size
from faying.files.number_table import NumberTable


def pyarrow_for(what: str, otherwise: str) -> tuple[Any, Any]:
    """Return the modules pyarrow and pyarrow.parquet.

    If missing, the message states ``what`` needs them, and what to do ``otherwise``.
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


def parquet_table(path: Path, label: str) -> NumberTable:
    """Return the table of numbers in a file, with the names of its rows.

    The names are in the column ``label``.
    """
    arrow, parquet = pyarrow_for(path.name, "save the table as csv")
    try:
        check_room(file_size(path), path)
        size = parquet.read_metadata(path)
        # The numbers and one column as read: equal values may be packed into a few bytes.
        check_room(8 * size.num_rows * (size.num_columns + 3), path)
        header = [str(name) for name in size.schema.to_arrow_schema().names]
        file = parquet.ParquetFile(path, read_dictionary=[label] if label in header else None)
        twice = [name for number, name in enumerate(header) if name in header[:number]]
        if twice:
            refuse_study(f"{path.name}: column '{twice[0]}' occurs twice; keep one")
        read = file.read([label]).column(label) if label in header else None
        names = None if read is None else _names(path, label, read)
        numeric = [name for name in header if name != label]
        cells, wrong = np.empty((size.num_rows, len(numeric)), order="F"), []
        for number, name in enumerate(numeric):
            column, kinds = file.schema_arrow.field(name).type, arrow.types
            if not any(
                kind(column) for kind in (kinds.is_integer, kinds.is_floating, kinds.is_decimal)
            ):
                wrong.append(f"column '{name}' holds {column}")
                continue
            read = file.read([name]).column(name)
            cells[:, number] = read.cast(arrow.float64(), safe=False).to_numpy()
            bad = np.flatnonzero(~np.isfinite(cells[:, number]))
            wrong += [f"row {row + 1}: column '{name}' is empty or not finite" for row in bad[:1]]
    except (OSError, ValueError, arrow.ArrowException) as error:
        reason = (getattr(error, "strerror", None) or str(error)).splitlines()[0][:200]
        message = f"cannot read the loads {path}: {reason}; save it again as Parquet, or as csv"
        raise StudyError(message) from None
    if wrong:
        refuse_study(f"{path.name}: expected finite numbers\n{bulleted(wrong)}")
    return NumberTable(
        path=path,
        names=tuple(numeric),
        values=cells,
        lines=np.arange(1, len(cells) + 1),
        labels=names,
    )


def _names(path: Path, label: str, column: Any) -> tuple[str, ...]:
    if column.null_count:
        row = column.is_null().to_pylist().index(True)
        refuse_study(f"{path.name}, row {row + 1}: column '{label}' is empty; name it")
    cells: list[str] = []
    for chunk in column.chunks:
        # Repeated texts are stored once, as in the file.
        words = getattr(chunk, "dictionary", chunk).to_pylist()
        places = chunk.indices.to_pylist() if hasattr(chunk, "indices") else range(len(words))
        words = list(map(str, words))
        cells += [words[number] for number in places]
    return tuple(cells)
