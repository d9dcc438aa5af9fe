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

OPENING = "opening margin"
"""Name of the array of what is left to an opening."""

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
class SolvedCases:
    """The pieces of one set of static cases, or of one transient.

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
    ordered
        Whether the pieces follow each other; those of static cases are similar ones instead.
    """

    checkpoint: Checkpoint
    keys: Sequence[str]
    metrics: Sequence[Metric]
    label: Callable[[int], str]
    failed: Sequence[str] = ()
    ordered: bool = True

    def __iter__(self) -> Iterator[Arrays]:
        """Yield the arrays of one piece after the other."""
        return map(self.checkpoint.get, self.keys)

    def envelope(self) -> Envelope | None:
        """Return the envelope of all cases; None where none was solved."""
        parts = (
            Envelope(**{name: arrays[name] for name in _EXTREMES})  # type: ignore[arg-type]
            for arrays in self
            if _EXTREMES[0] in arrays
        )
        first = next(parts, None)
        return None if first is None else reduce(lambda a, b: joined([a, b]), parts, first)

    def rows(self) -> Iterator[tuple[list[str], Matrix]]:
        """Yield labels and metrics of one piece after the other."""
        if self.ordered:
            for arrays in self:
                yield [self.label(row) for row in arrays["rows"].tolist()], arrays["metrics"]
            return
        table = self._of_all("metrics")
        yield [self.label(row) for row in range(len(table))], table

    def worst(self, count: int) -> list[Worst]:
        """Return the worst cases of each metric that has a worst value, the worst first."""
        worst: dict[str, list[Worst]] = {entry.name: [] for entry in self.metrics if entry.worst}
        for arrays in self:
            table, rows = arrays["metrics"], arrays["rows"]
            for column, metric in enumerate(self.metrics):
                if metric.worst is None:
                    continue
                values = table[:, column]
                best = worst[metric.name] + [
                    Worst(metric=metric.name, row=int(rows[row]), value=float(values[row]))
                    for row in _worst_rows(metric, values, count).tolist()
                ]
                sign = _sign(metric)
                worst[metric.name] = sorted(
                    best, key=lambda entry: (sign * entry.value, entry.row)
                )[:count]
        return [entry for entries in worst.values() for entry in entries]

    def extreme(self, metric: str, *, largest: bool) -> tuple[int, float] | None:
        """Return the row of the largest or smallest value of a metric, and it; None of none."""
        column = [entry.name for entry in self.metrics].index(metric)
        extremes: list[tuple[int, float]] = []
        for arrays in self:
            values = (1 if largest else -1) * arrays["metrics"][:, column]
            if not np.isnan(values).all():
                row = int(np.nanargmax(values))
                extremes.append((int(arrays["rows"][row]), float(arrays["metrics"][row, column])))
        sign = -1 if largest else 1
        return min(extremes, key=lambda entry: (sign * entry[1], entry[0]), default=None)

    def named(self, history: str, row: int) -> str:
        """Return what a static case is called, or an instant of a history."""
        return f"{history} at {self.label(row)}" if history else self.label(row)

    def column(self, metric: str) -> Vector:
        """Return a metric of all cases or instants, NaN where there is no solution."""
        column = [metric_entry.name for metric_entry in self.metrics].index(metric)
        return self._of_all("metrics", column)

    def bending(self, bolt: str) -> Matrix:
        """Return the bending moments of a bolt (n_row, 2, 2), NaN where there is no solution."""
        return self._of_all(f"{BENDING}{bolt}")

    def margins(self) -> Vector:
        """Return how deep what must not open is pressed at the demanded factor (n_row,) [length].

        Minus infinity where there is no solution.
        """
        return self._of_all(OPENING)

    def _of_all(self, name: str, column: int | None = None) -> Matrix:
        """Return an array of all cases or instants, or a column of it, in their order."""
        parts, rows = [], []
        for arrays in self:
            parts.append(arrays[name] if column is None else arrays[name][:, column])
            rows.append(arrays["rows"])
        return np.concatenate(parts)[np.argsort(np.concatenate(rows), kind="stable")]

    def fields(self, rows: Sequence[int]) -> tuple[list[int], Matrix, Matrix]:
        """Return those of some rows that were kept, with pressures and gaps (n_row, n_point)."""
        fields_of: dict[int, tuple[Vector, Vector]] = {}
        for arrays in self:
            for number, row in enumerate(arrays["kept"].tolist()):
                if row in rows:
                    fields_of[row] = (arrays["pressure"][number], arrays["gap"][number])
        present = [row for row in rows if row in fields_of]
        pressure, gap = (np.array([fields_of[row][part] for row in present]) for part in (0, 1))
        return present, pressure, gap


def piece_of(
    solved: Sequence[tuple[Indices, Solution, Certificate | None]],
    interfaces: Mapping[str, ContactSurface],
    metrics: Sequence[Metric],
    *,
    rows: Indices,
    count: int,
    named: Collection[int] = (),
    rings: Mapping[str, Ring] = MappingProxyType({}),
    areas: Mapping[str, TangentialRows] = MappingProxyType({}),
) -> dict[str, np.ndarray]:
    """Return the arrays that are kept of some cases or instants.

    Parameters
    ----------
    solved
        Solutions with the rows of their cases, increasing; rows without one did not converge.
    rows : (n_row,)
        Of the piece, increasing.
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
    for numbers, solution, certificate in solved:
        own_metrics = case_metrics(solution, interfaces, certificate, rings, areas)
        if solution.shear_forces is not None:
            own_metrics = np.hstack([own_metrics, friction_figures(solution, interfaces)])
        table[np.searchsorted(rows, numbers)] = own_metrics
    chosen_rows = {
        int(rows[row])
        for column, metric in enumerate(metrics)
        if metric.worst is not None
        for row in _worst_rows(metric, table[:, column], count).tolist()
    }
    chosen_rows |= set(named) & set(rows.tolist())
    arrays: dict[str, np.ndarray] = {"rows": rows, "metrics": table}
    chosen: list[int] = []
    pressure: list[Vector] = []
    gap: list[Vector] = []
    envelopes: list[Envelope] = []
    for numbers, solution, _ in solved:
        positions = np.flatnonzero(np.isin(numbers, sorted(chosen_rows)))
        chosen += numbers[positions].tolist()
        pressure += list(solution.pressure[positions])
        gap += list(solution.gap[positions])
        envelopes.append(envelope_of(solution, numbers))
    prefix = "bolt_bending."
    bent = [
        bolt_metric.name.removeprefix(prefix)
        for bolt_metric in metrics
        if bolt_metric.name.startswith(prefix)
    ]
    for bolt in bent:
        moments = np.full((len(rows), 2, 2), np.nan)
        for numbers, solution, _ in solved:
            moments[np.searchsorted(rows, numbers)] = solution.bolt_bending(bolt)
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
