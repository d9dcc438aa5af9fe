"""The mesh of the bodies with bolts and interfaces (as Fig. 15.2)."""

import numpy as np

from faying.display.quantities import quantity
from faying.display.style import INTERFACE_COLOUR, heading
from faying.joint.picture import add_lines, name_axes, plot_bodies, plot_bolt_axis, title_above
from faying.report.figures.entry import Drawn
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
        f"One colour per body; thick lines: edges of the interfaces, drawn through{axis_note}."
    )
    return Drawn(figure=figure, stem="model", title="Model", caption=caption, section="model")
