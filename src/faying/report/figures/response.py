"""Figures of load cases over time (as Fig. 15.7), over increments, and in cycles."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from faying._typing import Matrix, Vector
from faying.display.quantities import number, percent, quantity
from faying.display.style import heading, plain
from faying.report.figures.album import Drawn
from faying.report.style import REFERENCE, SMALLEST_DRAWN, colour, label, new_figure
from faying.study.results.path_record import CycleRecord, PathRecord, SlipRecord
from faying.study.results.values import CaseResult, MethodResult, Response, Results
from faying.units import Units

MODE_COUNTS = (5, 20)
"""Joint modes of the paper's Fig. 15.7 (five) and Fig. 15.6 (twenty)."""
HEADROOM = 1.6
"""Upper limit of pressures in a figure, over the largest pressure of the reference."""


def shown_results(case: CaseResult) -> Iterator[tuple[str, MethodResult]]:
    """Yield each method at 5 and 20 joint modes, or at its smallest and largest count."""
    for name, sizes in case.methods.items():
        counts = sorted(sizes)
        if not counts:
            continue
        shown = (
            MODE_COUNTS[0] if MODE_COUNTS[0] in sizes else counts[0],
            MODE_COUNTS[1] if MODE_COUNTS[1] in sizes else counts[-1],
        )
        for count in sorted(set(shown)):
            yield name, sizes[count]


def largest_motion(case: CaseResult, boundary: str) -> int | None:
    """Return the index of the largest translation of a boundary; None without translations."""
    components = case.components.get(boundary, ())
    translations = [i for i, component in enumerate(components) if component.startswith("u")]
    if not translations:
        return None
    moved = case.reference.displacements[boundary]
    return translations[int(np.argmax([np.ptp(moved[..., i]) for i in translations]))]


def _line(name: str, result: MethodResult) -> dict[str, Any]:
    is_small = 0 < result.joint_modes <= MODE_COUNTS[0]
    return {
        "color": colour(name),
        "ls": (0, (4, 2)) if is_small else "-",
        "lw": 1.2,
        "label": plain(label(name, result.joint_modes)),
    }


def _plot_over_time(case: CaseResult, axes: Axes, value: Callable[[Response], Vector]) -> None:
    """Draw a value over time (n_time,), of the reference and the shown methods."""
    times, name = np.asarray(case.times), case.reference_model
    axes.plot(times, value(case.reference), color=REFERENCE, lw=2.6, label=name)
    for name, result in shown_results(case):
        axes.plot(times, value(result.response), **_line(name, result))
    if case.half_step is not None and case.half_step_times is not None:
        half = value(case.half_step)
        axes.plot(case.half_step_times, half, color="0.35", ls=":", lw=1.4, label="half time step")


def plot_displacement(case: CaseResult, boundary: str, axes: Axes, units: Units) -> Axes:
    """Draw the largest translation of a boundary over time."""
    component = largest_motion(case, boundary)
    if component is not None and case.times is not None:
        _plot_over_time(case, axes, lambda solved: solved.displacements[boundary][:, component])
        label = f"{plain(boundary)} {case.components[boundary][component]}"
        axes.set_ylabel(f"{label} [{units.length}]")
    return axes


def peak_pressure(response: Response) -> Vector:
    """Return the largest pressure over the contact points at each instant (n_time,)."""
    peak: Vector = np.asarray(response.pressure).max(axis=-1, initial=0.0)
    return peak


def plot_peak_pressure(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the largest pressure over time; curves far above the reference are cut off."""
    if case.times is None:
        return axes
    _plot_over_time(case, axes, peak_pressure)
    top = HEADROOM * float(peak_pressure(case.reference).max(initial=0.0))
    if case.half_step is not None:
        top = max(top, 1.05 * float(peak_pressure(case.half_step).max(initial=0.0)))
    axes.set_ylim(0.0, top if top > 0 else 1.0)
    axes.set_ylabel(f"max pressure [{units.pressure}]")
    return axes


def plot_error_over_time(case: CaseResult, axes: Axes) -> Axes:
    """Draw the largest relative pressure error over the points at each instant."""
    top = float(case.reference.pressure.max(initial=0.0))
    if case.times is None or top <= 0:
        return axes
    for name, result in shown_results(case):
        error = np.abs(result.response.pressure - case.reference.pressure).max(axis=-1) / top
        axes.plot(case.times, 100 * np.maximum(error, SMALLEST_DRAWN), **_line(name, result))
    axes.set_yscale("log")
    axes.set_ylim(bottom=100 * SMALLEST_DRAWN)
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
    left = f" Outside the pressure panel: {', '.join(outside)}." if outside else ""
    half = " Dotted: half the time step." if case.half_step is not None else ""
    return (
        f"Response to {case.name} from the preloaded state (as Fig. 15.7): the largest "
        "translation of each boundary, the largest pressure of all contact points, and the "
        "largest pressure error at each instant over the largest reference pressure of the run, "
        f"all at the same time step. {case.reference_model.capitalize()}: "
        f"max {quantity(top, units.pressure)} at "
        f"{quantity(float(times[instant]), units.time)}.{left}{half} Dashed: few joint modes; "
        f"errors below {percent(SMALLEST_DRAWN)} lie on the lower edge."
    )


def path_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw a path over its increments; None for other cases."""
    path = case.reference.path
    if path is None:
        return None
    rubbing = any(surface.friction > 0 for surface in results.interfaces.values())
    steps = np.arange(1.0, len(path.factors) + 1)
    figure = new_figure(11.5, 8.6 if rubbing else 6.8)
    loads, *panels = figure.subplots(4 if rubbing else 3, 1, sharex=True)
    for name, values in zip(path.loads, path.factors.T, strict=True):
        loads.plot(steps, values, marker=".", label=plain(name))
    loads.set_ylabel("load factor")
    loads.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    if rubbing:
        taken = _plot_friction(path, path.pressure, steps, panels, results.unit_set, marker=".")
        contents = (
            "largest pressure and traction, shares of the area that slip in an increment and "
            f"stick, and the energy dissipated by friction, {taken} at the end."
        )
    else:
        _plot_forces(path, steps, panels, results.unit_set)
        contents = "largest pressure and forces of bolts."
    panels[-1].set_xlabel("increment")
    panels[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    for row in np.flatnonzero(path.macroslip):
        panels[1].axvspan(steps[row] - 0.5, steps[row] + 0.5, color="0.8", zorder=0)
    gross = int(path.macroslip.sum())
    slipped = (
        f" All closed points slip in {gross} of them (grey behind the shares)." if gross else ""
    )
    figure.suptitle(heading(f"{case.name}: increments, full model"))
    return Drawn(
        figure=figure,
        stem="path",
        title=f"{case.name}: increments",
        caption=(
            f"The full model over the {len(steps)} increments of {case.name}, which starts at the "
            f"preloaded joint: load factors, {contents}{slipped}"
        ),
    )


def motion_slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw friction over time; None for cases without friction."""
    record, times = case.reference.friction, case.times
    if times is None or not len(record):
        return None
    figure = new_figure(11.5, 6.8)
    panels, units = list(figure.subplots(3, 1, sharex=True)), results.unit_set
    taken = _plot_friction(record, case.reference.pressure, times, panels, units, marker="")
    panels[-1].set_xlabel(f"time [{units.time}]")
    panels[-1].set_xlim(times[0], times[-1])
    figure.suptitle(heading(f"{case.name}: friction over time, {case.reference_model}"))
    gross = int(record.macroslip.sum())
    slipped = f" All closed points slip at {gross} of {len(times)} instants." if gross else ""
    return Drawn(
        figure=figure,
        stem="friction",
        title=f"{case.name}: friction over time",
        caption=(
            f"{case.reference_model.capitalize()}, from the preloaded joint on: largest pressure "
            "and traction of all contact points, shares of the area with friction that slip and "
            "stick, and the energy dissipated by friction, "
            f"{taken} at the end. No point slips at the first instant.{slipped}"
        ),
    )


def _plot_friction(
    record: SlipRecord,
    pressure: Matrix,
    along: Vector,
    panels: list[Axes],
    units: Units,
    *,
    marker: str,
) -> str:
    """Draw pressure, traction, slipping and sticking shares, and energy; return the energy."""
    top, shares, energy = panels
    top.plot(along, pressure.max(axis=1, initial=0.0), marker=marker, label="pressure")
    tractions = np.linalg.norm(record.traction, axis=2).max(axis=1, initial=0.0)
    top.plot(along, tractions, marker=marker, label="traction")
    top.set_ylabel(f"largest at a point\n[{units.pressure}]")
    top.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    shares.stackplot(
        along,
        100 * record.slip_share,
        100 * record.stick_share,
        labels=["slips", "sticks"],
        colors=["#D95F02", "#7FA6C9"],
    )
    shares.set_ylabel("share of the area\nwith friction [%]")
    shares.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    energy.plot(along, np.cumsum(record.dissipation), color=colour("jim-a"), marker=marker)
    energy.set_ylabel(f"energy by friction\n[{units.of('force·length')}]")
    return quantity(float(record.dissipation.sum()), units.of("force·length"))


def _plot_forces(path: PathRecord, along: Vector, panels: list[Axes], units: Units) -> None:
    """Draw the largest pressure and the forces of bolts of a joint without friction."""
    top, bolts = panels
    top.plot(along, path.pressure.max(axis=1, initial=0.0), marker=".")
    top.set_ylabel(f"largest pressure\nat a point [{units.pressure}]")
    for name, forces in path.bolt_forces.items():
        bolts.plot(along, forces, marker=".", label=plain(name))
    bolts.set_ylabel(f"bolt force [{units.force}]")
    if path.bolt_forces:
        bolts.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def plot_loops(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the last loop of each amplitude: load factor over work-conjugate displacement."""
    for cycle in case.reference.cycles.values():
        factors = np.concatenate([[cycle.amplitude], cycle.increments.factors[:, 0]])
        work = np.concatenate([[cycle.start_work], cycle.increments.load_work])
        label = f"amplitude {number(cycle.amplitude)}"
        axes.plot(work, factors, marker=".", ms=3, label=label)
    axes.set_xlabel(f"load at factor one × displacement along it [{units.of('force·length')}]")
    axes.set_ylabel("load factor")
    axes.legend()
    return axes


def plot_energies(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the energy per cycle over the amplitude, from slip and from the area of the loop."""
    cycles = list(case.reference.cycles.values())
    amplitudes = [cycle.amplitude for cycle in cycles]
    axes.plot(amplitudes, [cycle.energies[-1] for cycle in cycles], "o-", label="by slip")
    axes.plot(
        amplitudes, [cycle.loop_area for cycle in cycles], "x", ms=8, label="area of the loop"
    )
    if min(cycle.energies[-1] for cycle in cycles) > 0 and len(cycles) > 1:
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.set_xlabel("amplitude [load factor]")
    axes.set_ylabel(f"energy per cycle [{units.of('force·length')}]")
    axes.legend()
    return axes


def loop_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the cycles of a case; None for cases without."""
    cycles = case.reference.cycles
    if not cycles:
        return None
    units = results.unit_set
    figure = new_figure(13.0, 5.4)
    left, right = figure.subplots(1, 2)
    plot_loops(case, left, units)
    plot_energies(case, right, units)
    left.set_title("last loop of each amplitude", loc="left")
    right.set_title("energy per cycle", loc="left")
    figure.suptitle(heading(f"{case.name}: cycles, full model"))
    notes = "; ".join(_described(cycle, units) for cycle in cycles.values())
    return Drawn(
        figure=figure,
        stem="loops",
        title=f"{case.name}: loops and energy per cycle",
        caption=(
            "Left: load factor over the displacement along the load, times the load "
            "at factor one, so that the area of a loop is energy. Right: energy per cycle, by "
            "slip and by that area; both agree in the limit of small increments. "
            f"Amplitude {notes}."
        ),
    )


def _described(cycle: CycleRecord, units: Units) -> str:
    """Return amplitude, energy and number of cycles as text."""
    energy = quantity(float(cycle.energies[-1]), units.of("force·length"))
    repeats = "" if cycle.stationary else ", still changing"
    return f"{number(cycle.amplitude)}: {energy} after {len(cycle.energies)} cycles{repeats}"
