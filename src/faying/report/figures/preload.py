"""Pressure of the tightened joint and its sticking area (as Fig. 15.3)."""

from matplotlib.axes import Axes

from faying.display.style import plain
from faying.report.figures.entry import Drawn
from faying.report.figures.pressure import POINTS, described_peak, plot_pressure, summary
from faying.report.figures.surface_map import draw_faces, map_panels
from faying.report.style import colour
from faying.study.results.values import InterfaceRecord, Results
from faying.units import Units


def plot_sticking(record: InterfaceRecord, axes: Axes, units: Units) -> Axes:
    """Mark the node pairs that stick in tangential direction."""
    flat = draw_faces(record, axes, units).project(record.pair_points)
    stuck = record.stuck.astype(bool)
    axes.plot(*flat[~stuck].T, ".", color="0.6", ms=3)
    axes.plot(*flat[stuck].T, "o", color=colour("jim-b"), ms=5)
    return axes


def preload_figure(results: Results) -> Drawn:
    """Draw preload pressure by interface, and the sticking area where nothing has friction."""
    units, records = results.unit_set, results.interfaces
    tied = not results.rubbing
    columns = 2 if tied else 1
    figure, rows = map_panels(records.values(), columns, 5.5 * columns, 0.5)
    notes = []
    for panels, (name, record) in zip(rows, records.items(), strict=True):
        pressures = record.preload_pressure
        plot_pressure(record, pressures, panels[0], units)
        peak = described_peak(record, pressures, units)
        panels[0].set_title(plain(f"{name}: {peak}"), loc="left")
        note = summary(name, record, pressures, units)
        if tied:
            plot_sticking(record, panels[1], units)
            count = f"{int(record.stuck.sum())} of {len(record.stuck)} node pairs stick"
            panels[1].set_title(plain(f"{name}: {count} (large dots)"), loc="left")
            note += f"; {count}"
        notes.append(note)
    title = "Preload and sticking area" if tied else "Preload"
    figure.suptitle(
        "Preload: contact pressure and sticking area" if tied else "Preload: contact pressure"
    )
    caption = f"Contact pressure after tightening. {POINTS}. {'. '.join(notes)}."
    if tied:
        caption = (
            "Left: contact pressure after tightening, before any pair was tied. Right: the node "
            "pairs, large dots where they are tied in tangential direction in all load cases "
            "because their pressure passes the study's threshold (as Fig. 15.3). "
            f"{POINTS}. {'. '.join(notes)}."
        )
    return Drawn(figure=figure, stem="preload", title=title, caption=caption, section="preload")
