"""Contact pressure of the full model in a static load case (as Fig. 15.5)."""

import numpy as np
from matplotlib.axes import Axes

from faying._typing import Vector
from faying.display.quantities import percent, place, quantity
from faying.display.style import PRESSURE_MAP, heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.plane import Unrolled, best_plane, looks_both_ways
from faying.report.figures.surface_map import (
    colour_bar,
    draw_averages,
    draw_points,
    panel_size,
    prepare,
    scale,
)
from faying.report.style import new_figure
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units, units_of

POINTS = (
    "values at the contact points, each over the area nearest to it, where the cross marks the "
    "largest"
)
AVERAGES = "the same as nodal averages, interpolated over each facet, which smooth peaks"


def plot_pressure(
    record: InterfaceRecord,
    pressure: Vector,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw a contact pressure as nodal averages over the facets; grey around open points.

    Parameters
    ----------
    pressure : (n_point,)
        At the contact points of this interface.
    largest
        Top of the colour scale; the largest nodal average by default.
    """
    plane = best_plane(record)
    prepare(axes, record, plane, units)
    averages = record.nodal_average(pressure)
    top = float(averages.max(initial=0.0))
    colours = scale(PRESSURE_MAP, largest or top)
    draw_averages(axes, record, plane, averages, colours, open_points=pressure <= 0)
    colour_bar(axes, colours, f"contact pressure [{units.pressure}]")
    return axes


def plot_point_pressure(
    record: InterfaceRecord,
    pressure: Vector,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw a contact pressure at its contact points; grey where open, a cross at the largest.

    Parameters
    ----------
    pressure : (n_point,)
        At the contact points of this interface.
    largest
        Top of the colour scale; the largest pressure by default.
    """
    plane = best_plane(record)
    prepare(axes, record, plane, units)
    top = float(np.max(pressure, initial=0.0))
    colours = scale(PRESSURE_MAP, largest or top)
    draw_points(axes, record, plane, np.where(pressure > 0, pressure, np.nan), colours)
    if top > 0:
        x, y = plane.project(record.points[[pressure.argmax()]])[0]
        axes.plot(x, y, "x", color="white", ms=9, mew=3.5, zorder=3)
        axes.plot(x, y, "x", color="black", ms=8, mew=1.5, zorder=3)
    colour_bar(axes, colours, f"contact pressure [{units.pressure}]")
    return axes


def described_peak(record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the largest pressure at a contact point and where it is."""
    if not len(pressure) or pressure.max() <= 0:
        return "no contact"
    point = record.points[pressure.argmax()]
    size = float(np.ptp(record.points, axis=0).max())
    where = place(point, units.length, size)
    return f"max {quantity(pressure.max(), units.pressure)} at {where}"


def described_average(record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the largest nodal average."""
    largest = float(record.nodal_average(pressure).max(initial=0.0))
    return f"nodal averages, max {quantity(largest, units.pressure)}"


def open_share(record: InterfaceRecord, pressure: Vector) -> float:
    """Return the part of the area whose contact points carry no pressure."""
    total = float(record.weights.sum())
    return float(record.weights[pressure <= 0].sum() / total) if total > 0 else 0.0


def summary(name: str, record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return what a caption says about the pressure on one interface."""
    shape = "" if best_plane(record).flat else f", {_projected(record)}"
    return (
        f"{name}{shape}: {described_peak(record, pressure, units)}; "
        f"{described_average(record, pressure, units)}; "
        f"{percent(open_share(record, pressure))} without pressure"
    )


def _projected(record: InterfaceRecord) -> str:
    """Say what a map of an interface does that does not lie in a plane."""
    if looks_both_ways(record):
        return (
            "faces that look opposite ways, drawn one over the other (as interfaces of their own, "
            "from faces that are named in the source, each has a map)"
        )
    unrolled = isinstance(best_plane(record), Unrolled)
    return "unrolled" if unrolled else "curved, projected on its best plane"


def pressure_figure(results: Results, case: CaseResult) -> Drawn:
    """Draw the reference pressure of a static case on all interfaces, on one colour scale."""
    units = units_of(results.units)
    records = results.interfaces
    sizes = [panel_size(record, best_plane(record), 5.4) for record in records.values()]
    figure = new_figure(13.0, max(sum(height for _, height in sizes), 2.0) + 0.5)
    rows = figure.subplots(
        len(records), 2, squeeze=False, height_ratios=[height for _, height in sizes]
    )
    largest = float(case.reference.pressure.max(initial=0.0))
    notes = []
    for (left, right), (name, record) in zip(rows, records.items(), strict=True):
        pressures = case.reference.pressure[slice(*record.slice)]
        plot_point_pressure(record, pressures, left, units, largest=largest)
        plot_pressure(record, pressures, right, units, largest=largest)
        left.set_title(plain(f"{name}: {described_peak(record, pressures, units)}"), loc="left")
        right.set_title(plain(f"{name}: {described_average(record, pressures, units)}"), loc="left")
        notes.append(summary(name, record, pressures, units))
    figure.suptitle(heading(f"{case.name}: contact pressure, {case.reference_model}"))
    caption = (
        f"Contact pressure of the {case.reference_model} in {case.name} (as Fig. 15.5). "
        f"Left: {POINTS}. "
        f"Right: {AVERAGES}. Grey carries no pressure. {'. '.join(notes)}."
    )
    return Drawn(
        figure=figure,
        stem="pressure",
        title=f"{case.name}: contact pressure of the {case.reference_model}",
        caption=caption,
        section=case.name,
    )
