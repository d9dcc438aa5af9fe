"""Where curves under harmonic loads peak, as a table of the report."""

from collections.abc import Callable
from typing import Any

import numpy as np

from faying.display.quantities import number
from faying.report.table import PRESSURE, Column, Table, described
from faying.study.results.values import Results


def peak_table(results: Results) -> Table:
    """Return the peak of each level, what contact does there, and what the backbone expected."""
    peaks = {
        f"{name}, level {number(level.peak.level)}": (record.at, level)
        for name, record in results.frequencies.items()
        for level in record.peaks()
    }

    def percent_of(name: str) -> Callable[[Any], float | None]:
        return lambda row: None if (share := row[1].there(name)) is None else 100 * share

    columns = (
        Column("of", lambda row: row[0]),
        Column("peak at", lambda row: row[1].peak.frequency, "1/time", 5),
        Column("amplitude", lambda row: row[1].peak.amplitude, "length"),
        Column("damping ratio", percent_of("damping_ratio"), "%", 3),
        Column("slipping area", percent_of("slip_share"), "%", 3),
        Column("opened", percent_of("open_share"), "%", 3),
        Column("largest pressure", lambda row: row[1].there("peak_pressure"), PRESSURE),
        Column(
            "peak by the backbone",
            lambda row: row[1].expected and row[1].expected.frequency,
            "1/time",
            5,
        ),
        Column(
            "amplitude by it", lambda row: row[1].expected and row[1].expected.amplitude, "length"
        ),
    )
    return described("peak", peaks.items(), columns, results.unit_set)


def measured_table(results: Results) -> Table:
    """Return peaks of a test, and how far computed ones are from them."""
    compared = [pair for record in results.frequencies.values() for pair in record.compared()]

    def off(field: str) -> Callable[[Any], float | None]:
        def of(pairs: Any) -> float | None:
            measured, computed = pairs[field]
            error = 100 * (computed / measured - 1)
            return error if np.isfinite(error) else None

        return of

    columns = (
        Column("measured peak at", lambda pairs: pairs["frequency"][0], "1/time", 5),
        Column("off by", off("frequency"), "%", 3),
        Column("measured amplitude", lambda pairs: pairs["amplitude"][0], "length"),
        Column("amplitude off by", off("amplitude"), "%", 3),
        Column("measured damping ratio", lambda pairs: 100 * pairs["damping_ratio"][0], "%", 3),
        Column("damping ratio off by", off("damping_ratio"), "%", 3),
    )
    return described("test", compared, columns, results.unit_set)
