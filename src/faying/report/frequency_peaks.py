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
        f"{name}, level {number(peak.level)}": (record, curve, peak, expected)
        for name, record in results.frequencies.items()
        for curve, peak, expected in record.peaks()
    }

    def contact(field: str) -> Callable[[Any], float | None]:
        def at_peak(row: Any) -> float | None:
            record, curve, _, _ = row
            top = int(np.argmax(np.abs(curve.response(record.at))))
            contact_there = curve.contact
            return None if contact_there is None else float(getattr(contact_there, field)[top])

        return at_peak

    def percent_of(field: str) -> Callable[[Any], float | None]:
        value = contact(field)
        return lambda row: None if (share := value(row)) is None else 100 * share

    columns = (
        Column("of", lambda row: row[0].at),
        Column("peak at", lambda row: row[2].frequency, "1/time", 5),
        Column("amplitude", lambda row: row[2].amplitude, "length"),
        Column("damping ratio", percent_of("damping_ratio"), "%", 3),
        Column("slipping area", percent_of("slip_share"), "%", 3),
        Column("opened", percent_of("open_share"), "%", 3),
        Column("largest pressure", contact("peak_pressure"), PRESSURE),
        Column("peak by the backbone", lambda row: row[3] and row[3].frequency, "1/time", 5),
        Column("amplitude by it", lambda row: row[3] and row[3].amplitude, "length"),
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
