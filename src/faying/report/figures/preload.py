"""Pressure of the tightened joint and its sticking area (as Fig. 15.3)."""

from matplotlib.axes import Axes

from faying.report.figures.entry import Drawn
from faying.report.figures.pressure import described_peak, open_share, plot_pressure
from faying.report.figures.surface_map import best_plane, draw_edges, panel_size, prepare
from faying.report.quantities import percent
from faying.report.style import METHOD_COLOURS, new_figure, plain
from faying.study.results import InterfaceRecord, Results
from faying.study.units import Units, units_of


def plot_sticking(record: InterfaceRecord, axes: Axes, units: Units) -> Axes:
    """Mark the node pairs that stick in tangential direction."""
    plane = best_plane(record)
    prepare(axes, record, plane, units)
    draw_edges(axes, record, plane)
    flat = plane.project(record.pair_points)
    stuck = record.stuck.astype(bool)
    axes.plot(*flat[~stuck].T, ".", color="0.6", ms=3, label="free to slide")
    axes.plot(*flat[stuck].T, "o", color=METHOD_COLOURS["jim-b"], ms=6, label="sticks")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, borderaxespad=0.6)
    return axes


def preload_figure(results: Results) -> Drawn:
    """Draw preload pressure and sticking area, one row per interface."""
    units = units_of(results.units)
    records = results.interfaces
    sizes = [panel_size(record, best_plane(record), 5.2) for record in records.values()]
    figure = new_figure(12.6, max(sum(height + 0.4 for _, height in sizes), 2.4))
    rows = figure.subplots(
        len(records), 2, squeeze=False, height_ratios=[height for _, height in sizes]
    )
    notes = []
    for (left, right), (name, record) in zip(rows, records.items(), strict=True):
        plot_pressure(record, record.preload_pressure, left, units)
        plot_sticking(record, right, units)
        note = described_peak(record, record.preload_pressure, units)
        count = f"{int(record.stuck.sum())} of {len(record.stuck)} node pairs stick"
        left.set_title(plain(f"{name}: {note.replace(', nodal', chr(10) + 'nodal')}"), loc="left")
        right.set_title(plain(f"{name}: {count}"), loc="left")
        open_part = percent(open_share(record, record.preload_pressure))
        notes.append(f"{name}: {note}; {open_part} open; {count}")
    figure.suptitle("Preload: contact pressure and sticking area")
    caption = (
        "Contact pressure after tightening, before any pair was tied (left), and the node pairs "
        "tied in tangential direction in all later load cases because their pressure passes the "
        "study's threshold (right), as Fig. 15.3. Colours are nodal averages; grey is open. "
        f"{'. '.join(notes)}."
    )
    return Drawn(
        figure=figure,
        stem="preload",
        title="Preload and sticking area",
        caption=caption,
        section="preload",
    )
