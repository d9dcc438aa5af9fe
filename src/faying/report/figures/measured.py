"""Measured frequency and damping over amplitude beside what was computed: a curve, or a band."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from faying._typing import Vector
from faying.assessment.backbone import Backbone, amplitude_unit
from faying.assessment.backbone_band import BackboneBand
from faying.assessment.measured_curve import MeasuredCurve
from faying.report.style import new_figure
from faying.units import units_of


def draw_fit(computed: Backbone, measured: MeasuredCurve) -> Figure:
    """Draw a backbone and the curve it was fitted to."""
    upper, lower = _axes(computed.measured_at, computed.units)
    upper.plot(computed.amplitude, computed.frequency, "o-", label="computed")
    lower.plot(computed.amplitude, 100 * computed.damping_ratio, "o-", label="computed")
    return _with_tests(upper, lower, [measured])


def draw_band(band: BackboneBand, measured: Sequence[MeasuredCurve]) -> Figure:
    """Draw a band, and the measured curves it should hold."""
    upper, lower = _axes(band.measured_at, band.units)
    ends: tuple[tuple[Axes, Vector, Vector], ...] = (
        (upper, band.frequency_low, band.frequency_high),
        (lower, 100 * band.damping_low, 100 * band.damping_high),
    )
    for axes, low, high in ends:
        axes.fill_between(band.amplitude, low, high, alpha=0.3, label="computed")
    return _with_tests(upper, lower, measured)


def _axes(measured_at: str, units: str) -> tuple[Axes, Axes]:
    figure = new_figure(6.5, 6.2)
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.set_xscale("log")
    lower.xaxis.set_major_formatter(FuncFormatter(_label))
    lower.xaxis.set_minor_formatter(FuncFormatter(_label))
    upper.set_ylabel(f"frequency [1/{units_of(units).time}]")
    lower.set_ylabel("damping ratio [%]")
    lower.set_xlabel(f"amplitude at {measured_at} [{amplitude_unit(measured_at, units)}]")
    return upper, lower


def _label(amplitude: float, _: int | None) -> str:
    """Return what stands below a tick; a decade has four of them."""
    return f"{amplitude:g}" if f"{amplitude:e}"[0] in "1235" else ""


def _with_tests(upper: Axes, lower: Axes, measured: Sequence[MeasuredCurve]) -> Figure:
    for test in measured:
        if test.frequency is not None:
            upper.plot(test.amplitude, test.frequency, "^k", mfc="none", label=test.name)
        if test.damping_ratio is not None:
            lower.plot(test.amplitude, 100 * test.damping_ratio, "^k", mfc="none", label=test.name)
    for axes in (upper, lower):
        axes.legend()
    figure = upper.get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure
