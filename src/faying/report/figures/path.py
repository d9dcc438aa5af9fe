"""A load case with friction from state to state: loads, tractions, slip and the energy it takes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from faying._typing import Matrix, Vector
from faying.display.quantities import quantity
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.style import colour, new_figure
from faying.study.results.slip_record import SlipRecord
from faying.study.results.values import CaseResult, Results
from faying.units import Units


def path_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw a path over its increments; None for cases that are none."""
    path = case.reference.path
    if path is None:
        return None
    units, steps = results.unit_set, np.arange(1.0, len(path.factors) + 1)
    figure = new_figure(11.5, 8.6)
    loads, *panels = figure.subplots(4, 1, sharex=True)
    for name, values in zip(path.loads, path.factors.T, strict=True):
        loads.plot(steps, values, marker=".", label=plain(name))
    loads.set_ylabel("load factor")
    loads.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    _plot_friction(path, path.pressure, steps, panels, units, marker=".")
    panels[-1].set_xlabel("increment")
    panels[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    for number in np.flatnonzero(path.macroslip):
        panels[1].axvspan(steps[number] - 0.5, steps[number] + 0.5, color="0.8", zorder=0)
    gross = int(path.macroslip.sum())
    slipped = (
        f" All that touches slips in {gross} of them (grey behind the shares)." if gross else ""
    )
    figure.suptitle(heading(f"{case.name}: increments, full model"))
    dissipated = quantity(float(path.dissipation.sum()), units.of("force·length"))
    return Drawn(
        figure=figure,
        stem="path",
        title=f"{case.name}: increments",
        caption=(
            f"The full model over the {len(steps)} increments of {case.name}, which begins at the "
            "preloaded joint: load factors, largest pressure and traction, shares of the area "
            "that slip in an increment and stick, and the energy that friction has taken, "
            f"{dissipated} at the end.{slipped}"
        ),
        section=case.name,
    )


def motion_slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw what friction does over time; None for cases without."""
    record, times = case.reference.friction, case.times
    if record is None or times is None:
        return None
    units = results.unit_set
    figure = new_figure(11.5, 6.8)
    panels = list(figure.subplots(3, 1, sharex=True))
    _plot_friction(record, case.reference.pressure, times, panels, units, marker="")
    panels[-1].set_xlabel(f"time [{units.time}]")
    panels[-1].set_xlim(times[0], times[-1])
    figure.suptitle(heading(f"{case.name}: friction over time, {case.reference_model}"))
    dissipated = quantity(float(record.dissipation.sum()), units.of("force·length"))
    gross = int(record.macroslip.sum())
    slipped = f" All that touches slips at {gross} of {len(times)} instants." if gross else ""
    return Drawn(
        figure=figure,
        stem="friction",
        title=f"{case.name}: friction over time",
        caption=(
            f"{case.reference_model.capitalize()}, from the preloaded joint on: largest pressure "
            "and traction of all contact points, shares of the area with friction that slip and "
            "stick, and the energy that friction has taken, "
            f"{dissipated} at the end. At the first instant nothing slips yet.{slipped}"
        ),
        section=case.name,
    )


def _plot_friction(
    record: SlipRecord,
    pressure: Matrix,
    along: Vector,
    panels: list[Axes],
    units: Units,
    *,
    marker: str,
) -> None:
    """Draw largest pressure and traction, shares that slip and stick, and energy: three panels."""
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
