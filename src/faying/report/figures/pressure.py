"""Contact pressure of the full model in a static load case (as Fig. 15.5)."""

import numpy as np
from matplotlib.axes import Axes

from faying._typing import Vector
from faying.display.quantities import percent, place, quantity
from faying.display.style import PRESSURE_MAP, heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.surface_map import (
    Unrolled,
    best_plane,
    draw_map,
    looks_both_ways,
    map_panels,
)
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units

POINTS = (
    "Values at the contact points, each over the area nearest to it; a cross marks the largest, "
    "grey carries no pressure"
)


def plot_pressure(
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
    return draw_map(
        record,
        np.where(pressure > 0, pressure, np.nan),
        axes,
        units,
        colours=PRESSURE_MAP,
        limits=(0.0, largest or float(np.max(pressure, initial=0.0))),
        label=f"contact pressure [{units.pressure}]",
        mark=True,
    )


def described_peak(record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the largest pressure at a contact point and where it is."""
    if not len(pressure) or pressure.max() <= 0:
        return "no contact"
    point = record.points[pressure.argmax()]
    size = float(np.ptp(record.points, axis=0).max())
    where = place(point, units.length, size)
    return f"max {quantity(pressure.max(), units.pressure)} at {where}"


def open_share(record: InterfaceRecord, pressure: Vector) -> float:
    """Return the part of the area whose contact points carry no pressure."""
    total = float(record.weights.sum())
    return float(record.weights[pressure <= 0].sum() / total) if total > 0 else 0.0


def summary(name: str, record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return what a caption says about the pressure on one interface."""
    shape = "" if best_plane(record).flat else f", {_projected(record)}"
    average = float(record.nodal_average(pressure).max(initial=0.0))
    return (
        f"{name}{shape}: {described_peak(record, pressure, units)}; "
        f"nodal averages, max {quantity(average, units.pressure)}; "
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
    units, records = results.unit_set, results.interfaces
    figure, rows = map_panels(records.values(), 1, 7.0, 0.5)
    largest = float(case.reference.pressure.max(initial=0.0))
    notes = []
    for (axes,), (name, record) in zip(rows, records.items(), strict=True):
        pressures = case.reference.pressure[slice(*record.slice)]
        plot_pressure(record, pressures, axes, units, largest=largest)
        axes.set_title(plain(f"{name}: {described_peak(record, pressures, units)}"), loc="left")
        notes.append(summary(name, record, pressures, units))
    figure.suptitle(heading(f"{case.name}: contact pressure, {case.reference_model}"))
    return Drawn(
        figure=figure,
        stem="pressure",
        title=f"{case.name}: contact pressure of the {case.reference_model}",
        caption=(
            f"Contact pressure of the {case.reference_model} in {case.name} (as Fig. 15.5). "
            f"{POINTS}. {'. '.join(notes)}."
        ),
        section=case.name,
    )
