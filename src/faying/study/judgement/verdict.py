"""The verdict on the joint of a run, with the instants that decide."""

import tomllib
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from faying.assessment.check import Check
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_verdict import JointVerdict, joint_verdict
from faying.assessment.response_curve import ResponseCurve
from faying.display.quantities import quantity
from faying.study.results.values import CaseResult, Results


def run_verdict(results: Results) -> JointVerdict:
    """Return the verdict on the joint over the load cases of a run."""
    units, assessment = results.unit_set, results.assessment
    if assessment is None:
        reasons = [text for text in results.omissions if text.startswith("joint assessment")]
        missing = "; ".join(reasons) or "see the warnings"
        demanded = bool(required(results.study_text))
        return joint_verdict(_vibrating(results), units, missing if demanded else "")
    reserves = {
        name: case.reserve for name, case in results.cases.items() if case.reserve is not None
    }
    checks = joint_checks(assessment, units, reserves)
    timed = (_timed(check, results) for check in checks)
    return joint_verdict((*timed, *_vibrating(results)), units)


def _vibrating(results: Results) -> Iterator[Check]:
    """Yield what is unknown under harmonic loads, with what was found at the worst frequency."""
    units = results.unit_set
    unknown = partial(Check, outcome="unknown")
    for name, record in results.frequencies.items():
        curves = [curve for curve in record.response.curves if len(curve.frequency)]
        moved = [(curve, curve.contact) for curve in curves if curve.contact is not None]
        if not moved:
            continue
        for number, bolt in enumerate(results.bolts):
            ranges, curve = max(
                ((contact.bolt_force_range[:, number], curve) for curve, contact in moved),
                key=lambda pair: float(pair[0].max()),
            )
            found = f"force ranges over {quantity(float(ranges.max()), units.force)}"
            at = _place(name, curve, int(ranges.argmax()))
            reason = f"{found} {at}: repetitions are not known; give it as a load case"
            yield unknown(part=bolt, kind="bolt", quantity="fatigue", case=name, reason=reason)
        curve, contact = max(moved, key=lambda pair: float(pair[1].peak_pressure.max()))
        row = int(contact.peak_pressure.argmax())
        found = f"pressure reaches {quantity(float(contact.peak_pressure[row]), units.pressure)}"
        found += f", {contact.slip_share[row]:.0%} of the area slips, "
        found += f"{contact.open_share[row]:.0%} opens {_place(name, curve, row)}"
        reason = f"{found}: forces at that instant are not kept; give it as a load case"
        for interface in results.interfaces:
            yield unknown(
                part=interface, kind="interface", quantity="vibration", case=name, reason=reason
            )


def _place(name: str, curve: ResponseCurve, row: int) -> str:
    return f"under {name}, level {curve.level:g} at {curve.frequency[row]:.5g}"


def required(study_text: str) -> list[str]:
    """Return the requirements that a study names."""
    try:
        return list(tomllib.loads(study_text).get("requirement", {}))
    except tomllib.TOMLDecodeError:
        return []


def _timed(check: Check, results: Results) -> Check:
    """Return a check with the instant of its load case that decides, of cases over time."""
    case = results.cases.get(check.case)
    if case is None or case.times is None or check.instant is not None:
        return check
    instant = _instant(check, case, results)
    return check if instant is None else replace(check, instant=float(case.times[instant]))


def _instant(check: Check, case: CaseResult, results: Results) -> int | None:
    if check.kind == "bolt" or check.part not in results.interfaces:
        return None
    if check.quantity.startswith("clamp"):
        return int(np.argmin(case.reference.contact_forces[check.part]))
    if check.quantity.startswith("pressure"):
        pressure = case.reference.pressure[:, slice(*results.interfaces[check.part].slice)]
        return int(pressure.max(axis=1).argmax())
    return None
