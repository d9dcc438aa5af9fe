"""Slip in the load cases of a run, friction needed by interfaces, and peaks over frequency."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying._typing import Indices, Vector
from faying.assessment.growth import PRECISION
from faying.assessment.response_curve import Peak
from faying.assessment.slip import SLIP, STICK
from faying.assessment.slip_demand import SMALLEST_FRICTION, SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.display.quantities import as_given, number, percent, place, quantity
from faying.display.table import FL, PRESSURE, Cell, Column, Table, described, largest
from faying.report.figures.backbone import abscissa, unit_of
from faying.study.judgement.comparison import increments, rubbed
from faying.study.results.path_record import SlipRecord
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units


def slipping(record: InterfaceRecord, status: Indices) -> float:
    """Return the slipping share of an interface's closed area from the states (n_point,)."""
    closed, slips = (
        float(record.weights[points].sum()) for points in (status >= STICK, status == SLIP)
    )
    return slips / closed if closed > 0 else 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownSlip:
    """The increment or instant that represents a load case with friction.

    Attributes
    ----------
    record, at
        Slip record, and number of the increment or instant.
    pressure : (n_point,)
        Pressure in that increment.
    when
        Time or increment in words.
    """

    record: SlipRecord
    at: int
    pressure: Vector
    when: str


def shown_slip(case: CaseResult, units: Units) -> ShownSlip | None:
    """Return the shown increment: the full static load, otherwise that of largest slipping area."""
    paths, motion = increments(case.reference), case.reference.friction
    if case.times is not None and len(motion):
        instant, pressure = motion.most_slip, case.reference.pressure
        when = f"at {quantity(float(case.times[instant]), units.time)}, where most slips"
        return ShownSlip(record=motion, at=instant, pressure=pressure[instant], when=when)
    if not paths:
        return None
    path, last = paths[-1], len(paths[-1].factors)
    instant, when = path.most_slip, f"in increment {path.most_slip + 1} of {last}, where most slips"
    if case.kind == "static":
        instant, when = last - 1, "under the full load"
    elif case.kind == "cycle":
        factor = number(float(path.factors[instant, 0]))
        when = f"at {factor} × the load, where most slips in a cycle"
    return ShownSlip(record=path, at=instant, pressure=path.pressure[instant], when=when)


def slip_sentence(results: Results) -> str:
    """Return a sentence about slip in a run; empty without friction."""
    if not results.rubbing:
        return ""
    shares: dict[str, float] = {}
    gross: list[str] = []
    for name, case in results.cases.items():
        records = rubbed(case.reference)
        shares[name] = max((most_slip(slip_record) for slip_record in records), default=0.0)
        if any(bool(slip_record.macroslip.any()) for slip_record in records):
            gross.append(name)
    vibrating = _in_vibration(results)
    if not shares or max(shares.values()) <= 0:
        return vibrating or ("Nothing slips in these load cases." if shares else "")
    worst = max(shares, key=lambda name: shares[name])
    text = f"The joint slips: up to {percent(shares[worst])} of the area in contact, in {worst}"
    if gross:
        text += f"; all closed points slip (macroslip) in {', '.join(gross)}"
        if all(_does_not_slide(results.cases[name]) for name in gross):
            text += ", in directions that cancel, so that nothing slides as a whole"
    return " ".join([f"{text}.", vibrating]).rstrip()


def _does_not_slide(case: CaseResult) -> bool:
    """Return whether the slip reserve shows that a static load does not slide an interface."""
    slides = None if case.reserve is None else case.reserve.gross_slip
    return case.kind == "static" and case.reserve is not None and (slides is None or slides > 1)


