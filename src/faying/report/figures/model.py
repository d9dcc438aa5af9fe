"""Figures of the model (as Fig. 15.2), and of bolt forces during tightening."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from faying.display.quantities import percent, quantity
from faying.display.style import INTERFACE_COLOUR, heading, plain
from faying.joint.picture import add_lines, name_axes, plot_bodies, plot_bolt_axis, title_above
from faying.reduction.methods import METHODS
from faying.report.figures.album import Drawn
from faying.report.figures.surface_map import outline
from faying.report.style import new_figure
from faying.study.results.values import Results


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
        f"One colour per body; thick lines: edges of the interfaces, not hidden{axis_note}."
    )
    return Drawn(figure=figure, stem="model", title="Model", caption=caption)


def plot_tightening(results: Results, axes: Axes) -> Axes:
    """Draw the force of each bolt after each stage; dotted lines are nominal preloads."""
    colours = [method.colour for method in METHODS.values()]
    stages = results.tightening_stages
    for number, (name, bolt) in enumerate(results.bolts.items()):
        shade = colours[number % len(colours)]
        axes.plot(np.arange(len(bolt.history)), bolt.history, "o-", color=shade, label=plain(name))
        axes.axhline(bolt.preload, color=shade, ls=":", lw=1.0)
    if 0 < len(stages) <= 14:  # more names would not fit
        axes.set_xticks(np.arange(len(stages)), [plain(s) for s in stages], rotation=35, ha="right")
    else:
        axes.set_xlabel("stage of tightening, bolt by bolt")
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
    )
