"""Maps of contact: gap, pressure (as Figs. 15.3, 15.5), opening, slip and fretting."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.display.quantities import number, percent, place, quantity
from faying.display.style import PRESSURE_MAP
from faying.report.figures.album import Drawn
from faying.report.figures.surface_map import (
    Unrolled,
    best_plane,
    draw_faces,
    draw_map,
    draw_states,
    looks_both_ways,
    map_figure,
)
from faying.report.slip import shown_slip, slipping
from faying.report.style import GAP_MAP, OPEN_COLOUR, SLIP_MAP, colour
from faying.study.judgement.opening import Opening, opening
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units

POINTS = (
    "Each contact point's value is drawn over the area nearest to it; a cross marks the largest, "
    "grey is without pressure"
)

OPENING_STATES = {
    "pressed before and now": "#7FA6C9",
    "opened by the load": "#D95F02",
    "closed by the load": "#1B9E77",
    "open before and now": OPEN_COLOUR,
}
SLIP_STATES = {"open": OPEN_COLOUR, "sticks": "#7FA6C9", "slips": "#D95F02"}
"""Colours of the states of a contact point, in the order of their numbers."""


def plot_pressure(
    record: InterfaceRecord,
    pressure: Vector,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw the pressure at contact points; grey where open, with a cross at the largest.

    Parameters
    ----------
    pressure : (n_point,)
        Pressure at the contact points of the interface.
    largest
        Top of the colour scale; the largest pressure by default.
    """
    return draw_map(
        record,
        np.where(pressure > 0, pressure, np.nan),
        axes,
        units,
        colours=PRESSURE_MAP,
        limits=(0.0, largest or float(np.max(pressure, initial=0.0))),
        label=f"contact pressure [{units.pressure}]",
        mark=True,
    )


def _at(record: InterfaceRecord, point: Vector, units: Units) -> str:
    return place(point, units.length, float(np.ptp(record.points, axis=0).max()))


