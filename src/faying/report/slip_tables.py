"""Tables of slip: what interfaces need of friction, and what it does in each load case."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from faying.assessment.growth import PRECISION
from faying.assessment.slip_demand import SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.display.quantities import number, percent, place
from faying.report.slip import most_slip
from faying.report.table import FL, PRESSURE, Cell, Column, Table, described, largest
from faying.study.judgement.comparison import rubbed
from faying.study.results.values import CaseResult, Results


def demand_table(results: Results) -> Table:
    """Return the friction that interfaces and their parts nearest to bolts need, by sums."""
    assessment = results.assessment
    demands: dict[str, SlipDemand] = {}
    for name, item in (assessment.interfaces if assessment else {}).items():
        if item.slip is None:
            continue
        demands[name] = item.slip
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
        Column("not known", lambda item: item.unknown or None),
    )
    return described("interface", demands.items(), columns, results.unit_set)


def _needing(demand: SlipDemand) -> str | None:
    return largest(demand.needed_friction)


def _needed(demand: SlipDemand) -> Cell | float | None:
    case = _needing(demand)
    needed = None if case is None else demand.needed_friction[case]
    return Cell(text="nothing is pressed") if needed == np.inf else needed


def _there(demand: SlipDemand, values: Mapping[str, float]) -> float | None:
    return values.get(str(_needing(demand)))


def friction_table(results: Results) -> Table:
    """Return what friction does in each load case."""
    cases = results.cases if results.rubbing else {}
    rows = {name: case for name, case in cases.items() if rubbed(case.reference)}
    share = next((case.reserve.share for case in rows.values() if case.reserve), 0.5)
    columns = (
        Column(
            "largest traction", lambda case: max(o.max_traction for o in _rubbed(case)), PRESSURE
        ),
        Column("energy taken", _energy, FL),
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
    """Return what friction took since the preload; of cycles damping tells it."""
    return None if case.kind == "cycle" else float(_rubbed(case)[-1].dissipation.sum())


def _rubbed(case: CaseResult) -> Any:
    return rubbed(case.reference)


def _factor(reserve: SlipReserve | None, name: str) -> Cell | float | None:
    """Return a load factor, or beyond which one nothing is known."""
    if reserve is None:
        return None
    factor = getattr(reserve, name)
    if factor is None:
        until = " (no solution beyond)" if reserve.stopped else ""
        return Cell(text=f"above {number(reserve.largest)}{until}")
    if factor < PRECISION:  # round-off of what tightening left at its bound
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