def _in_vibration(results: Results) -> str:
    """Return a sentence about the amplitudes at which backbones slip; empty without slip."""
    said = []
    for name, case in results.cases.items():
        for mode, backbone in case.reference.backbones.items():
            along = abscissa(backbone)
            slips, whole = (
                along[backbone.energy_per_cycle > 0],
                along[backbone.macroslip.astype(bool)],
            )
            if not len(slips):
                continue
            unit = unit_of(backbone, results.unit_set)
            text = f"mode {mode} of {name} from {backbone.over} {quantity(slips.min(), unit)} on"
            if len(whole):
                text += f", all closed points from {quantity(whole.min(), unit)} on"
            said.append(text)
    return f"In vibration the joint slips: {'; '.join(said)}." if said else ""


def most_slip(path: SlipRecord) -> float:
    """Return the largest slipping share of the closed area."""
    closed = path.stick_share + path.slip_share
    return float((path.slip_share / np.where(closed > 0, closed, 1.0)).max(initial=0.0))


def demand_table(results: Results) -> Table:
    """Return the table of friction that interfaces and their parts near bolts need, by sums."""
    assessment = results.assessment
    demands: dict[str, SlipDemand] = {}
    interfaces = assessment.interfaces if assessment else {}
    for name, item in interfaces.items():
        demands |= {name: item.slip} if item.slip.asked else {}
        around = {
            bolt: area.slip_around[name]
            for bolt, area in (assessment.bolts if assessment else {}).items()
            if name in area.slip_around and not item.slip.unknown
        }
        demands |= {f"{name} around {bolt}": d for bolt, d in around.items() if len(around) > 1}
    columns = (
        Column("friction needed", _needed, "", 3),
        Column("in", _needing),
        Column("force along it", lambda item: _there(item, item.tangential_force), "force", 5),
        Column("moment", lambda item: _there(item, item.moment), FL),
        Column("clamp force", lambda item: _there(item, item.clamp_force), "force", 5),
        Column("friction given", lambda item: item.coefficient, "", 3),
        Column("safety S_G", lambda item: min(item.safety.values(), default=None), "", 3),
        Column("unknown because", lambda item: item.unknown or None),
    )
    return described("interface", demands.items(), columns, results.unit_set)


def _needing(demand: SlipDemand) -> str | None:
    """Return the load case that needs most friction; None without tangential load."""
    needed = demand.needed_friction.items()
    return largest({case: share for case, share in needed if share > SMALLEST_FRICTION})


def _needed(demand: SlipDemand) -> Cell | float | None:
    case = _needing(demand)
    needed = None if case is None else demand.needed_friction[case]
    return Cell(text="nothing is pressed") if needed == np.inf else needed


def _there(demand: SlipDemand, values: Mapping[str, float]) -> float | None:
    return values.get(str(_needing(demand)))


def friction_table(results: Results) -> Table:
    """Return the table of friction in each load case."""
    cases = results.cases if results.rubbing else {}
    rows = {name: case for name, case in cases.items() if rubbed(case.reference)}
    share = next((case.reserve.share for case in rows.values() if case.reserve), 0.5)
    columns = (
        Column(
            "largest traction", lambda case: max(o.max_traction for o in _rubbed(case)), PRESSURE
        ),
        Column("dissipated energy", _energy, FL),
        Column("slips at most", lambda case: 100 * max(map(most_slip, _rubbed(case))), "%", 3),
        Column("first point slips at", lambda case: _factor(case.reserve, "first_slip"), "× load"),
        Column("where", lambda case: _where(results, case)),
        Column("slip begins at", lambda case: _factor(case.reserve, "onset"), "× load"),
        Column(
            f"{percent(share)} of the area slips at",
            lambda case: _factor(case.reserve, "share_slip"),
            "× load",
        ),
        Column("slides as a whole at", lambda case: _factor(case.reserve, "gross_slip"), "× load"),
        Column("interface", lambda case: (case.reserve and case.reserve.slides) or None),
    )
    return described("load case", rows.items(), columns, results.unit_set)


def _energy(case: CaseResult) -> float | None:
    """Return the energy dissipated since the preload; None for cycles, which have another table."""
    return None if case.kind == "cycle" else float(_rubbed(case)[-1].dissipation.sum())


