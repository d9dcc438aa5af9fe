"""Figures of backbones: frequency and damping over amplitude, measured curves, loops, slip."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from faying._typing import Vector
from faying.assessment.backbone import Backbone, amplitude_unit
from faying.assessment.backbone_band import BackboneBand
from faying.assessment.measured_curve import MeasuredCurve
from faying.display.quantities import quantity
from faying.display.style import heading
from faying.report.figures.album import Drawn
from faying.report.figures.surface_map import Panel, draw_map, map_figure
from faying.report.style import SLIP_MAP, SMALLEST_DRAWN, new_figure
from faying.study.keys.measurements import sentence
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units, units_of


def abscissa(backbone: Backbone) -> Vector:
    """Return the abscissa of a backbone (n,): its amplitudes, or its energies."""
    return backbone.energy if backbone.over == "energy" else backbone.amplitude


def unit_of(backbone: Backbone, units: Units) -> str:
    """Return the unit of the abscissa."""
    if backbone.over == "energy":
        return units.of("force·length")
    return "rad" if ".r" in backbone.measured_at else units.length


def plot_damping(
    case: CaseResult, axes: Axes, units: Units, measured: Sequence[MeasuredCurve] = ()
) -> Axes:
    """Draw damping over amplitude: in total, of the damping matrix, and by Masing's rule.

    Triangles are measured values.
    """
    curves = case.reference.backbones
    largest = max(float(backbone.damping_ratio.max()) for backbone in curves.values())
    for i, (mode, backbone) in enumerate(curves.items()):
        seen = backbone.damping_ratio > SMALLEST_DRAWN * largest
        label = f"mode {mode}, {quantity(backbone.small_frequency, units.of('1/time'))}"
        along = abscissa(backbone)
        axes.plot(along[seen], backbone.damping_ratio[seen], "o-", color=f"C{i}", label=label)
        if backbone.linear_damping.max(initial=0.0) > 0:
            axes.plot(along, backbone.linear_damping, ":", color=f"C{i}")
        if backbone.masing_damping is not None:
            masing = backbone.masing_damping + backbone.linear_damping
            seen = masing > SMALLEST_DRAWN * largest
            axes.plot(along[seen], masing[seen], "x--", color=f"C{i}", linewidth=0.8)
    for test in measured:
        if test.damping_ratio is not None:
            axes.plot(test.amplitude, test.damping_ratio, "^k", mfc="none", label=test.name)
    if largest > 0:
        axes.set_yscale("log")
    _over_amplitudes(axes)
    axes.set_ylabel("damping ratio")
    axes.legend()
    return axes


def plot_shift(case: CaseResult, axes: Axes, measured: Sequence[MeasuredCurve] = ()) -> Axes:
    """Draw the relative change of frequency from small vibrations over amplitude."""
    for i, backbone in enumerate(case.reference.backbones.values()):
        shift = 100 * (backbone.frequency / backbone.small_frequency - 1)
        along, gross = abscissa(backbone), backbone.macroslip
        axes.semilogx(along, shift, "o-", color=f"C{i}")
        axes.semilogx(along[gross], shift[gross], "s", ms=9, mfc="none", color=f"C{i}")
    for test in measured:
        computed = case.reference.backbones.get(str(test.mode))
        if computed is not None and test.frequency is not None:
            off = 100 * (test.frequency / computed.small_frequency - 1)
            axes.semilogx(test.amplitude, off, "^k", mfc="none")
    axes.set_ylabel("change of frequency [%]")
    return axes


def plot_modal_loops(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the loop of the largest amplitude of each mode, without its linear elastic part."""
    for i, (mode, backbone) in enumerate(case.reference.backbones.items()):
        load, modal = (
            backbone.loop_load[-1] / backbone.load[-1],
            backbone.loop_modal[-1] / backbone.modal_amplitude[-1],
        )
        widest = quantity(float(abscissa(backbone)[-1]), unit_of(backbone, units))
        label = f"mode {mode}, {backbone.over} {widest}"
        axes.plot(modal, load - modal, ".-", color=f"C{i}", label=label)
    axes.set_xlabel("modal displacement over its amplitude")
    axes.set_ylabel("load over its amplitude, less the same")
    axes.legend()
    return axes


