"""Stored pieces of many solved cases: the arrays of a piece, and figures over all pieces."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial, reduce

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.case_metrics import Metric, bent_bolts, case_metrics
from faying.assessment.certificate import Certificate
from faying.assessment.envelope import Envelope, envelope_of, joined
from faying.assessment.joint_record import CaseState
from faying.assessment.opening import estimated_openings
from faying.assessment.requirements import OPEN_BELOW
from faying.assessment.sealing import Ring
from faying.assessment.slip_reserve import friction_used
from faying.digits import ROUND_OFF
from faying.execution.checkpoint import Arrays, Bundles
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution

Judged = tuple[Indices, Solution, Certificate | None]
"""Rows of cases or instants, increasing, with their solution and its certificate."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Demanded:
    """Rings, areas and contact points that requirements judge in every case.

    Attributes
    ----------
    rings
        Rings around holes, by name.
    areas
        Tangential force rows of areas whose slip is judged in static cases.
    opens
        Contact points (n_point,) of each area that may open in static cases, by its name.
    open_below
        Share of the area pressed at rest below which it is open.
    pressed
        Contact points (n_point,) around each bolt that must stay pressed.
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
    """Return the arrays to store of a piece of cases or instants.

    Rows (n_row,) of the piece increase; rows without a solution did not converge. Fields are stored
    for the worst cases of each metric and for the chosen rows.
    """
    pressed = demanded.pressed.values()

    def figures(solution: Solution, certificate: Certificate | None) -> Matrix:
        return case_metrics(solution, rom.interfaces, certificate, demanded.rings, demanded.areas)

    def smallest(solution: Solution, _: object) -> Matrix:
        forces = [np.asarray(solution.bolt_force(name)) for name in rom.bolts]
        forces += [-np.asarray(solution.contact_force(name)) for name in rom.interfaces]
        return np.column_stack(
            [*forces, *(solution.pressure[:, points].min(axis=1) for points in pressed)]
        )

    n_smallest = len(rom.bolts) + len(rom.interfaces) + len(pressed)
    table = _table_of_rows(rows, solved, (len(metrics),), figures)
    minima = _table_of_rows(rows, solved, (n_smallest,), smallest)
    moments = {
        f"{BENDING}{bolt}": _table_of_rows(rows, solved, (2, 2), partial(_bending, bolt))
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
    """Return estimated load factors at which static cases open areas, and slide."""
    system = rest.system

    def opens(solution: Solution, _: object) -> Matrix:
        return estimated_openings(rest, solution, demanded.opens, demanded.open_below)

    def slides(solution: Solution, _: object) -> Matrix:
        normal = solution.contact_forces[:, None]
        used = [
            [friction_used(system, name, forces) for name in system.interfaces]
            for forces in np.concatenate([normal, solution.shear_forces], axis=1)
        ]
        return np.asarray(1 / np.maximum(used, ROUND_OFF))

    return {
        OPENS: _table_of_rows(rows, solved, (len(demanded.opens),), opens),
        SLIDES: _table_of_rows(rows, solved, (len(system.interfaces),), slides),
    }


def _table_of_rows(
    rows: Indices,
    solved: Sequence[Judged],
    shape: tuple[int, ...],
    values: Callable[[Solution, Certificate | None], Matrix],
) -> Matrix:
    """Return values (n_row, *shape) of the rows, NaN without a solution."""
    table = np.full((len(rows), *shape), np.nan)
    for numbers, solution, certificate in solved:
        table[np.searchsorted(rows, numbers)] = values(solution, certificate)
    return table


def _bending(bolt: str, solution: Solution, _: object) -> Matrix:
    return solution.bolt_bending(bolt)


BENDING = "bending "
"""Prefix of the array names of bending moments, before the name of the bolt."""

OPENS, SLIDES = "opens", "slides"
"""Names of the arrays of estimated load factors at which cases open areas, and slide."""

SMALLEST = "smallest"
"""Name of the array of quantities whose smallest value requirements judge."""

_EXTREMES = tuple(field.name for field in fields(Envelope))


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedCases:
    """The pieces of one set of static cases, or of one transient.

    Attributes
    ----------
    checkpoint
        Store of the pieces.
    keys
        Keys of the pieces in the store.
    metrics
        Columns of the tables.
    label
        Function from the number of a case or instant to its name.
    failed
        Messages of cases that failed.
    ordered
        Whether pieces hold consecutive rows; pieces of static cases hold similar ones instead.
    """

    checkpoint: Bundles
    keys: Sequence[str]
    metrics: Sequence[Metric]
    label: Callable[[int], str]
    failed: Sequence[str] = ()
    ordered: bool = True

    def __iter__(self) -> Iterator[Arrays]:
        """Yield the arrays of each piece."""
        return map(self.checkpoint.get, self.keys)

    def envelope(self) -> Envelope | None:
        """Return the envelope of all cases; None if no case was solved."""
        parts = (
            Envelope(**{name: arrays[name] for name in _EXTREMES})  # type: ignore[arg-type]
            for arrays in self
            if _EXTREMES[0] in arrays
        )
        first = next(parts, None)
        return None if first is None else reduce(lambda a, b: joined([a, b]), parts, first)

    def rows(self) -> Iterator[tuple[list[str], Matrix]]:
        """Yield labels and metrics of each piece."""
        if self.ordered:
            for arrays in self:
                yield [self.label(row) for row in arrays["rows"].tolist()], arrays["metrics"]
            return
        (table,) = self.of_all("metrics")
        yield [self.label(row) for row in range(len(table))], table

    def worst(self, count: int) -> dict[str, list[tuple[int, float]]]:
        """Return row and value of the worst cases of each metric, the worst first."""
        worst: dict[str, list[tuple[int, float]]] = {}
        for arrays in self:
            table, rows = arrays["metrics"], arrays["rows"]
            for column, metric in enumerate(self.metrics):
                if metric.worst is None:
                    continue
                values, sign = table[:, column], _sign(metric)
                best = worst.get(metric.name, []) + [
                    (int(rows[row]), float(values[row]))
                    for row in worst_rows(metric, values, count).tolist()
                ]
                best.sort(key=lambda entry: (sign * entry[1], entry[0]))
                worst[metric.name] = best[:count]
        return {name: entries for name, entries in worst.items() if entries}

    def deciding(self, count: int) -> list[int]:
        """Return the rows with the worst metrics or the smallest judged quantities."""
        worst = {row for entries in self.worst(count).values() for row, _ in entries}
        return sorted(worst | smallest_rows(*self.of_all(SMALLEST)))

    def states(self, rows: Collection[int]) -> dict[int, CaseState]:
        """Return the stored states of rows, by row number."""
        start = "bolt_force."
        columns = {
            metric.name.removeprefix(start): column
            for column, metric in enumerate(self.metrics)
            if metric.name.startswith(start)
        }
        states: dict[int, CaseState] = {}
        for arrays in self:
            for number, row in enumerate(arrays["kept"].tolist()):
                if row in rows:
                    place = np.searchsorted(arrays["rows"], [row])
                    states[row] = CaseState(
                        pressure=arrays["pressure"][[number]],
                        bolt_forces={
                            bolt: arrays["metrics"][place, column]
                            for bolt, column in columns.items()
                        },
                        bolt_moments={
                            name.removeprefix(BENDING): moments[place]
                            for name, moments in arrays.items()
                            if name.startswith(BENDING)
                        },
                    )
        return dict(sorted(states.items()))

    def named(self, history: str, row: int) -> str:
        """Return the name of a static case, or of an instant of a history."""
        return f"{history} at {self.label(row)}" if history else self.label(row)

    def of_all(self, *names: str) -> list[Matrix]:
        """Return arrays of all cases or instants in order of their rows."""
        parts = [[arrays["rows"], *(arrays[name] for name in names)] for arrays in self]
        rows, *joined_arrays = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        order = np.argsort(rows, kind="stable")
        return [array[order] for array in joined_arrays]

    def fields(self, rows: Sequence[int]) -> tuple[list[int], Matrix, Matrix]:
        """Return the stored rows among some, with pressures and gaps (n_row, n_point)."""
        fields_of: dict[int, tuple[Vector, Vector]] = {}
        for arrays in self:
            for number, row in enumerate(arrays["kept"].tolist()):
                if row in rows:
                    fields_of[row] = (arrays["pressure"][number], arrays["gap"][number])
        present = [row for row in rows if row in fields_of]
        pressure, gap = (np.array([fields_of[row][part] for row in present]) for part in (0, 1))
        return present, pressure, gap


def smallest_rows(table: Matrix) -> set[int]:
    """Return the row of the smallest value of each column, without columns that are all NaN."""
    known = table[:, ~np.isnan(table).all(axis=0)]
    return set(np.nanargmin(known, axis=0).tolist()) if known.size else set()


def _sign(metric: Metric) -> float:
    return -1.0 if metric.worst == "largest" else 1.0


def worst_rows(metric: Metric, values: Vector, count: int) -> Indices:
    """Return the rows of the worst values without NaN, the first of equal ones."""
    order = np.argsort(_sign(metric) * values, kind="stable")[:count]
    return order[~np.isnan(values[order])]
