"""Where a joint with friction sticks and slips, and with what tractions."""

import numpy as np
from matplotlib.axes import Axes

from faying._typing import Indices, Matrix, Vector
from faying.display.quantities import percent, quantity
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.pressure import plot_pressure
from faying.report.figures.surface_map import best_plane, draw_states, map_panels, name_states
from faying.report.slip import shown_slip, slipping
from faying.report.style import OPEN_COLOUR
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units

STATES = {"open": OPEN_COLOUR, "sticks": "#7FA6C9", "slips": "#D95F02"}
"""States of a contact point and their colours, in the order of their numbers."""


def plot_traction(
    record: InterfaceRecord,
    pressure: Vector,
    traction: Matrix,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw tractions as arrows at the node pairs, over the contact pressure (n_point,).

    Tractions (n_point, 3) act on the plus side. ``largest`` is the top of the colour scale of the
    pressure.
    """
    plane = best_plane(record)
    plot_pressure(record, pressure, axes, units, largest=largest)
    averages = record.nodal_average(traction)
    size = float(np.linalg.norm(averages, axis=1).max(initial=0.0))
    if size > 0:
        strong = np.linalg.norm(averages, axis=1) > 0.02 * size
        x, y = plane.project(record.pair_points[strong]).T
        right, up = plane.directions(record.pair_points[strong], averages[strong]).T
        edge = np.sqrt(float(record.weights.sum()) / max(len(record.pairs), 1))
        arrows = axes.quiver(
            x, y, right, up, angles="xy", scale_units="xy", scale=size / (1.4 * edge),
            color="white", edgecolor="black", linewidth=0.6, width=0.005, zorder=4, pivot="mid",
        )  # fmt: skip
        axes.quiverkey(
            arrows, 0.86, 1.05, size, quantity(size, units.pressure), labelpos="E", color="black"
        )
    return axes


def plot_slip_states(record: InterfaceRecord, status: Indices, axes: Axes, units: Units) -> Axes:
    """Draw which contact points (n_point,) of an interface are open, stick or slip."""
    return draw_states(record, status, axes, units, STATES)


def slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw tractions over pressure and the states of the points, one row per interface.

    They are those of the increment or instant in which most slips, of a static load at its full
    value; None without friction.
    """
    records = results.rubbing
    units = results.unit_set
    shown = shown_slip(case, units)
    if shown is None or not records:
        return None
    tractions, status = shown.record.traction[shown.at], shown.record.status[shown.at]
    solved_by = case.reference_model
    figure, rows = map_panels(records.values(), 2, 13.0, 1.0)
    largest = float(shown.pressure.max(initial=0.0))
    notes = []
    for (left, right), (name, record) in zip(rows, records.items(), strict=True):
        points = slice(*record.slice)
        traction = tractions[points]
        plot_traction(record, shown.pressure[points], traction, left, units, largest=largest)
        plot_slip_states(record, status[points], right, units)
        top = float(np.linalg.norm(traction, axis=1).max(initial=0.0))
        slips = percent(slipping(record, status[points]))
        left.set_title(plain(f"{name}: max traction {quantity(top, units.pressure)}"), loc="left")
        right.set_title(plain(f"{name}: {slips} of the area in contact slip"), loc="left")
        notes.append(
            f"{name}: traction up to {quantity(top, units.pressure)}, {slips} of the area in "
            "contact slip"
        )
    name_states(figure, STATES)
    figure.suptitle(heading(f"{case.name}: traction and slip, {solved_by}, {shown.when}"))
    return Drawn(
        figure=figure,
        stem="slip",
        title=f"{case.name}: traction and slip",
        caption=(
            f"{solved_by.capitalize()}, {shown.when}. Left: traction on the plus side as nodal "
            "averages, arrows over the contact pressure. Right: contact points, each over the area "
            f"nearest to it, that are open, stick, or slip there. {'. '.join(notes)}."
        ),
        section=case.name,
    )