def masing_remark(mode: str, backbone: Backbone) -> str:
    """Return a sentence about the error of Masing's rule; empty without it or without slip."""
    deviation = backbone.masing_deviation
    if deviation is None or not (backbone.friction_damping > 0).any():
        return ""
    off = 100 * deviation[backbone.friction_damping > 0]
    return (
        f" By Masing's rule (crosses) friction damping of mode {mode} is off by {off.min():+.2g} "
        f"to {off.max():+.2g} %; negative values of the rule are not drawn."
    )


def backbone_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the backbones of a case; None for cases without."""
    curves = case.reference.backbones
    if not curves:
        return None
    units = results.unit_set
    figure = new_figure(13.0, 6.2)
    grid = figure.add_gridspec(2, 2)
    damping = figure.add_subplot(grid[0, 0])
    shift = figure.add_subplot(grid[1, 0], sharex=damping)
    loops = figure.add_subplot(grid[:, 1])
    tests = [test for test in results.measurements if test.case == case.name]
    plot_damping(case, damping, units, tests)
    plot_shift(case, shift, tests)
    plot_modal_loops(case, loops, units)
    places = sorted({backbone.measured_at for backbone in curves.values()})
    backbone = next(iter(curves.values()))
    what = (
        "energy of the vibration"
        if backbone.over == "energy"
        else f"amplitude at {', '.join(places)}"
    )
    shift.set_xlabel(f"{what} [{unit_of(backbone, units)}]")
    loops.set_title("loops at the largest amplitude", loc="left")
    figure.suptitle(heading(f"{case.name}: backbones, full model"))
    modes: dict[str, list[str]] = {}
    for mode, backbone in curves.items():
        for text in backbone.remarks:
            modes.setdefault(text, []).append(mode)
    remarks = " ".join(
        f"Mode{'s' if len(those) > 1 else ''} {', '.join(those)}: {text}."
        for text, those in modes.items()
    )
    remarks += "".join(masing_remark(mode, backbone) for mode, backbone in curves.items())
    said = "; ".join(sentence(test, curves) for test in tests)
    remarks += f" Measured: {said}." if said else ""
    return Drawn(
        figure=figure,
        stem="backbones",
        title=f"{case.name}: damping and frequency over amplitude",
        caption=(
            "Left: damping ratio by full cycles, of friction and the damping matrix together "
            "(dotted: the damping matrix alone), and change of frequency from small vibrations; "
            "squares: all closed points of an interface slip. Legends give the frequency "
            "of small vibrations. Right: load over modal displacement, both over their "
            f"amplitudes, without the straight line of an elastic joint. {remarks}"
        ).strip(),
    )


def backbone_slip_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the slip of points in a cycle, at the amplitudes of a study, or at three.

    The figure has a row for each mode and interface; None for cases without backbones or slip.
    """
    amplitudes, units = _map_amplitudes(results, case), results.unit_set
    shown = {m: _map_indices(item, amplitudes) for m, item in case.reference.backbones.items()}
    rows = {
        f"mode {mode}, {name}": (mode, record)
        for mode in shown
        if shown[mode]
        for name, record in results.rubbing.items()
    }
    if not rows:
        return None

    def panel(column: int, row: str, record: InterfaceRecord, axes: Axes) -> str:
        mode = rows[row][0]
        if column >= len(shown[mode]):
            axes.set_axis_off()
            return ""
        backbone, index = case.reference.backbones[mode], shown[mode][column]
        distance = np.asarray(backbone.slip_distance)[index, slice(*record.slice)]
        largest = float(distance.max(initial=0.0))
        draw_map(
            record,
            np.where(distance > SMALLEST_DRAWN * largest, distance, np.nan),
            axes,
            units,
            colours=SLIP_MAP,
            limits=(0.0, largest),
            label=f"slip in a cycle [{units.length}]",
        )
        size = quantity(float(abscissa(backbone)[index]), unit_of(backbone, units))
        return f"{row}: {backbone.over} {size}"

    columns: list[Panel] = [partial(panel, i) for i in range(max(3, *map(len, shown.values())))]
    which = "the first, the middle and the last amplitude of each mode that slips somewhere"
    if amplitudes:
        which = "the computed amplitudes nearest to those of the study"
    records = {row: record for row, (_, record) in rows.items()}
    title = f"{case.name}: where the joint slips, full model"
    return Drawn(
        figure=map_figure(records, columns, 13.0, 0.7, title),
        stem="backbone_slip",
        title=f"{case.name}: slip over amplitude",
        caption=(
            f"Slip of contact points in a cycle while they are closed, at {which}. Grey points "
            "do not slip."
        ),
    )


