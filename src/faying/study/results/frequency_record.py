"""Stored results of a joint under harmonic loads."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from faying.assessment.backbone import Backbone
from faying.assessment.response_curve import (
    FrequencyResponse,
    Peak,
    ResponseCurve,
)
from faying.assessment.transient_check import TransientCheck


@dataclass(frozen=True, eq=False, kw_only=True)
class LevelPeak:
    """The highest point of the curve of a level.

    Attributes
    ----------
    curve
    peak
    index
        Index of the point on the curve.
    expected
        Peak expected from the backbone; None where unknown.
    """

    curve: ResponseCurve
    peak: Peak
    index: int
    expected: Peak | None

    def there(self, name: str) -> float | None:
        """Return a contact quantity at the peak by name; None where contact was not evaluated."""
        contact = self.curve.contact
        return None if contact is None else float(getattr(contact, name)[self.index])


@dataclass(frozen=True, eq=False, kw_only=True)
class FrequencyRecord:
    """Responses to a harmonic load of a study.

    Attributes
    ----------
    at
        Component of a boundary that tables and figures show.
    response
        Response by harmonic balance, one curve for each level.
    expected
        Response from the backbone alone; None without friction, or without a mode in the range.
    backbone
        Backbone of the mode in resonance.
    checks : (n_check,)
        Transients at peaks as a check, where requested.
    measured
        Measured curves by name.
    seconds : [s]
        Wall time of all computations.
    """

    at: str
    response: FrequencyResponse
    expected: FrequencyResponse | None = None
    backbone: Backbone | None = None
    checks: tuple[TransientCheck, ...] = ()
    measured: Mapping[str, ResponseCurve] = field(default_factory=dict)
    seconds: float = 0.0

    def peaks(self) -> Iterator[LevelPeak]:
        """Yield the peaks of the curves that have points."""
        curves = () if self.expected is None else self.expected.curves
        expected = {curve.level: curve.peak(self.at) for curve in curves if len(curve.frequency)}
        for curve in self.response.curves:
            if len(curve.frequency):
                yield LevelPeak(
                    curve=curve,
                    peak=curve.peak(self.at),
                    index=int(np.argmax(np.abs(curve.response(self.at)))),
                    expected=expected.get(curve.level),
                )

    def compared(self) -> Iterator[tuple[str, Mapping[str, tuple[float, float]]]]:
        """Yield each measured curve with pairs of measured and computed values.

        Frequency and amplitude of the peak, NaN of a curve that is largest at an end, and damping
        ratio of a fitted mode, between the common range of frequencies.
        """
        computed = {curve.level: curve for curve in self.response.curves}
        for name, test in self.measured.items():
            both = test.between(computed[test.level]), computed[test.level].between(test)
            if all(len(curve.frequency) for curve in both):
                peaks = [_inner_peak(curve.peak(self.at)) for curve in both]
                first, second = (curve.fitted_damping(self.at) for curve in both)
                yield (
                    name,
                    {
                        "frequency": (peaks[0][0], peaks[1][0]),
                        "amplitude": (peaks[0][1], peaks[1][1]),
                        "damping_ratio": (first, second),
                    },
                )

    def missed(self, name: str) -> Iterator[str]:
        """Yield the frequencies without a solution, with reasons."""
        for curve in self.response.curves:
            for text in curve.missed:
                yield f"{name}, level {curve.level:g}, frequency {text}"


def _inner_peak(peak: Peak) -> tuple[float, float]:
    """Return frequency and amplitude of a peak, NaN where the curve has none."""
    return (np.nan, np.nan) if peak.at_end else (peak.frequency, peak.amplitude)
