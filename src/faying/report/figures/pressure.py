"""Contact pressure of the full model in a static load case (as Fig. 15.5)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable

from faying._typing import Vector
from faying.report.figures.entry import Drawn
from faying.report.figures.surface_map import (
    best_plane,
    colour_bar,
    draw_averages,
    normalize,
    panel_size,
    prepare,
)
from faying.report.quantities import percent, place, quantity
from faying.report.style import PRESSURE_MAP, new_figure, plain
from faying.study.results import CaseResult, InterfaceRecord, Results
from faying.study.units import Units, units_of

CLOSED = 1e-9
"""Averages below this fraction of the largest count as no contact."""


def plot_pressure(
    record: InterfaceRecord,
    pressure: Vector,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw a contact pressure as nodal averages; grey where open, a cross at the largest point.

    Parameters
    ----------
    pressure : (n_point,)
        At the contact points of this interface.
    largest
        Top of the colour scale; the largest nodal average by default.
    """
    plane = best_plane(record)
    prepare(axes, record, plane, units)
    averages = record.averaging @ pressure
    own = float(averages.max(initial=0.0))
    mappable = ScalarMappable(normalize(largest or own, signed=False), PRESSURE_MAP)
    closed = averages > CLOSED * own
    draw_averages(axes, record, plane, averages, mappable, closed=closed)
    if len(pressure) and pressure.max() > 0:
        x, y = plane.project(record.points[[pressure.argmax()]])[0]
        axes.plot(x, y, "x", color="white", ms=9, mew=3.5)
        axes.plot(x, y, "x", color="black", ms=8, mew=1.5)
    colour_bar(axes, mappable, f"contact pressure [{units.pressure}]")
    return axes


def described_peak(record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the largest pressure at a point and where, and the largest nodal average."""
    if not len(pressure) or pressure.max() <= 0:
        return "no contact"
    point = record.points[pressure.argmax()]
    size = float(np.ptp(record.points, axis=0).max())
    average = float((record.averaging @ pressure).max())
    return (
        f"max {quantity(pressure.max(), units.pressure)} at {place(point, units.length, size)}, "
        f"nodal average max {quantity(average, units.pressure)}"
    )


def open_share(record: InterfaceRecord, pressure: Vector) -> float:
    """Return the part of the area whose contact points carry no pressure."""
    total = float(record.weights.sum())
    return float(record.weights[pressure <= 0].sum() / total) if total > 0 else 0.0


def pressure_figure(results: Results, case: CaseResult) -> Drawn:
    """Draw the reference pressure of a static case on all interfaces, on one colour scale."""
    units = units_of(results.units)
    records = results.interfaces
    sizes = [panel_size(record, best_plane(record), 7.0) for record in records.values()]
    figure = new_figure(8.2, max(sum(height for _, height in sizes), 2.0))
    panels = figure.subplots(
        len(records), 1, squeeze=False, height_ratios=[height for _, height in sizes]
    )[:, 0]
    own = {name: case.reference.pressure[slice(*r.slice)] for name, r in records.items()}
    largest = max(float((r.averaging @ own[name]).max(initial=0.0)) for name, r in records.items())
    notes = []
    for axes, (name, record) in zip(panels, records.items(), strict=True):
        plot_pressure(record, own[name], axes, units, largest=largest)
        note = described_peak(record, own[name], units)
        axes.set_title(plain(f"{name}: {note}"), loc="left")
        shape = "" if best_plane(record).flat else ", curved, projected on its best plane"
        notes.append(f"{name}: {note}; {percent(open_share(record, own[name]))} open{shape}")
    figure.suptitle(plain(f"{case.name}: contact pressure, full model"))
    caption = (
        f"Contact pressure of the full model in {case.name} (as Fig. 15.5). Colours are nodal "
        "averages, interpolated over each facet; grey facets carry no pressure; the cross marks "
        f"the contact point with the largest pressure. {'. '.join(notes)}."
    )
    return Drawn(
        figure=figure,
        stem="pressure",
        title=f"{case.name}: contact pressure of the full model",
        caption=caption,
        section=case.name,
    )
