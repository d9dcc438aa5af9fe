"""What slips in the load cases of a run."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Vector
from faying.assessment.slip import SLIP, STICK
from faying.display.quantities import number, percent, quantity
from faying.report.figures.backbone import abscissa, unit_of
from faying.study.judgement.comparison import increments, rubbed
from faying.study.results.slip_record import SlipRecord
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units


def slipping(record: InterfaceRecord, status: Indices) -> float:
    """Return the slipping share of the area in contact, of the points (n_point,) of one."""
    closed, slips = (
        float(record.weights[points].sum()) for points in (status >= STICK, status == SLIP)
    )
    return slips / closed if closed > 0 else 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownSlip:
    """The increment or instant that stands for a load case with friction.

    Attributes
    ----------
    record, at
        What friction does, and the number of the increment.
    pressure : (n_point,)
        Of that increment.
    when
        When that is, in words.
    """

    record: SlipRecord
    at: int
    pressure: Vector
    when: str


def shown_slip(case: CaseResult, units: Units) -> ShownSlip | None:
    """Return what stands for a case: a static load at its full value, else where most slips."""
    paths, motion = increments(case.reference), case.reference.friction
    if motion is not None and case.times is not None:
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
    """Return what slips in a run, in one sentence; nothing without friction."""
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
        text += f"; everything that touches slips (macroslip) in {', '.join(gross)}"
        if all(_holds(results.cases[name]) for name in gross):
            text += ", in directions that cancel: nothing slides as a whole"
    return " ".join([f"{text}.", vibrating]).rstrip()


def _holds(case: CaseResult) -> bool:
    """Say whether a static load is known not to slide what it makes slip."""
    slides = None if case.reserve is None else case.reserve.gross_slip
    return case.kind == "static" and case.reserve is not None and (slides is None or slides > 1)


def _in_vibration(results: Results) -> str:
    """Say from what amplitudes on the modes of backbones slip; nothing where none does."""
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
                text += f", everything that touches from {quantity(whole.min(), unit)} on"
            said.append(text)
    return f"In vibration the joint slips: {'; '.join(said)}." if said else ""


def most_slip(path: SlipRecord) -> float:
    """Return the largest slipping share of the area in contact."""
    closed = path.stick_share + path.slip_share
    return float((path.slip_share / np.where(closed > 0, closed, 1.0)).max(initial=0.0))
