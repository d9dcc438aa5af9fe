"""Figures of harmonic loads for ``summary.json``."""

from dataclasses import asdict
from typing import Any

import numpy as np

from faying.study.results.frequency_record import FrequencyRecord, LevelPeak

AT_THE_PEAK = ("damping_ratio", "friction_energy", "load_work")
"""Contact quantities at the peak; other contact quantities are extremes over the curve."""


def frequency_figures(record: FrequencyRecord) -> dict[str, Any]:
    """Return the peaks of a harmonic load, its checks and remarks."""
    expected = record.expected
    return {
        "component": record.at,
        "seconds": record.seconds,
        "levels": [_level(peak) for peak in record.peaks()],
        "measured": {
            name: {
                field: value if np.isfinite(value) else None
                for quantity, (measured, computed) in pairs.items()
                for field, value in (
                    (quantity, measured),
                    (f"computed_{quantity}", computed),
                    (f"{quantity}_error", computed / measured - 1),
                )
            }
            for name, pairs in record.compared()
        },
        "remarks": list(record.response.remarks),
        "expected_remarks": [] if expected is None else list(expected.remarks),
        "checks": [
            {
                "level": check.level,
                "frequency": check.frequency,
                "amplitude_difference": check.difference,
                "phase_difference": check.turn,
                "periods": check.periods,
                "to_come": check.to_come,
                "agrees": check.agrees,
                "sentence": check.sentence,
            }
            for check in record.checks
        ],
    }


def _level(level: LevelPeak) -> dict[str, Any]:
    curve, peak, expected, contact = level.curve, level.peak, level.expected, level.curve.contact
    figures: dict[str, Any] = {
        **asdict(peak),
        "points": len(curve.frequency),
        "missed": len(curve.missed),
        "harmonics": curve.harmonics.shape[1] - 1,
        "expected_frequency": None if expected is None else expected.frequency,
        "expected_amplitude": None if expected is None else expected.amplitude,
    }
    if contact is not None:
        figures |= {
            **{name: level.there(name) for name in AT_THE_PEAK},
            "max_imbalance": float(np.abs(contact.imbalance).max()),
            "max_pressure": float(contact.peak_pressure.max()),
            "stick_fraction": float(contact.stick_share.min()),
            "slip_fraction": float(contact.slip_share.max()),
            "open_fraction": float(contact.open_share.max()),
            "bolt_force_range": contact.bolt_force_range.max(axis=0, initial=0.0).tolist(),
        }
    return figures
