"""Pressure of the tightened joint and its sticking area (as Fig. 15.3)."""

from matplotlib.axes import Axes

from faying.display.style import plain
from faying.report.figures.entry import Drawn
from faying.report.figures.plane import best_plane
from faying.report.figures.pressure import (
    AVERAGES,
    POINTS,
    described_average,
    described_peak,
    plot_point_pressure,
    plot_pressure,
    summary,
)
from faying.report.figures.surface_map import draw_edges, panel_size, prepare
from faying.report.style import colour, new_figure
from faying.study.results.values import InterfaceRecord, Results
from faying.units import Units, units_of


def plot_sticking(record: InterfaceRecord, axes: Axes, units: Units) -> Axes:
    """Mark the node pairs that stick in tangential direction."""
    plane = best_plane(record)
    prepare(axes, record, plane, units)
    draw_edges(axes, record, plane)
    flat = plane.project(record.pair_points)
    stuck = record.stuck.astype(bool)
    axes.plot(*flat[~stuck].T, ".", color="0.6", ms=3)
    axes.plot(*flat[stuck].T, "o", color=colour("jim-b"), ms=5)
    return axes


def preload_figure(results: Results) -> Drawn:
    """Draw preload pressure by interface, and the sticking area where nothing has friction."""
    units = units_of(results.units)
    records = results.interfaces
    tied = not results.rubbing
    sizes = [panel_size(record, best_plane(record), 4.2) for record in records.values()]
    figure = new_figure(16.0 if tied else 11.0, max(sum(height for _, height in sizes), 2.0) + 0.5)
    rows = figure.subplots(
        len(records),
        3 if tied else 2,
        squeeze=False,
        height_ratios=[height for _, height in sizes],
    )
    notes = []
    for panels, (name, record) in zip(rows, records.items(), strict=True):
        pressures = record.preload_pressure
        top = float(pressures.max(initial=0.0))
        plot_point_pressure(record, pressures, panels[0], units)
        plot_pressure(record, pressures, panels[1], units, largest=top)
        panels[0].set_title(
            plain(f"{name}: {described_peak(record, pressures, units)}"), loc="left"
        )
        panels[1].set_title(
            plain(f"{name}: {described_average(record, pressures, units)}"), loc="left"
        )
        note = summary(name, record, pressures, units)
        if tied:
            plot_sticking(record, panels[2], units)
            count = f"{int(record.stuck.sum())} of {len(record.stuck)} node pairs stick"
            panels[2].set_title(plain(f"{name}: {count} (large dots)"), loc="left")
            note += f"; {count}"
        notes.append(note)
    title = "Preload and sticking area" if tied else "Preload"
    figure.suptitle(
        "Preload: contact pressure and sticking area" if tied else "Preload: contact pressure"
    )
    maps = f"Left: {POINTS}. {'Middle' if tied else 'Right'}: {AVERAGES}. Grey carries no pressure."
    caption = f"Contact pressure after tightening. {maps} {'. '.join(notes)}."
    if tied:
        caption = (
            "Contact pressure after tightening, before any pair was tied, and the node pairs tied "
            "in tangential direction in all load cases because their pressure passes the study's "
            f"threshold (as Fig. 15.3). {maps} "
            f"Right: the node pairs, large dots where they stick. {'. '.join(notes)}."
        )
    return Drawn(figure=figure, stem="preload", title=title, caption=caption, section="preload")
