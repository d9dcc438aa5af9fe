"""The model (as Fig. 15.2), its pressure and sticking area (Fig. 15.3), bolts while tightened."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from faying.display.quantities import percent, quantity
from faying.display.style import INTERFACE_COLOUR, heading, plain
from faying.joint.picture import add_lines, name_axes, plot_bodies, plot_bolt_axis, title_above
from faying.reduction.methods import METHODS
from faying.report.figures.entry import Drawn
from faying.report.figures.pressure import POINTS, described_peak, plot_pressure, summary
from faying.report.figures.surface_map import draw_faces, map_panels, outline
from faying.report.style import colour, new_figure
from faying.study.results.values import InterfaceRecord, Results
from faying.units import Units


def model_figure(results: Results) -> Drawn:
    """Draw the model of a run."""
    units = results.unit_set
    figure = new_figure(9.0, 9.0)
    axes = figure.add_subplot(projection="3d")
    plot_bodies(results.nodes, results.blocks, results.body, axes)
    name_axes(axes, units.length)
    for record in results.interfaces.values():
        add_lines(axes, outline(record), color=INTERFACE_COLOUR, lw=1.4, zorder=4)
    for name, bolt in results.bolts.items():
        if bolt.axis is not None:
            plot_bolt_axis(axes, bolt.axis, name)
    elements = sum(len(block.ids) for block in results.blocks)
    n_body = int(results.body.max(initial=-1)) + 1
    size = f"{len(results.nodes)} nodes, {elements} solid elements, {n_body} bodies"
    title_above(axes, heading(f"{results.title}: {size}"))
    drawn = [name for name, bolt in results.bolts.items() if bolt.axis is not None]
    axis_note = f"; dash-dotted: axis of {', '.join(drawn)}" if drawn else ""
    extent = np.ptp(results.nodes, axis=0) if len(results.nodes) else np.zeros(3)
    measures = " × ".join(quantity(float(value), "") for value in extent)
    caption = (
        f"The finite element model (as Fig. 15.2): {size}, {measures} {units.length} over all. "
        f"One colour per body; thick lines: edges of the interfaces, drawn through{axis_note}."
    )
    return Drawn(figure=figure, stem="model", title="Model", caption=caption, section="model")


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


def plot_tightening(results: Results, axes: Axes) -> Axes:
    """Draw the force of each bolt after each stage; dotted lines are nominal preloads."""
    colours = [method.colour for method in METHODS.values()]
    stages = results.tightening_stages
    for number, (name, bolt) in enumerate(results.bolts.items()):
        shade = colours[number % len(colours)]
        axes.plot(np.arange(len(bolt.history)), bolt.history, "o-", color=shade, label=plain(name))
        axes.axhline(bolt.preload, color=shade, ls=":", lw=1.0)
    if 0 < len(stages) <= 14:  # as many names as fit
        axes.set_xticks(np.arange(len(stages)), [plain(s) for s in stages], rotation=35, ha="right")
    else:
        axes.set_xlabel("stage of tightening, one bolt after the other")
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(f"bolt force [{results.unit_set.force}]")
    if len(results.bolts) > 1:
        axes.legend()
    return axes


def tightening_figure(results: Results) -> Drawn | None:
    """Draw the tightening history; None without bolts or history."""
    if not any(len(bolt.history) for bolt in results.bolts.values()):
        return None
    units = results.unit_set
    figure = new_figure(7.5, 4.2)
    plot_tightening(results, figure.add_subplot())
    figure.suptitle("Bolt forces while tightening")
    ends = [
        f"{name} ends at {quantity(float(bolt.history[-1]), units.force, 4)} "
        f"({percent(abs(bolt.history[-1] / bolt.preload - 1)) if bolt.preload else '—'} from its "
        f"nominal {quantity(bolt.preload, units.force, 4)})"
        for name, bolt in results.bolts.items()
        if len(bolt.history)
    ]
    caption = (
        "Axial force of each bolt after each stage of tightening; dotted: nominal preload. "
        f"{'; '.join(ends)}."
    )
    return Drawn(
        figure=figure,
        stem="tightening",
        title="Tightening",
        caption=caption,
        section="preload",
    )
