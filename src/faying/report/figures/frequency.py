"""Figure of amplitude and phase over frequency under harmonic loads."""

from typing import Any

import numpy as np

from faying._typing import Vector
from faying.assessment.response_curve import ResponseCurve
from faying.display.style import heading
from faying.report.figures.album import Drawn
from faying.report.style import new_figure
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.values import Results

MARKS, MARKERS = 60, "^vs"
"""Approximate number of drawn points of a measured curve, and markers of the curves."""


def frequency_figure(results: Results, name: str) -> Drawn:
    """Draw the responses to a harmonic load: by harmonics, linear, and from the backbone."""
    record = results.frequencies[name]
    figure = new_figure(9.5, 7.0)
    above = figure.add_subplot(3, 1, (1, 2))
    below = figure.add_subplot(3, 1, 3, sharex=above)
    record.response.plot(record.at, (above, below), expected=record.expected)
    if record.backbone is not None and record.expected is not None:
        tops = [curve.peak(record.at) for curve in record.expected.curves if len(curve.frequency)]
        ridge = sorted((peak for peak in tops if not peak.at_end), key=lambda peak: peak.level)
        size = [peak.amplitude / peak.level for peak in ridge]
        above.plot([peak.frequency for peak in ridge], size, "k+", label="peaks by the backbone")
    levels = [curve.level for curve in record.response.curves]
    for number, (test, curve) in enumerate(record.measured.items()):
        moved, every = curve.response(record.at) / curve.level, len(curve.frequency) // MARKS + 1
        style: dict[str, Any] = {"marker": MARKERS[number % len(MARKERS)], "mfc": "none", "ls": ""}
        style |= {"ms": 4, "markevery": every, "color": f"C{levels.index(curve.level)}"}
        above.plot(curve.frequency, np.abs(moved), label=test, **style)
        below.plot(curve.frequency, np.degrees(phases(curve, record)), **style)
    above.set_xlim(*record.response.linear.frequency[[0, -1]])
    above.legend()
    figure.suptitle(heading(f"{name}: {record.at} over frequency, full model"))
    order = max((curve.harmonics.shape[1] - 1 for curve in record.response.curves), default=0)
    said = [
        f"Lines: harmonics of the motion, up to {order}; points that were computed are marked.",
        "Dashed: the linear joint, in which every closed point sticks.",
    ]
    if record.expected is not None:
        said.append(
            "Dotted, crosses: estimated from the backbone of mode "
            f"{record.backbone.mode if record.backbone else ''}, blind to other modes."
        )
    said += [f"{check.sentence[0].upper()}{check.sentence[1:]}." for check in record.checks]
    said += [f"{text[0].upper()}{text[1:]}." for text in record.response.remarks]
    largest = {
        order: max(
            float(np.abs(curve.response(record.at, order)).max(initial=0.0))
            / max(float(np.abs(curve.response(record.at)).max(initial=0.0)), 1e-300)
            for curve in record.response.curves
        )
        for order in range(2, order + 1)
        if all(curve.harmonics.shape[1] > order for curve in record.response.curves)
    }
    if largest:
        strongest = max(largest, key=largest.__getitem__)
        said.append(f"Harmonic {strongest} reaches {largest[strongest]:.2g} of the first.")
    return Drawn(
        figure=figure,
        stem="response",
        title=f"{name}: amplitude and phase over frequency",
        caption=" ".join(said),
    )


def phases(measured: ResponseCurve, record: FrequencyRecord) -> Vector:
    """Return the phases (n,) [rad] of a measured curve, in the turn of the linear response."""
    linear = record.response.linear
    turned, beside = (
        np.unwrap(np.angle(curve.response(record.at))) for curve in (measured, linear)
    )
    apart = float(np.mean(turned - np.interp(measured.frequency, linear.frequency, beside)))
    return np.asarray(turned - 2 * np.pi * round(apart / (2 * np.pi)))
