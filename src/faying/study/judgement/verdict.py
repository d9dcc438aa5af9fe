"""The verdict on the joint of a run, with the deciding instants."""

from dataclasses import replace

import numpy as np

from faying.assessment.check import Check
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_verdict import JointVerdict, joint_verdict
from faying.study.results.values import CaseResult, Results


def run_verdict(results: Results) -> JointVerdict:
    """Return the verdict on the joint over the load cases of a run."""
    units, assessment = results.unit_set, results.assessment
    if assessment is None:
        reasons = [text for text in results.omissions if text.startswith("joint assessment")]
        missing = "; ".join(reasons) or "see the warnings"
        demanded = results.study_tables.get("requirement")
        return joint_verdict((), units, missing if demanded else "")
    reserves = {
        name: case.reserve for name, case in results.cases.items() if case.reserve is not None
    }
    checks = joint_checks(assessment, units, reserves)
    return joint_verdict((_timed(check, results) for check in checks), units)


def _timed(check: Check, results: Results) -> Check:
    """Return a check with the deciding instant, if its load case is over time."""
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