def _rubbed(case: CaseResult) -> Any:
    return rubbed(case.reference)


def _factor(reserve: SlipReserve | None, name: str) -> Cell | float | None:
    """Return a load factor, or the largest factor that was tried."""
    if reserve is None:
        return None
    factor = getattr(reserve, name)
    if factor is None:
        until = " (no solution beyond)" if reserve.stopped else ""
        return Cell(text=f"> {as_given(reserve.largest)}{until}")
    if factor < PRECISION:  # round-off of points at their bound
        return Cell(text=f"< {PRECISION:g}", value=factor)
    return float(factor)


def _where(results: Results, case: CaseResult) -> str | None:
    reserve = case.reserve
    if reserve is None or reserve.interface not in results.interfaces:
        return None
    record = results.interfaces[reserve.interface]
    size = float(np.ptp(record.points, axis=0).max())
    point = place(record.points[reserve.point], results.unit_set.length, size)
    return f"{reserve.interface} {point}"


def peak_table(results: Results) -> Table:
    """Return the peak of each level, contact at the peak, and the prediction by the backbone.

    A level with its largest value at an end of the frequencies is marked: it has no peak.
    """
    peaks = {
        f"{name}, level {level.peak.level:g}{_beyond(level.peak)}": (record.at, level)
        for name, record in results.frequencies.items()
        for level in record.peaks()
    }

    def percent_of(name: str) -> Callable[[Any], float | None]:
        return lambda row: None if (share := row[1].there(name)) is None else 100 * share

    columns = (
        Column("of", lambda row: row[0]),
        Column("largest at", lambda row: row[1].peak.frequency, "1/time", 5),
        Column("amplitude", lambda row: row[1].peak.amplitude, "length"),
        Column("damping ratio", percent_of("damping_ratio"), "%", 3),
        Column("slipping area", percent_of("slip_share"), "%", 3),
        Column("opened", percent_of("open_share"), "%", 3),
        Column("largest pressure", lambda row: row[1].there("peak_pressure"), PRESSURE),
        Column(
            "largest by the backbone at",
            lambda row: row[1].expected and row[1].expected.frequency,
            "1/time",
            5,
        ),
        Column(
            "its amplitude", lambda row: row[1].expected and row[1].expected.amplitude, "length"
        ),
    )
    return described("level", peaks.items(), columns, results.unit_set)


def _beyond(peak: Peak) -> str:
    """Return the mark of a curve without a peak between its frequencies, else an empty text."""
    return ", no peak between its frequencies" if peak.at_end else ""


PEAKED = ("neither curve", "the test", "the computed curve", "both")
"""Which curves have a peak between the frequencies that both have."""


def measured_table(results: Results) -> Table:
    """Return the table of measured peaks, and of the deviations of computed ones."""
    compared = [pair for record in results.frequencies.values() for pair in record.compared()]

    def known(value: float) -> float | None:
        return value if np.isfinite(value) else None

    def measured(field: str) -> Callable[[Any], float | None]:
        return lambda pairs: known(pairs[field][0])

    def off(field: str) -> Callable[[Any], float | None]:
        return lambda pairs: known(100 * (pairs[field][1] / pairs[field][0] - 1))

    def damping(pairs: Any) -> float | None:
        return known(100 * pairs["damping_ratio"][0])

    def with_peak(pairs: Any) -> str:
        test, model = np.isfinite(pairs["frequency"])
        return PEAKED[int(test) + 2 * int(model)]

    columns = (
        Column("has a peak", with_peak),
        Column("measured peak at", measured("frequency"), "1/time", 5),
        Column("off by", off("frequency"), "%", 3),
        Column("measured amplitude", measured("amplitude"), "length"),
        Column("amplitude off by", off("amplitude"), "%", 3),
        Column("measured damping ratio", damping, "%", 3),
        Column("damping ratio off by", off("damping_ratio"), "%", 3),
    )
    return described("test", compared, columns, results.unit_set)