def _map_amplitudes(results: Results, case: CaseResult) -> list[float]:
    """Return the amplitudes of maps in the study; an empty list without any."""
    cases = results.study_tables.get("load_case", [])
    return next((entry.get("maps", []) for entry in cases if entry.get("name") == case.name), [])


def _map_indices(backbone: Backbone, amplitudes: list[float]) -> list[int]:
    """Return the indices of some amplitudes, or of the first, middle and last with slip."""
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


def draw_fit(computed: Backbone, measured: MeasuredCurve) -> Figure:
    """Draw a backbone and the measured curve of its fit."""
    upper, lower = _axes(computed.measured_at, computed.units)
    upper.plot(computed.amplitude, computed.frequency, "o-", label="computed")
    lower.plot(computed.amplitude, 100 * computed.damping_ratio, "o-", label="computed")
    return _with_tests(upper, lower, [measured])


def draw_band(band: BackboneBand, measured: Sequence[MeasuredCurve]) -> Figure:
    """Draw a band of backbones and measured curves."""
    upper, lower = _axes(band.measured_at, band.units)
    ends: tuple[tuple[Axes, Vector, Vector], ...] = (
        (upper, band.frequency_low, band.frequency_high),
        (lower, 100 * band.damping_low, 100 * band.damping_high),
    )
    for axes, low, high in ends:
        axes.fill_between(band.amplitude, low, high, alpha=0.3, label="computed")
    return _with_tests(upper, lower, measured)


def _over_amplitudes(axes: Axes) -> None:
    """Make the abscissa logarithmic, with few labels."""
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(_label))
    axes.xaxis.set_minor_formatter(FuncFormatter(_label))


def _axes(measured_at: str, units: str) -> tuple[Axes, Axes]:
    figure = new_figure(6.5, 6.2)
    upper, lower = figure.subplots(2, 1, sharex=True)
    _over_amplitudes(upper)
    upper.set_ylabel(f"frequency [{units_of(units).frequency}]")
    lower.set_ylabel("damping ratio [%]")
    lower.set_xlabel(f"amplitude at {measured_at} [{amplitude_unit(measured_at, units)}]")
    return upper, lower


def _label(amplitude: float, _: int | None) -> str:
    """Return the label of a tick; a decade has four labels."""
    return f"{amplitude:g}" if f"{amplitude:e}"[0] in "1235" else ""


def _with_tests(upper: Axes, lower: Axes, measured: Sequence[MeasuredCurve]) -> Figure:
    for test in measured:
        if test.frequency is not None:
            upper.plot(test.amplitude, test.frequency, "^k", mfc="none", label=test.name)
        if test.damping_ratio is not None:
            lower.plot(test.amplitude, 100 * test.damping_ratio, "^k", mfc="none", label=test.name)
    for axes in (upper, lower):
        axes.legend()
    figure = upper.get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure
