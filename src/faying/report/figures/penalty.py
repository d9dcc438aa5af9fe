"""What the contact stiffness does to the pressures of the static load cases."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from faying.assessment.penalty_sweep import PenaltySweep
from faying.display.quantities import quantity
from faying.display.style import plain
from faying.report.figures.entry import Drawn
from faying.report.style import colour, new_figure
from faying.study.results.values import Results
from faying.units import Units, units_of

LINES = ("-", "--", ":", "-.")
"""One per load case, so that colours stay those of the methods."""
FLOOR = 1e-5
"""Bottom of the picture, as a fraction."""


def plot_deviation(sweep: PenaltySweep, axes: Axes, units: Units) -> Axes:
    """Draw how far the full model's nodal averages are from hard contact over the penalty."""
    for number, load in enumerate(sweep.loads):
        errors = 100 * np.maximum(sweep.deviation[:, number], FLOOR)
        style = LINES[number % len(LINES)]
        axes.plot(sweep.penalties, errors, color="k", ls=style, marker=".", label=plain(load))
    axes.set_title("full model: distance from hard contact", loc="left")
    return _finished(axes, units, "max difference of nodal averages [%]")


def plot_method_errors(sweep: PenaltySweep, axes: Axes, units: Units) -> Axes:
    """Draw the largest relative error of each method, over the load cases, over the penalty."""
    for name, errors in sweep.errors.items():
        worst = 100 * np.maximum(np.asarray(errors).max(axis=-1), FLOOR)
        axes.plot(sweep.penalties, worst, color=colour(name), marker=".", label=plain(name))
    axes.set_title("reduced models: error against the full model", loc="left")
    return _finished(axes, units, "max relative pressure error [%]")


def _finished(axes: Axes, units: Units, label: str) -> Axes:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(bottom=100 * FLOOR)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlabel(f"penalty stiffness [{units.of('force/length³')}]")
    axes.set_ylabel(label)
    return axes


def penalty_figure(results: Results) -> Drawn | None:
    """Draw the sweep over the penalty; None where it was not made."""
    record = results.validation.penalty
    if record is None or not record.sweep.loads or not len(record.sweep.penalties):
        return None
    units, sweep = units_of(results.units), record.sweep
    figure = new_figure(11.0, 4.8)
    left, right = figure.subplots(1, 2)
    plot_deviation(sweep, left, units)
    plot_method_errors(sweep, right, units)
    every = (record.penalty for record in results.interfaces.values())
    used = {penalty for penalty in every if penalty is not None and np.isfinite(penalty)}
    for axes in (left, right):
        for penalty in used:
            axes.axvline(penalty, color="0.6", lw=1.0, label="this study")
        axes.axvline(record.recommended, color="0.3", lw=1.2, ls=(0, (1, 1)), label="recommended")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=3)
    figure.suptitle("Contact stiffness")
    unit = units.of("force/length³")
    missed = "" if record.reached else ", the closest to hard contact but not within its tolerance"
    caption = (
        "Static load cases over the penalty stiffness at the same final bolt forces. Left: "
        "largest difference of the full model's nodal average pressures from hard contact, over "
        "the largest of hard contact. Right: largest relative error of the reduced models against "
        "the full model of the same penalty, worst load case; errors below 0.001 % lie on the "
        "lower edge. Recommended: "
        f"{quantity(record.recommended, unit)}{missed} (automatic: "
        f"{quantity(sweep.automatic, unit)})."
    )
    return Drawn(
        figure=figure, stem="penalty", title="Contact stiffness", caption=caption, section="beyond"
    )