def described_peak(record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the largest pressure at a contact point, and its place, as text."""
    if not len(pressure) or pressure.max() <= 0:
        return "no contact"
    where = _at(record, record.points[pressure.argmax()], units)
    return f"max {quantity(pressure.max(), units.pressure)} at {where}"


def summary(name: str, record: InterfaceRecord, pressure: Vector, units: Units) -> str:
    """Return the caption for the pressure on an interface."""
    shape = "" if best_plane(record).flat else f", {_projected(record)}"
    average = float(record.nodal_average(pressure).max(initial=0.0))
    total = float(record.weights.sum())
    open_share = float(record.weights[pressure <= 0].sum() / total) if total > 0 else 0.0
    return (
        f"{name}{shape}: {described_peak(record, pressure, units)}; "
        f"nodal averages, max {quantity(average, units.pressure)}; "
        f"{percent(open_share)} without pressure"
    )


def _projected(record: InterfaceRecord) -> str:
    """Return how a curved interface is mapped, as text."""
    if looks_both_ways(record):
        return (
            "opposite faces, drawn over each other (to get separate maps, define separate "
            "interfaces from named faces of the source)"
        )
    unrolled = isinstance(best_plane(record), Unrolled)
    return "unrolled" if unrolled else "curved, projected on its best plane"


def pressure_figure(results: Results, case: CaseResult) -> Drawn:
    """Draw the pressure of a static case on all interfaces, on a common colour scale."""
    units, records, pressure = results.unit_set, results.interfaces, case.reference.pressure
    largest = float(pressure.max(initial=0.0))

    def panel(name: str, record: InterfaceRecord, axes: Axes) -> str:
        pressures = pressure[slice(*record.slice)]
        plot_pressure(record, pressures, axes, units, largest=largest)
        return f"{name}: {described_peak(record, pressures, units)}"

    notes = [
        summary(name, record, pressure[slice(*record.slice)], units)
        for name, record in records.items()
    ]
    title = f"{case.name}: contact pressure, {case.reference_model}"
    return Drawn(
        figure=map_figure(records, [panel], 7.0, 0.5, title),
        stem="pressure",
        title=f"{case.name}: contact pressure of the {case.reference_model}",
        caption=(
            f"Contact pressure of the {case.reference_model} in {case.name} (as Fig. 15.5). "
            f"{POINTS}. {'. '.join(notes)}."
        ),
    )


def preload_figure(results: Results) -> Drawn:
    """Draw the preload pressure by interface, and the sticking area if pairs are tied."""
    units, records = results.unit_set, results.interfaces
    tied = any(record.stuck.any() for record in records.values())

    def pressed(name: str, record: InterfaceRecord, axes: Axes) -> str:
        plot_pressure(record, record.preload_pressure, axes, units)
        return f"{name}: {described_peak(record, record.preload_pressure, units)}"

    def sticking(name: str, record: InterfaceRecord, axes: Axes) -> str:
        flat = draw_faces(record, axes, units).project(record.pair_points)
        stuck = record.stuck.astype(bool)
        axes.plot(*flat[~stuck].T, ".", color="0.6", ms=3)
        axes.plot(*flat[stuck].T, "o", color=colour("jim-b"), ms=5)
        return f"{name}: {_stuck(record)} (large dots)"

    title = "Preload: contact pressure" + " and sticking area" * tied
    panels = [pressed, sticking] if tied else [pressed]
    notes = [
        summary(name, record, record.preload_pressure, units)
        + (f"; {_stuck(record)}" if tied else "")
        for name, record in records.items()
    ]
    caption = "Contact pressure after tightening."
    if tied:
        caption = (
            "Left: contact pressure after tightening, before any pair was tied. Right: the node "
            "pairs, large dots where they are tied in tangential direction in all load cases "
            "because their pressure exceeds the study's threshold (as Fig. 15.3)."
        )
    return Drawn(
        figure=map_figure(records, panels, 5.5 * len(panels), 0.5, title),
        stem="preload",
        title="Preload and sticking area" if tied else "Preload",
        caption=f"{caption} {POINTS}. {'. '.join(notes)}.",
    )


def _stuck(record: InterfaceRecord) -> str:
    return f"{int(record.stuck.sum())} of {len(record.stuck)} node pairs stick"


def plot_states(record: InterfaceRecord, pressure: Vector, axes: Axes, units: Units) -> Axes:
    """Draw which contact points (n_point,) the load opened or closed since tightening."""
    pressed, now = record.preload_pressure > 0, pressure > 0
    states = np.select([pressed & now, pressed, now], [0, 1, 2], default=3)
    return draw_states(record, states, axes, units, OPENING_STATES)


def plot_gap(
    record: InterfaceRecord, gap: Vector, axes: Axes, units: Units, *, largest: float
) -> Axes:
    """Draw the gap at contact points (n_point,), white where closed, a cross at the largest.

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
    """Return the opened area, the largest gap and its place, as text."""
    opened = f"{percent(opened_area.opened)} of the area pressed after tightening opened"
    if opened_area.gap <= 0:
        return f"{opened}; no gap anywhere"
    where = _at(record, opened_area.point, units)
    return f"{opened}; largest gap {quantity(opened_area.gap, units.length)} at {where}"


def gap_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw lost and gained contact, and the gap, one row per interface.

    A transient is drawn at the instant of its largest gap. None where all points are closed.
    """
    units = results.unit_set
    all_openings = {name: opening(record, case) for name, record in results.interfaces.items()}
    openings = {name: item for name, item in all_openings.items() if item is not None}
    widest = max(openings.values(), key=lambda item: item.gap, default=None)
    if widest is None or widest.gap <= 0:
        return None
    pressure, gap = (
        np.atleast_2d(field)[widest.instant or 0]
        for field in (case.reference.pressure, case.reference.gap)
    )
    largest = widest.gap

    def left(name: str, record: InterfaceRecord, axes: Axes) -> str:
        plot_states(record, pressure[slice(*record.slice)], axes, units)
        return f"{name}: contact since the preload"

    def right(name: str, record: InterfaceRecord, axes: Axes) -> str:
        plot_gap(record, gap[slice(*record.slice)], axes, units, largest=largest)
        return f"{name}: gap"

    drawn = {name: results.interfaces[name] for name in openings}
    notes = [f"{n}: {described_opening(drawn[n], openings[n], units)}" for n in drawn]
    when = over_time = ""
    if case.times is not None and widest.instant is not None:
        when = f", at {quantity(float(case.times[widest.instant]), units.time)}"
        over_time = " Shares of area are the largest over time."
    title = f"{case.name}: opening under load, {case.reference_model}{when}"
    return Drawn(
        figure=map_figure(drawn, [left, right], 13.0, 0.9, title, OPENING_STATES),
        stem="gap",
        title=f"{case.name}: opening under load",
        caption=(
            f"Left: where {case.name} opened or closed contact since the bolts were tightened. "
            f"Right: the gap, white where closed, a cross at the largest{when}. Each contact "
            f"point's value is drawn over the area nearest to it. {'. '.join(notes)}.{over_time}"
        ),
    )


def draw_initial_gaps(records: Mapping[str, InterfaceRecord], units: Units) -> Figure | None:
    """Draw the gaps of the interfaces whose surfaces part, one row each; None where none does."""
    sizes = {n: np.ptp(r.points, axis=0).max() for n, r in records.items() if len(r.points)}
    seen = {name: DECK_DIGITS * size for name, size in sizes.items()}

    def panel(name: str, record: InterfaceRecord, axes: Axes) -> str:
        largest, deepest = float(record.initial_gap.max()), -float(record.initial_gap.min())
        plot_gap(record, record.initial_gap, axes, units, largest=largest)
        overlap = f", overlap up to {quantity(deepest, units.length)}"
        title = f"{name}: up to {quantity(largest, units.length)} before any load"
        return f"{title}{overlap if deepest > seen[name] else ''}"

    parted = {n: records[n] for n, least in seen.items() if records[n].initial_gap.max() > least}
    return map_figure(parted, [panel], 9.0, 0.9, "") if parted else None


def initial_gap_figure(results: Results) -> Drawn | None:
    """Draw the initial gaps of a run's interfaces; None where all surfaces touch."""
    figure = draw_initial_gaps(results.interfaces, results.unit_set)
    if figure is None:
        return None
    return Drawn(
        figure=figure,
        stem="initial_gap",
        title="Gap before any load",
        caption=(
            "Gap between the surfaces before any load, a cross at the largest, white where they "
            f"touch or overlap. {POINTS}."
        ),
    )


def plot_traction(
    record: InterfaceRecord,
    pressure: Vector,
    traction: Matrix,
    axes: Axes,
    units: Units,
    *,
    largest: float | None = None,
) -> Axes:
    """Draw tractions as arrows at the node pairs, over the contact pressure (n_point,).

    Tractions (n_point, 3) act on the plus side. ``largest`` is the top of the colour scale of the
    pressure.
    """
    plane = best_plane(record)
    plot_pressure(record, pressure, axes, units, largest=largest)
    averages = record.nodal_average(traction)
    size = float(np.linalg.norm(averages, axis=1).max(initial=0.0))
    if size > 0:
        strong = np.linalg.norm(averages, axis=1) > 0.02 * size
        x, y = plane.project(record.pair_points[strong]).T
        right, up = plane.directions(record.pair_points[strong], averages[strong]).T
        edge = np.sqrt(float(record.weights.sum()) / max(len(record.pairs), 1))
        arrows = axes.quiver(
            x, y, right, up, angles="xy", scale_units="xy", scale=size / (1.4 * edge),
            color="white", edgecolor="black", linewidth=0.6, width=0.005, zorder=4, pivot="mid",
        )  # fmt: skip
        axes.quiverkey(
            arrows, 0.86, 1.05, size, quantity(size, units.pressure), labelpos="E", color="black"
        )
    return axes


def slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw tractions over pressure, and the states of the points, one row per interface.

    A path or transient is drawn where its slipping area is largest, a static load at its full
    value; None without friction.
    """
    records, units = results.rubbing, results.unit_set
    shown = shown_slip(case, units)
    if shown is None or not records:
        return None
    tractions, status = shown.record.traction[shown.at], shown.record.status[shown.at]
    pressure, largest = shown.pressure, float(shown.pressure.max(initial=0.0))

    def said(record: InterfaceRecord) -> tuple[str, str]:
        points = slice(*record.slice)
        top = float(np.linalg.norm(tractions[points], axis=1).max(initial=0.0))
        slips = percent(slipping(record, status[points]))
        return quantity(top, units.pressure), f"{slips} of the area in contact slip"

    def left(name: str, record: InterfaceRecord, axes: Axes) -> str:
        points = slice(*record.slice)
        plot_traction(record, pressure[points], tractions[points], axes, units, largest=largest)
        return f"{name}: max traction {said(record)[0]}"

    def right(name: str, record: InterfaceRecord, axes: Axes) -> str:
        draw_states(record, status[slice(*record.slice)], axes, units, SLIP_STATES)
        return f"{name}: {said(record)[1]}"

    notes = [
        f"{name}: traction up to {top}, {slips}"
        for name, record in records.items()
        for top, slips in [said(record)]
    ]
    title = f"{case.name}: traction and slip, {case.reference_model}, {shown.when}"
    return Drawn(
        figure=map_figure(records, [left, right], 13.0, 1.0, title, SLIP_STATES),
        stem="slip",
        title=f"{case.name}: traction and slip",
        caption=(
            f"{case.reference_model.capitalize()}, {shown.when}. Left: traction on the plus side "
            "as nodal averages, arrows over the contact pressure. Right: contact points, each over "
            f"the area nearest to it, that are open, stick or slip. {'. '.join(notes)}."
        ),
    )


def fretting_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw slip range, and slip range times traction, at the largest amplitude of cycles."""
    records, units, cycles = results.rubbing, results.unit_set, [*case.reference.cycles.values()]
    if not cycles or not records or not cycles[-1].fretting.any():
        return None
    worn = cycles[-1]

    def drawn(record: InterfaceRecord, values: Vector, axes: Axes, label: str) -> None:
        shown, limits = values[slice(*record.slice)], (0.0, float(values.max(initial=0.0)))
        field = np.where(shown > 0, shown, np.nan)
        draw_map(record, field, axes, units, colours=SLIP_MAP, limits=limits, label=label)

    def left(name: str, record: InterfaceRecord, axes: Axes) -> str:
        drawn(record, worn.slip_range, axes, f"slip range [{units.length}]")
        return name

    def right(name: str, record: InterfaceRecord, axes: Axes) -> str:
        text = f"slip range × traction [{units.of('force/length')}]"
        drawn(record, worn.fretting, axes, text)
        return name

    weights = np.concatenate([record.weights for record in results.interfaces.values()])
    share = float(weights[worn.slip_range > 0].sum() / weights.sum())
    title = f"{case.name}: fretting at amplitude {number(worn.amplitude)}, full model"
    return Drawn(
        figure=map_figure(records, [left, right], 13.0, 0.7, title),
        stem="fretting",
        title=f"{case.name}: fretting",
        caption=(
            "Left: range of slip of a contact point in a cycle. Right: slip range times its "
            "largest traction, the fretting parameter of Ruiz, Boddington & Chen 1984. Grey "
            f"points do not slip. {percent(share)} of all contact area slips during the cycle."
        ),
    )
