"""Where a joint slips when it vibrates in a mode, over the amplitude."""

import tomllib

import numpy as np

from faying.assessment.backbone import Backbone
from faying.display.quantities import quantity
from faying.display.style import heading, plain
from faying.report.figures.backbone import abscissa, unit_of
from faying.report.figures.entry import Drawn
from faying.report.figures.surface_map import draw_map, map_panels
from faying.report.style import NOTHING, SLIP_MAP
from faying.study.results.values import CaseResult, Results


def backbone_slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw how far points slip in a cycle, at the amplitudes a study names, or at three.

    Returns
    -------
    Drawn or None
        One row for each mode and interface; None for cases without backbones, or without slip.
    """
    records = results.rubbing
    amplitudes = _wanted(results, case)
    shown = {mode: _chosen(item, amplitudes) for mode, item in case.reference.backbones.items()}
    rows = [(mode, name) for mode in shown if shown[mode] for name in records]
    if not rows:
        return None
    units = results.unit_set
    columns = max(3, *map(len, shown.values()))
    figure, panels = map_panels([records[name] for _, name in rows], columns, 13.0, 0.7)
    for line, (mode, name) in zip(panels, rows, strict=True):
        record, backbone = records[name], case.reference.backbones[mode]
        distance = np.asarray(backbone.slip_distance)[:, slice(*record.slice)]
        for axes in line[len(shown[mode]) :]:
            axes.set_axis_off()
        for axes, index in zip(line, shown[mode], strict=False):
            largest = float(distance[index].max(initial=0.0))
            draw_map(
                record,
                np.where(distance[index] > NOTHING * largest, distance[index], np.nan),
                axes,
                units,
                colours=SLIP_MAP,
                limits=(0.0, largest),
                label=f"slip in a cycle [{units.length}]",
            )
            size = quantity(float(abscissa(backbone)[index]), unit_of(backbone, units))
            reached = f"{backbone.over} {size}"
            axes.set_title(plain(f"mode {mode}, {name}: {reached}"), loc="left")
    which = "the first, the middle and the last amplitude of each mode that slips somewhere"
    if amplitudes:
        which = "the amplitudes computed nearest to those the study names"
    figure.suptitle(heading(f"{case.name}: where the joint slips, full model"))
    return Drawn(
        figure=figure,
        stem="backbone_slip",
        title=f"{case.name}: slip over amplitude",
        caption=(
            f"How far contact points slip in a cycle while they are pressed on, at {which}. Grey "
            "does not slip."
        ),
        section=case.name,
    )


def _wanted(results: Results, case: CaseResult) -> list[float]:
    """Return the amplitudes whose maps the study wants; none where it does not say."""
    try:
        cases = tomllib.loads(results.study_text).get("load_case", [])
    except tomllib.TOMLDecodeError:
        return []
    return next((entry.get("maps", []) for entry in cases if entry.get("name") == case.name), [])


def _chosen(backbone: Backbone, amplitudes: list[float]) -> list[int]:
    """Return the amplitudes nearest to those wanted, or the first, middle and last that slip."""
    if backbone.slip_distance is None:
        return []
    if amplitudes:
        apart = np.abs(
            np.log(np.divide.outer(np.array(amplitudes, dtype=float), abscissa(backbone)))
        )
        return [int(index) for index in np.unique(apart.argmin(axis=1))]
    slips = np.flatnonzero(backbone.energy_per_cycle > 0)
    if not len(slips):
        return []
    return [int(index) for index in np.unique(slips[[0, len(slips) // 2, -1]])]
