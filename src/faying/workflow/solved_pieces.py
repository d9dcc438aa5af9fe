"""What is kept of a piece of many cases: figures of all, fields of those that may decide."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.assessment.case_metrics import Metric, bent_bolts, case_metrics
from faying.assessment.certificate import Certificate
from faying.assessment.envelope import envelope_of, joined
from faying.assessment.opening import estimated_openings
from faying.assessment.requirements import OPEN_BELOW
from faying.assessment.sealing import Ring
from faying.assessment.slip_metrics import friction_figures
from faying.assessment.slip_reserve import friction_used
from faying.digits import ROUND_OFF
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution
from faying.workflow.solved_cases import BENDING, OPENS, SLIDES, SMALLEST, smallest_rows, worst_rows

Judged = tuple[Indices, Solution, Certificate | None]
"""Rows of cases or instants, increasing, with their solution and its certificate."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Demanded:
    """What is asked of every case because a requirement judges it.

    Attributes
    ----------
    rings
        Around holes, by name.
    areas
        What is carried along areas whose slip is judged in static cases.
    opens
        Name to the points (n_point,) of what may open in static cases.
    open_below
        Share of the area pressed at rest below which it is open.
    pressed
        Bolt to the points (n_point,) around it that must stay pressed.
    """

    rings: Mapping[str, Ring] = field(default_factory=dict)
    areas: Mapping[str, TangentialRows] = field(default_factory=dict)
    opens: Mapping[str, Mask] = field(default_factory=dict)
    open_below: float = OPEN_BELOW
    pressed: Mapping[str, Mask] = field(default_factory=dict)


def arrays_of(
    rom: ReducedModel,
    rows: Indices,
    solved: Sequence[Judged],
    demanded: Demanded,
    metrics: Sequence[Metric],
    worst: int,
    chosen: Collection[int] = (),
) -> dict[str, np.ndarray]:
    """Return the arrays that are kept of some cases or instants.

    Rows (n_row,) of the piece increase; those without a solution did not converge. Fields are kept
    of the worst cases of each metric and of the chosen rows.
    """
    pressed = demanded.pressed.values()
    rubbing = {name: rom.interfaces[name] for name in rom.contact.rubbing_interfaces}

    def figures(solution: Solution, certificate: Certificate | None) -> Matrix:
        table = case_metrics(solution, rom.interfaces, certificate, demanded.rings, demanded.areas)
        return np.hstack([table, friction_figures(solution, rubbing)])

    def smallest(solution: Solution, _: object) -> Matrix:
        forces = [np.asarray(solution.bolt_force(name)) for name in rom.bolts]
        forces += [-np.asarray(solution.contact_force(name)) for name in rom.interfaces]
        return np.column_stack(
            [*forces, *(solution.pressure[:, points].min(axis=1) for points in pressed)]
        )

    n_smallest = len(rom.bolts) + len(rom.interfaces) + len(pressed)
    table = _placed(rows, solved, (len(metrics),), figures)
    minima = _placed(rows, solved, (n_smallest,), smallest)
    moments = {
        f"{BENDING}{bolt}": _placed(rows, solved, (2, 2), partial(_bending, bolt))
        for bolt in bent_bolts(rom.bolts)
    }
    places = {
        place
        for column, metric in enumerate(metrics)
        if metric.worst is not None
        for place in worst_rows(metric, table[:, column], worst).tolist()
    }
    field_rows = [*rows[sorted(places | smallest_rows(minima))].tolist(), *chosen]
    positions = [np.flatnonzero(np.isin(numbers, field_rows)) for numbers, _, _ in solved]
    of_each = list(zip(positions, solved, strict=True))
    n_point = rom.contact.n_points
    arrays: dict[str, np.ndarray] = {
        "rows": rows,
        "metrics": table,
        SMALLEST: minima,
        **moments,
        "kept": np.array([n for at, part in of_each for n in part[0][at]], dtype=np.int64),
        "pressure": np.array([p for at, part in of_each for p in part[1].pressure[at]]),
        "gap": np.array([g for at, part in of_each for g in part[1].gap[at]]),
    }
    arrays |= {name: arrays[name].reshape(-1, n_point) for name in ("pressure", "gap")}
    envelopes = [envelope_of(solution, numbers) for numbers, solution, _ in solved]
    return arrays | (vars(joined(envelopes)) if envelopes else {})


def factors_of(
    rows: Indices, solved: Sequence[Judged], demanded: Demanded, rest: Solution
) -> dict[str, np.ndarray]:
    """Return the factors at which static cases would open areas, and slide, as estimated."""
    system = rest.system
    rubbing = system.contact.rubbing_interfaces

    def opens(solution: Solution, _: object) -> Matrix:
        return estimated_openings(rest, solution, demanded.opens, demanded.open_below)

    def slides(solution: Solution, _: object) -> Matrix:
        normal = solution.contact_forces[:, None]
        used = [
            [friction_used(system, name, forces) for name in rubbing]
            for forces in np.concatenate([normal, solution.shear_forces], axis=1)
        ]
        return np.asarray(1 / np.maximum(used, ROUND_OFF))

    return {
        OPENS: _placed(rows, solved, (len(demanded.opens),), opens),
        SLIDES: _placed(rows, solved, (len(rubbing),), slides),
    }


def _placed(
    rows: Indices,
    solved: Sequence[Judged],
    shape: tuple[int, ...],
    values: Callable[[Solution, Certificate | None], Matrix],
) -> Matrix:
    """Return values of the rows (n_row, *shape), NaN where there is no solution."""
    table = np.full((len(rows), *shape), np.nan)
    for numbers, solution, certificate in solved:
        table[np.searchsorted(rows, numbers)] = values(solution, certificate)
    return table


def _bending(bolt: str, solution: Solution, _: object) -> Matrix:
    return solution.bolt_bending(bolt)
