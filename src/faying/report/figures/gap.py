"""The gap before any load, and what a load opens or closes of the contact since the preload."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from faying._typing import Vector
from faying.digits import DECK_DIGITS
from faying.display.quantities import percent, place, quantity
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.pressure import POINTS
from faying.report.figures.surface_map import draw_map, draw_states, map_panels, name_states
from faying.report.style import GAP_MAP, OPEN_COLOUR
from faying.study.judgement.opening import Opening, opening
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units

STATES = {
    "pressed before and now": "#7FA6C9",
    "opened by the load": "#D95F02",
    "closed by the load": "#1B9E77",
    "open before and now": OPEN_COLOUR,
}
"""States of a contact point and their colours, in the order of their numbers."""


def plot_states(record: InterfaceRecord, pressure: Vector, axes: Axes, units: Units) -> Axes:
    """Draw which contact points (n_point,) the load has opened or closed since the preload."""
    pressed, now = record.preload_pressure > 0, pressure > 0
    states = np.select([pressed & now, pressed, now], [0, 1, 2], default=3)
    return draw_states(record, states, axes, units, STATES)


def plot_gap(
    record: InterfaceRecord, gap: Vector, axes: Axes, units: Units, *, largest: float
) -> Axes:
    """Draw the gap at the contact points (n_point,), white where closed, a cross at the largest.

    ``largest`` is the top of the colour scale.
    """
    return draw_map(
        record,
        np.maximum(gap, 0.0),
        axes,
        units,
        colours=GAP_MAP,
        limits=(0.0, largest),
        label=f"gap [{units.length}]",
        mark=True,
    )


def described_opening(record: InterfaceRecord, opened_area: Opening, units: Units) -> str:
    """Return how much opened, how far, and where."""
    opened = f"{percent(opened_area.opened)} of the area pressed after tightening opened"
    if opened_area.gap <= 0:
        return f"{opened}; no gap anywhere"
    size = float(np.ptp(record.points, axis=0).max())
    where = place(opened_area.point, units.length, size)
    return f"{opened}; largest gap {quantity(opened_area.gap, units.length)} at {where}"


def gap_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw contact lost and gained, and the gap, one row per interface.

    Transients at the instant of their largest gap; None where all is closed.
    """
    units, records = results.unit_set, results.interfaces
    all_openings = {name: opening(record, case) for name, record in records.items()}
    openings = {name: item for name, item in all_openings.items() if item is not None}
    widest = max(openings.values(), key=lambda item: item.gap, default=None)
    if widest is None or widest.gap <= 0:
        return None
    pressure, gap = (
        np.atleast_2d(field)[widest.instant or 0]
        for field in (case.reference.pressure, case.reference.gap)
    )
    drawn = {name: records[name] for name in openings}
    figure, rows = map_panels(drawn.values(), 2, 13.0, 0.9)
    notes = []
    for (left, right), (name, record) in zip(rows, drawn.items(), strict=True):
        points = slice(*record.slice)
        plot_states(record, pressure[points], left, units)
        plot_gap(record, gap[points], right, units, largest=widest.gap)
        note = f"{name}: {described_opening(record, openings[name], units)}"
        left.set_title(plain(f"{name}: contact since the preload"), loc="left")
        right.set_title(plain(f"{name}: gap"), loc="left")
        notes.append(note)
    name_states(figure, STATES)
    when = _when(case, widest, units)
    figure.suptitle(heading(f"{case.name}: what the load opens, {case.reference_model}{when}"))
    over_time = "" if case.times is None else " Shares of area are the largest over time."
    caption = (
        f"Left: where {case.name} opened or closed contact since the bolts were tightened. Right: "
        f"the gap, white where closed, a cross at the largest{when}. Values at the contact points, "
        f"each over the area nearest to it. {'. '.join(notes)}.{over_time}"
    )
    return Drawn(
        figure=figure,
        stem="gap",
        title=f"{case.name}: what the load opens",
        caption=caption,
        section=case.name,
    )


def _when(case: CaseResult, widest: Opening, units: Units) -> str:
    if case.times is None or widest.instant is None:
        return ""
    return f", at {quantity(float(case.times[widest.instant]), units.time)}"


def draw_initial_gaps(records: Mapping[str, InterfaceRecord], units: Units) -> Figure | None:
    """Draw the gaps of the interfaces whose surfaces part, one row each; None where none does."""
    parted = {name: record for name, record in records.items() if _parts(record)}
    if not parted:
        return None
    figure, rows = map_panels(parted.values(), 1, 9.0, 0.9)
    for (axes,), (name, record) in zip(rows, parted.items(), strict=True):
        largest = float(record.initial_gap.max())
        plot_gap(record, record.initial_gap, axes, units, largest=largest)
        title = f"{name}: up to {quantity(largest, units.length)} before any load"
        axes.set_title(plain(title), loc="left")
    return figure


def initial_gap_figure(results: Results) -> Drawn | None:
    """Draw the gaps of a run's interfaces; None where all surfaces touch."""
    figure = draw_initial_gaps(results.interfaces, results.unit_set)
    if figure is None:
        return None
    return Drawn(
        figure=figure,
        stem="initial_gap",
        title="Gap before any load",
        caption=f"Gap between the surfaces before any load, a cross at the largest. {POINTS}.",
        section="preload",
    )


def _parts(record: InterfaceRecord) -> bool:
    if not len(record.points):
        return False
    size = float(np.ptp(record.points, axis=0).max())
    return float(record.initial_gap.max()) > DECK_DIGITS * size
