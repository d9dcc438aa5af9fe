"""What slips in the load cases of a run."""

import numpy as np

from faying._typing import Indices
from faying.assessment.slip import SLIP, STICK
from faying.report.quantities import number, percent
from faying.study.comparison import increments
from faying.study.path_record import PathRecord
from faying.study.results import CaseResult, InterfaceRecord, Results


def slipping(record: InterfaceRecord, status: Indices) -> float:
    """Return the slipping share of the area in contact, of the points (n_point,) of one."""
    closed, slips = (float(record.weights[one].sum()) for one in (status >= STICK, status == SLIP))
    return slips / closed if closed > 0 else 0.0


def shown_increment(case: CaseResult) -> tuple[PathRecord, int, str] | None:
    """Return the increment that stands for a case: path, number, and when that is, in words.

    A static load at its full value, of paths and cycles where most slips.
    """
    found = increments(case.reference)
    if not found:
        return None
    path, last = found[-1], len(found[-1].factors)
    if case.kind == "static":
        return path, last - 1, "under the full load"
    if case.kind == "cycle":
        factor = number(float(path.factors[path.most_slip, 0]))
        return path, path.most_slip, f"at {factor} × the load, where most slips in a cycle"
    return path, path.most_slip, f"in increment {path.most_slip + 1} of {last}, where most slips"


def slip_sentence(results: Results) -> str:
    """Return what slips in a run, in one sentence; nothing without friction."""
    if not any(record.friction > 0 for record in results.interfaces.values()):
        return ""
    most: dict[str, float] = {}
    gross: list[str] = []
    for name, case in results.cases.items():
        found = increments(case.reference)
        most[name] = max((most_slip(one) for one in found), default=0.0)
        if any(bool(one.macroslip.any()) for one in found):
            gross.append(name)
    if not most or max(most.values()) <= 0:
        return "Nothing slips in these load cases." if most else ""
    worst = max(most, key=lambda name: most[name])
    text = f"The joint slips: up to {percent(most[worst])} of the area in contact, in {worst}"
    if gross:
        text += f"; everything that touches slips (macroslip) in {', '.join(gross)}"
    return f"{text}."


def most_slip(path: PathRecord) -> float:
    """Return the largest slipping share of the area in contact."""
    closed = path.stick_share + path.slip_share
    return float((path.slip_share / np.where(closed > 0, closed, 1.0)).max(initial=0.0))
