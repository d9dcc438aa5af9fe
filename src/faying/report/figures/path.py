"""A load case in increments: loads, pressures, tractions, slip and the energy that it takes."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.quantities import quantity
from faying.report.style import colour, new_figure
from faying.study.results import CaseResult, Results
from faying.units import units_of


def path_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw a path over its increments; None for cases that are none."""
    path = case.reference.path
    if path is None:
        return None
    units, steps = units_of(results.units), np.arange(1, len(path.factors) + 1)
    figure = new_figure(11.5, 8.6)
    loads, top, shares, energy = figure.subplots(4, 1, sharex=True)
    for name, values in zip(path.loads, path.factors.T, strict=True):
        loads.plot(steps, values, marker=".", label=plain(name))
    loads.set_ylabel("load factor")
    loads.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    top.plot(steps, path.pressure.max(axis=1, initial=0.0), marker=".", label="pressure")
    tractions = np.linalg.norm(path.traction, axis=2).max(axis=1, initial=0.0)
    top.plot(steps, tractions, marker=".", label="traction")
    top.set_ylabel(f"largest at a point\n[{units.pressure}]")
    top.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    shares.stackplot(
        steps,
        100 * path.slip_share,
        100 * path.stick_share,
        labels=["slips", "sticks"],
        colors=["#D95F02", "#7FA6C9"],
    )
    shares.set_ylabel("share of the area\nwith friction [%]")
    shares.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    taken = np.cumsum(path.dissipation)
    energy.plot(steps, taken, color=colour("jim-a"), marker=".")
    energy.set_ylabel(f"energy by friction\n[{units.of('force·length')}]")
    energy.set_xlabel("increment")
    energy.xaxis.set_major_locator(MaxNLocator(integer=True))
    for number in np.flatnonzero(path.macroslip):
        shares.axvspan(steps[number] - 0.5, steps[number] + 0.5, color="0.8", zorder=0)
    gross = int(path.macroslip.sum())
    slipped = (
        f" All that touches slips in {gross} of them (grey behind the shares)." if gross else ""
    )
    figure.suptitle(heading(f"{case.name}: increments, full model"))
    return Drawn(
        figure=figure,
        stem="path",
        title=f"{case.name}: increments",
        caption=(
            f"The full model over the {len(steps)} increments of {case.name}, which begins at the "
            "preloaded joint: load factors, largest pressure and traction, shares of the area "
            "that slip in an increment and stick, and the energy that friction has taken, "
            f"{quantity(float(taken[-1]), units.of('force·length'))} at the end.{slipped}"
        ),
        section=case.name,
    )
