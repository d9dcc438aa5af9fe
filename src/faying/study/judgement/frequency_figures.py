"""Harmonic loads as they stand in ``summary.json``."""

from typing import Any

import numpy as np

from faying.assessment.response_curve import Peak, ResponseCurve
from faying.study.results.frequency_record import FrequencyRecord


def frequency_figures(record: FrequencyRecord) -> dict[str, Any]:
    """Return the peaks of a harmonic load, its checks and what a reader should know."""
    expected = record.expected
    return {
        "component": record.at,
        "seconds": record.seconds,
        "levels": [_level(record, *peak) for peak in record.peaks()],
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


def _level(
    record: FrequencyRecord, curve: ResponseCurve, peak: Peak, expected: Peak | None
) -> dict[str, Any]:
    index = int(np.argmax(np.abs(curve.response(record.at))))
    figures: dict[str, Any] = {
        "level": curve.level,
        "frequency": peak.frequency,
        "amplitude": peak.amplitude,
        "phase": peak.phase,
        "points": len(curve.frequency),
        "missed": len(curve.missed),
        "harmonics": curve.harmonics.shape[1] - 1,
        "expected_frequency": None if expected is None else expected.frequency,
        "expected_amplitude": None if expected is None else expected.amplitude,
    }
    if curve.contact is not None:
        contact = curve.contact
        figures |= {
            "damping_ratio": float(contact.damping_ratio[index]),
            "friction_energy": float(contact.friction_energy[index]),
            "load_work": float(contact.load_work[index]),
            "max_imbalance": float(np.abs(contact.imbalance).max()),
            "max_pressure": float(contact.peak_pressure.max()),
            "stick_fraction": float(contact.stick_share.min()),
            "slip_fraction": float(contact.slip_share.max()),
            "open_fraction": float(contact.open_share.max()),
            "bolt_force_range": contact.bolt_force_range.max(axis=0, initial=0.0).tolist(),
        }
    return figures
