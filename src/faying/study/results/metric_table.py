"""Tables for other programs: metrics of load cases, and responses over frequency."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Literal

import numpy as np

from faying._typing import Matrix
from faying.assessment.case_metrics import Metric
from faying.assessment.response_curve import ResponseCurve
from faying.files.atomic import replacing
from faying.files.csv_rows import write_rows
from faying.study.keys.parquet_files import pyarrow_for
from faying.study.results.frequency_record import FrequencyRecord
from faying.units import Units

TableFormat = Literal["csv", "parquet"]

DIGITS = "%.16g"
"""Sixteen digits, so that comparisons at 1e-15 are possible."""

Rows = Iterable[tuple[Sequence[str], Matrix]]
"""Pieces of the table: labels of the rows, and their metrics."""


def write_metrics(
    path: Path, label: str, metrics: Sequence[Metric], rows: Rows, units: Units
) -> None:
    """Write a table atomically, a piece at a time, in the format of the path's suffix.

    ``label`` is the name of the first column.
    """
    if path.suffix == ".parquet":
        with replacing(path) as temporary:
            _write_parquet(temporary, label, metrics, rows, units)
        return
    header = [label, *(metric.name for metric in metrics)]
    cells = (
        [name, *row]
        for names, table in rows
        for name, row in zip(names, table.tolist(), strict=True)
    )
    write_rows(path, chain([header], cells), DIGITS)


def check_table_format(name: TableFormat) -> None:
    """Refuse Parquet where pyarrow is not installed."""
    if name == "parquet":
        pyarrow_for("--table parquet", "use csv")


def _write_parquet(
    path: Path, label: str, metrics: Sequence[Metric], rows: Rows, units: Units
) -> None:
    arrow, parquet = pyarrow_for(path.name, "use csv")
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


RESPONSES = (
    "name",
    "level",
    "frequency",
    "component",
    "harmonic",
    "amplitude",
    "phase",
    "load_work",
    "damping_energy",
    "friction_energy",
    "swept_up",
    "swept_down",
)
"""Columns of ``frf.csv``: a row for each point of a curve, component and harmonic."""

PEAKS = (
    "name",
    "level",
    "component",
    "frequency",
    "amplitude",
    "phase",
    "damping_ratio",
    "friction_share",
    "expected_frequency",
    "expected_amplitude",
    "at_end",
)
"""Columns of ``peaks.csv``: a row for each level."""


def write_frequency_tables(records: Mapping[str, FrequencyRecord], folder: Path) -> None:
    """Write ``frf.csv`` and ``peaks.csv`` of a run, atomically; nothing without harmonic loads.

    Phases are in degrees against the load, energies per period; expected frequencies are from
    the backbone.
    """
    if not records:
        return
    curves = ((name, curve) for name, record in records.items() for curve in record.response.curves)
    responses = (row for pair in curves for row in _responses(*pair))
    write_rows(folder / "frf.csv", chain([RESPONSES], responses), DIGITS)
    peaks = (row for name, record in records.items() for row in _peaks(name, record))
    write_rows(folder / "peaks.csv", chain([PEAKS], peaks), DIGITS)


def _responses(name: str, curve: ResponseCurve) -> Iterator[tuple[object, ...]]:
    up, down, contact = curve.swept_up, curve.swept_down, curve.contact
    for row, frequency in enumerate(curve.frequency.tolist()):
        energies = (
            ("", "", "")
            if contact is None
            else tuple(
                float(values[row])
                for values in (contact.load_work, contact.damping_energy, contact.friction_energy)
            )
        )
        for number, component in enumerate(curve.components):
            for order, value in enumerate(curve.harmonics[row, :, number].tolist()):
                size, phase = float(abs(value)), float(np.angle(value, deg=True))
                swept = (int(up[row]), int(down[row]))
                yield name, curve.level, frequency, component, order, size, phase, *energies, *swept


def _peaks(name: str, record: FrequencyRecord) -> Iterator[tuple[object, ...]]:
    for level in record.peaks():
        peak, expected = level.peak, level.expected
        slid, damped = level.there("friction_energy"), level.there("damping_energy")
        damping: tuple[object, object] = "", ""
        if slid is not None and damped is not None:
            lost = slid + damped
            damping = level.there("damping_ratio"), slid / lost if lost > 0 else 0.0
        expected_values = ("", "") if expected is None else (expected.frequency, expected.amplitude)
        motion = (peak.frequency, peak.amplitude, peak.phase)
        yield name, peak.level, record.at, *motion, *damping, *expected_values, int(peak.at_end)
