"""The gap between the surfaces of a joint before any load."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from faying.digits import DECK_DIGITS
from faying.display.quantities import quantity
from faying.display.style import plain
from faying.report.figures.entry import Drawn
from faying.report.figures.gap import plot_gap
from faying.report.figures.pressure import POINTS
from faying.report.figures.surface_map import map_panels
from faying.study.results.values import InterfaceRecord, Results
from faying.units import Units


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
