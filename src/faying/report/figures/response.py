"""Transient response: displacement, peak pressure and its error over time (as Fig. 15.7)."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from faying._typing import Vector
from faying.display.quantities import percent, quantity
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.style import NOTHING, REFERENCE, colour, label, new_figure
from faying.study.results.values import CaseResult, MethodResult, Response, Results
from faying.units import Units

COUNTS = (5, 20)
"""Joint modes of the paper's Fig. 15.7 (five) and Fig. 15.6 (twenty)."""
HEADROOM = 1.6
"""Pressures beyond this multiple of the reference's leave the picture."""


def shown_results(case: CaseResult) -> Iterator[tuple[str, MethodResult]]:
    """Yield each method at 5 and 20 joint modes, or at its smallest and largest count."""
    for name, sizes in case.methods.items():
        counts = sorted(sizes)
        if not counts:
            continue
        shown = (
            COUNTS[0] if COUNTS[0] in sizes else counts[0],
            COUNTS[1] if COUNTS[1] in sizes else counts[-1],
        )
        for count in sorted(set(shown)):
            yield name, sizes[count]


def largest_motion(case: CaseResult, boundary: str) -> int | None:
    """Return the translation of a boundary that moves most; None where there is none."""
    components = case.components.get(boundary, ())
    translations = [i for i, component in enumerate(components) if component.startswith("u")]
    if not translations:
        return None
    moved = case.reference.displacements[boundary]
    return translations[int(np.argmax([np.ptp(moved[..., i]) for i in translations]))]


def _line(name: str, result: MethodResult) -> dict[str, Any]:
    is_small = 0 < result.joint_modes <= COUNTS[0]
    return {
        "color": colour(name),
        "ls": (0, (4, 2)) if is_small else "-",
        "lw": 1.2,
        "label": plain(label(name, result.joint_modes)),
    }


def plot_displacement(case: CaseResult, boundary: str, axes: Axes, units: Units) -> Axes:
    """Draw the largest moving translation of a boundary over time."""
    component = largest_motion(case, boundary)
    if component is None or case.times is None:
        return axes
    exact = case.reference.displacements[boundary][:, component]
    axes.plot(case.times, exact, color=REFERENCE, lw=2.6, label=case.reference_model)
    for name, result in shown_results(case):
        curve = result.response.displacements[boundary][:, component]
        axes.plot(case.times, curve, **_line(name, result))
    if case.half_step is not None and case.half_step_times is not None:
        half = case.half_step.displacements[boundary][:, component]
        axes.plot(case.half_step_times, half, color="0.35", ls=":", lw=1.4, label="half time step")
    axes.set_ylabel(f"{plain(boundary)} {case.components[boundary][component]} [{units.length}]")
    return axes


def peak_pressure(response: Response) -> Vector:
    """Return the largest pressure over the contact points at each instant (n_time,)."""
    peak: Vector = np.asarray(response.pressure).max(axis=-1, initial=0.0)
    return peak


def plot_peak_pressure(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the largest pressure over time; curves far beyond the reference leave the picture."""
    if case.times is None:
        return axes
    exact = peak_pressure(case.reference)
    axes.plot(case.times, exact, color=REFERENCE, lw=2.6, label=case.reference_model)
    for name, result in shown_results(case):
        axes.plot(case.times, peak_pressure(result.response), **_line(name, result))
    top = float(exact.max(initial=0.0))
    if case.half_step is not None and case.half_step_times is not None:
        half = peak_pressure(case.half_step)
        axes.plot(case.half_step_times, half, color="0.35", ls=":", lw=1.4, label="half time step")
        top = max(top, float(half.max(initial=0.0)) / HEADROOM * 1.05)
    axes.set_ylim(0.0, HEADROOM * top if top > 0 else 1.0)
    axes.set_ylabel(f"max pressure [{units.pressure}]")
    return axes


def plot_error_over_time(case: CaseResult, axes: Axes) -> Axes:
    """Draw the largest relative pressure error over the points at each instant."""
    top = float(case.reference.pressure.max(initial=0.0))
    if case.times is None or top <= 0:
        return axes
    for name, result in shown_results(case):
        error = np.abs(result.response.pressure - case.reference.pressure).max(axis=-1) / top
        axes.plot(case.times, 100 * np.maximum(error, NOTHING), **_line(name, result))
    axes.set_yscale("log")
    axes.set_ylim(bottom=100 * NOTHING)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_ylabel("max relative\npressure error [%]")
    return axes


def response_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the response of a transient case; None for static ones."""
    if case.times is None or not len(case.times):
        return None
    units = results.unit_set
    boundaries = [name for name in case.components if largest_motion(case, name) is not None]
    n_row = len(boundaries) + 2
    figure = new_figure(11.5, 2.4 * n_row + 1.2)
    panels = figure.subplots(n_row, 1, sharex=True, squeeze=False)[:, 0]
    for axes, boundary in zip(panels, boundaries, strict=False):
        plot_displacement(case, boundary, axes, units)
    plot_peak_pressure(case, panels[-2], units)
    plot_error_over_time(case, panels[-1])
    panels[-1].set_xlabel(f"time [{units.time}]")
    panels[-1].set_xlim(case.times[0], case.times[-1])
    figure.legend(*panels[-2].get_legend_handles_labels(), loc="outside right center")
    figure.suptitle(heading(f"{case.name}: response over time"))
    return Drawn(
        figure=figure,
        stem="response",
        title=f"{case.name}: response over time",
        caption=_caption(case, units),
        section=case.name,
    )


def _caption(case: CaseResult, units: Units) -> str:
    times = case.times if case.times is not None else np.zeros(1)
    exact = peak_pressure(case.reference)
    top, instant = float(exact.max(initial=0.0)), int(exact.argmax())
    peaks = {
        label(name, result.joint_modes): float(result.response.pressure.max(initial=0.0))
        for name, result in shown_results(case)
    }
    outside = [
        f"{name} {quantity(peak, units.pressure)}"
        for name, peak in peaks.items()
        if peak > HEADROOM * top
    ]
    left = f" Beyond the pressure panel: {', '.join(outside)}." if outside else ""
    half = " Dotted: half the time step." if case.half_step is not None else ""
    return (
        f"Response to {case.name} from the preloaded state (as Fig. 15.7): the largest moving "
        "translation of each boundary, the largest pressure of all contact points, and the "
        "largest pressure error at each instant over the largest reference pressure of the run, "
        f"all at the same time step. {case.reference_model.capitalize()}: "
        f"max {quantity(top, units.pressure)} at "
        f"{quantity(float(times[instant]), units.time)}.{left}{half} Dashed: few joint modes; "
        f"errors below {percent(NOTHING)} lie on the lower edge."
    )
