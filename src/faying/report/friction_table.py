"""What friction does in the load cases of a run, as a table."""

import numpy as np

from faying.assessment.growth import PRECISION
from faying.report.quantities import number, percent, place, quantity
from faying.report.slip import most_slip
from faying.report.tables import Table, table
from faying.study.comparison import rubbed
from faying.study.results import CaseResult, Results
from faying.units import units_of


def friction_table(results: Results) -> Table:
    """Return what friction does in each load case."""
    units = units_of(results.units)
    columns = (
        "load case", "max traction", "energy taken by friction", "most slip at once",
        "first slip at", "where", "slip sets in at", "a share slips at", "slides as a whole at",
    )  # fmt: skip
    rows = []
    for name, case in results.cases.items():
        found = rubbed(case.reference)
        if not found or not any(face.friction for face in results.interfaces.values()):
            continue
        energy = quantity(float(found[-1].dissipation.sum()), units.of("force·length"))
        rows.append(
            (
                name,
                quantity(max(one.max_traction for one in found), units.pressure),
                f"{energy} per cycle" if case.kind == "cycle" else energy,
                f"{percent(max(map(most_slip, found)))} of the area in contact",
                *_reserve(results, case),
            )
        )
    return table(columns, rows)


def _factor(factor: float) -> str:
    """Return a load factor; next to none is round-off of what tightening left on its bound."""
    return f"{number(factor)} ×" if factor >= PRECISION else "once it acts"


def _reserve(results: Results, case: CaseResult) -> tuple[str, ...]:
    """Return the load factors of a slip reserve, and where it begins."""
    reserve = case.reserve
    if reserve is None:
        return ("—",) * 5
    beyond = f"above {number(reserve.largest)} ×"
    if reserve.stopped:
        beyond = f"no solution above {number(reserve.largest)} ×"
    first, onset, share, gross = (
        beyond if factor is None else _factor(factor)
        for factor in (
            reserve.first_slip,
            reserve.onset,
            reserve.share_slip,
            reserve.gross_slip,
        )
    )
    where = "—"
    if reserve.interface in results.interfaces:
        record = results.interfaces[reserve.interface]
        size = float(np.ptp(record.points, axis=0).max())
        point = place(record.points[reserve.point], units_of(results.units).length, size)
        where = f"{reserve.interface} {point}"
    slides = f" ({reserve.slides})" if reserve.slides else ""
    return first, where, onset, f"{percent(reserve.share)}: {share}", gross + slides
