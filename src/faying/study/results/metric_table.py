"""Metrics of many load cases as a table that other programs read: csv, or Parquet."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from faying._typing import Matrix
from faying.assessment.case_metrics import Metric
from faying.files.atomic import replacing
from faying.study.keys.parquet_files import pyarrow_for
from faying.units import Units

TableFormat = Literal["csv", "parquet"]

DIGITS = "%.16g"
"""Fifteen digits are certain, and the sixteenth keeps comparisons at 1e-15."""

Rows = Iterable[tuple[Sequence[str], Matrix]]
"""Pieces of the table: labels of the rows, and their metrics."""


def write_metrics(
    path: Path, label: str, metrics: Sequence[Metric], rows: Rows, units: Units
) -> None:
    """Write a table atomically, a piece at a time.

    Parameters
    ----------
    path
        Its ending says which format.
    label
        Name of the first column.

    Raises
    ------
    FormatError
        If it cannot be written.
    StudyError
        If Parquet is asked for without pyarrow.
    """
    writer: Callable[..., None] = _parquet if path.suffix == ".parquet" else _csv
    with replacing(path) as temporary:
        writer(temporary, label, metrics, rows, units)


def check_table_format(name: TableFormat) -> None:
    """Refuse Parquet where pyarrow is not installed.

    Raises
    ------
    StudyError
    """
    if name == "parquet":
        pyarrow_for("--table parquet", "take csv")


def _csv(path: Path, label: str, metrics: Sequence[Metric], rows: Rows, _: Units) -> None:
    header = [label, *(label_text.name for label_text in metrics)]
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(map(_quoted, header)) + "\n")
        for labels, values in rows:
            names = np.array([_quoted(label_text) for label_text in labels], dtype=object)
            table = np.column_stack([names, values.astype(object)])
            np.savetxt(file, table, fmt=["%s", *[DIGITS] * len(metrics)], delimiter=",")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"#') else text


def _parquet(path: Path, label: str, metrics: Sequence[Metric], rows: Rows, units: Units) -> None:
    arrow, parquet = pyarrow_for(path.name, "take csv")
    columns = [
        arrow.field(
            metric.name,
            arrow.float64(),
            metadata={"unit": units.of(metric.dimension), "description": metric.description},
        )
        for metric in metrics
    ]
    schema = arrow.schema([arrow.field(label, arrow.string()), *columns])
    with parquet.ParquetWriter(path, schema) as file:
        for labels, values in rows:
            arrays = [arrow.array(list(labels)), *map(arrow.array, np.asarray(values).T.copy())]
            file.write_table(arrow.table(arrays, schema=schema))
