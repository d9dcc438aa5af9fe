"""Frequency responses of a run as csv files that other programs read."""

from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path

import numpy as np

from faying.assessment.response_curve import ResponseCurve
from faying.files.csv_rows import write_rows
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.metric_table import DIGITS

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
)
"""Columns of ``peaks.csv``: a row for each level."""


def write_frequency_tables(records: Mapping[str, FrequencyRecord], folder: Path) -> None:
    """Write ``frf.csv`` and ``peaks.csv`` of a run, atomically; nothing without harmonic loads.

    Phases are in degrees against the load, energies those of a period; frequencies expected are
    those of the backbone.

    Raises
    ------
    FormatError
        If a file cannot be written.
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
        rubbed, damped = level.there("friction_energy"), level.there("damping_energy")
        damping: tuple[object, object] = "", ""
        if rubbed is not None and damped is not None:
            lost = rubbed + damped
            damping = level.there("damping_ratio"), rubbed / lost if lost > 0 else 0.0
        expected_values = ("", "") if expected is None else (expected.frequency, expected.amplitude)
        motion = (peak.frequency, peak.amplitude, peak.phase)
        yield name, peak.level, record.at, *motion, *damping, *expected_values
