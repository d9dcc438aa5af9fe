"""Deformed bodies in a static load case (as Fig. 15.4)."""

from typing import Any

import numpy as np

from faying.display.quantities import number, place, quantity
from faying.display.style import heading
from faying.joint.picture import name_axes, plot_bodies, title_above
from faying.report.figures.entry import Drawn
from faying.report.style import new_figure
from faying.study.results.values import CaseResult, Results
from faying.units import units_of

SHARE = 0.12
"""Largest drawn displacement over the size of the model."""


def exaggeration(results: Results, case: CaseResult) -> float:
    """Return a round factor, 1, 2 or 5 times a power of ten, that makes displacements visible."""
    moved = case.reference.nodal_displacement
    solid = results.body >= 0
    if moved is None or not solid.any():
        return 1.0
    largest = float(np.linalg.norm(moved[solid], axis=1).max())
    size = float(np.ptp(results.nodes[solid], axis=0).max())
    if largest <= 0 or size <= 0:
        return 1.0
    factor = SHARE * size / largest
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step <= factor / power + 1e-12))


def plot_deformed(results: Results, case: CaseResult, axes: Any) -> Any:
    """Draw the deformed bodies of a static case on 3D axes, exaggerated."""
    moved = case.reference.nodal_displacement
    if moved is None:
        return axes
    deformed = results.nodes + exaggeration(results, case) * moved
    solid = results.body >= 0
    drawn = np.where(solid[:, None], deformed, results.nodes)
    keep = results.nodes[solid] if solid.any() else results.nodes
    plot_bodies(drawn, results.blocks, results.body, axes, ghost=keep)
    name_axes(axes, units_of(results.units).length)
    return axes


def deformed_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw a static case's deformed shape; None where there is no displacement field."""
    moved = case.reference.nodal_displacement
    solid = np.flatnonzero(results.body >= 0)
    if moved is None or not len(solid):
        return None
    units, factor = units_of(results.units), exaggeration(results, case)
    figure = new_figure(9.0, 9.0)
    axes = figure.add_subplot(projection="3d")
    plot_deformed(results, case, axes)
    distance = np.linalg.norm(moved[solid], axis=1)
    worst = solid[distance.argmax()]
    size = float(np.ptp(results.nodes[solid], axis=0).max())
    where = place(results.nodes[worst], units.length, size)
    note = f"largest displacement {quantity(distance.max(), units.length)} at {where}"
    times = f"{number(factor, 1)} ×"
    title = f"{case.name}: deformed shape, {case.reference_model}, displacements {times}\n{note}"
    title_above(axes, heading(title))
    caption = (
        f"Bodies deformed by preload and {case.name} (as Fig. 15.4), displacements exaggerated "
        f"{times}; one colour per body. Bodies may seem to overlap or gape: gaps are exaggerated "
        f"as well. {note[0].upper()}{note[1:]}."
    )
    return Drawn(
        figure=figure,
        stem="deformed",
        title=f"{case.name}: deformed shape",
        caption=caption,
        section=case.name,
    )
