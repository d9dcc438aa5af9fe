"""Finished pieces of many solved cases: on disk until the whole is done, read one at a time."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import reduce
from types import MappingProxyType

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.assessment.case_metrics import Metric, case_metrics
from faying.assessment.certificate import Certificate
from faying.assessment.envelope import Envelope, envelope_of, joined
from faying.assessment.friction_metrics import friction_figures
from faying.assessment.sealing import Ring
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.interface.surface import ContactSurface
from faying.joint.tangential import TangentialRows
from faying.simulation.solution import Solution

BENDING = "bending "
"""What begins the names of arrays of bending moments, before that of the bolt."""

_EXTREMES = tuple(field.name for field in fields(Envelope))


@dataclass(frozen=True, kw_only=True)
class Worst:
    """The worst value of a metric.

    Attributes
    ----------
    metric
    row
        Number of the case or instant.
    value
    """

    metric: str
    row: int
    value: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Pieces:
    """The pieces of one set of static cases, or of one transient, in order.

    Attributes
    ----------
    checkpoint
        Where they are.
    keys
        Their names there.
    metrics
        Columns of their tables.
    label
        Takes the number of a case or instant to what people call it.
    failed
        What went wrong, a sentence each.
    """

    checkpoint: Checkpoint
    keys: Sequence[str]
    metrics: Sequence[Metric]
    label: Callable[[int], str]
    failed: Sequence[str] = ()

    def __iter__(self) -> Iterator[Arrays]:
        """Yield the arrays of one piece after the other."""
        return map(self.checkpoint.get, self.keys)

    def envelope(self) -> Envelope | None:
        """Return the envelope of all cases; None where none was solved."""
        parts = (
            Envelope(**{name: piece[name] for name in _EXTREMES})  # type: ignore[arg-type]
            for piece in self
            if _EXTREMES[0] in piece
        )
        first = next(parts, None)
        return None if first is None else reduce(lambda a, b: joined([a, b]), parts, first)

    def rows(self) -> Iterator[tuple[list[str], Matrix]]:
        """Yield labels and metrics of one piece after the other."""
        for piece in self:
            first, table = int(piece["first"]), piece["metrics"]
            yield [self.label(first + row) for row in range(len(table))], table

    def worst(self, count: int) -> list[Worst]:
        """Return the worst cases of each metric that has a worst value, the worst first."""
        found: dict[str, list[Worst]] = {one.name: [] for one in self.metrics if one.worst}
        for piece in self:
            table, first = piece["metrics"], int(piece["first"])
            for column, metric in enumerate(self.metrics):
                if metric.worst is None:
                    continue
                values = table[:, column]
                best = found[metric.name] + [
                    Worst(metric=metric.name, row=first + row, value=float(values[row]))
                    for row in _worst_rows(metric, values, count).tolist()
                ]
                sign = _sign(metric)
                found[metric.name] = sorted(best, key=lambda one: (sign * one.value, one.row))[
                    :count
                ]
        return [one for some in found.values() for one in some]

    def extreme(self, metric: str, *, largest: bool) -> tuple[int, float] | None:
        """Return the row of the largest or smallest value of a metric, and it; None of none."""
        column = [one.name for one in self.metrics].index(metric)
        found: list[tuple[int, float]] = []
        for piece in self:
            values = (1 if largest else -1) * piece["metrics"][:, column]
            if not np.isnan(values).all():
                row = int(np.nanargmax(values))
                found.append((int(piece["first"]) + row, float(piece["metrics"][row, column])))
        return (max if largest else min)(found, key=lambda one: one[1], default=None)

    def named(self, history: str, row: int) -> str:
        """Return what a static case is called, or an instant of a history."""
        return f"{history} at {self.label(row)}" if history else self.label(row)

    def column(self, metric: str) -> Vector:
        """Return a metric of all cases or instants, NaN where there is no solution."""
        at = [one.name for one in self.metrics].index(metric)
        return np.concatenate([piece["metrics"][:, at] for piece in self])

    def bending(self, bolt: str) -> Matrix:
        """Return the bending moments of a bolt (n_row, 2, 2), NaN where there is no solution."""
        return np.concatenate([piece[f"{BENDING}{bolt}"] for piece in self])

    def fields(self, rows: Sequence[int]) -> tuple[list[int], Matrix, Matrix]:
        """Return those of some rows that were kept, with pressures and gaps (n_row, n_point)."""
        known: dict[int, tuple[Vector, Vector]] = {}
        for piece in self:
            for at, row in enumerate(piece["kept"].tolist()):
                if row in rows:
                    known[row] = (piece["pressure"][at], piece["gap"][at])
        found = [row for row in rows if row in known]
        pressure, gap = (np.array([known[row][part] for row in found]) for part in (0, 1))
        return found, pressure, gap


def piece_of(
    solved: Sequence[tuple[Indices, Solution, Certificate | None]],
    interfaces: Mapping[str, ContactSurface],
    metrics: Sequence[Metric],
    *,
    rows: range,
    count: int,
    named: Collection[int] = (),
    rings: Mapping[str, Ring] = MappingProxyType({}),
    areas: Mapping[str, TangentialRows] = MappingProxyType({}),
) -> dict[str, Matrix]:
    """Return the arrays that are kept of some cases or instants.

    Parameters
    ----------
    solved
        Solutions with the rows of their cases, increasing; rows without one did not converge.
    rows
        Of the piece.
    count
        Cases of each metric whose fields may be wanted.
    named
        Rows whose fields are wanted in any case.
    rings
        Around holes, by name.
    areas
        What is carried along interfaces whose needed friction is wanted.
    """
    table = np.full((len(rows), len(metrics)), np.nan)
    for own, solution, certificate in solved:
        own_metrics = case_metrics(solution, interfaces, certificate, rings, areas)
        if solution.shear_forces is not None:
            own_metrics = np.hstack([own_metrics, friction_figures(solution, interfaces)])
        table[own - rows.start] = own_metrics
    kept = {
        rows.start + row
        for column, metric in enumerate(metrics)
        if metric.worst is not None
        for row in _worst_rows(metric, table[:, column], count).tolist()
    }
    kept |= set(named) & set(rows)
    arrays: dict[str, Matrix] = {"first": np.asarray(rows.start), "metrics": table}
    chosen: list[int] = []
    pressure: list[Vector] = []
    gap: list[Vector] = []
    envelopes: list[Envelope] = []
    for own, solution, _ in solved:
        wanted = np.flatnonzero(np.isin(own, sorted(kept)))
        chosen += own[wanted].tolist()
        pressure += list(solution.pressure[wanted])
        gap += list(solution.gap[wanted])
        envelopes.append(envelope_of(solution, own))
    prefix = "bolt_bending."
    bent = [one.name.removeprefix(prefix) for one in metrics if one.name.startswith(prefix)]
    for bolt in bent:
        moments = np.full((len(rows), 2, 2), np.nan)
        for own, solution, _ in solved:
            moments[own - rows.start] = solution.bolt_bending(bolt)
        arrays[f"{BENDING}{bolt}"] = moments
    n_point = len(next(iter(solved))[1].system.contact.weights) if solved else 0
    arrays["kept"] = np.array(chosen, dtype=np.int64)
    arrays["pressure"] = np.array(pressure).reshape(-1, n_point)
    arrays["gap"] = np.array(gap).reshape(-1, n_point)
    return arrays | (vars(joined(envelopes)) if envelopes else {})


def _sign(metric: Metric) -> float:
    return -1.0 if metric.worst == "largest" else 1.0


def _worst_rows(metric: Metric, values: Vector, count: int) -> Indices:
    """Return the rows of the worst values, the first of equal ones; none that is not a number."""
    order = np.argsort(_sign(metric) * values, kind="stable")[:count]
    return order[~np.isnan(values[order])]
