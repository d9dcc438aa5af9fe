"""Loads for a reduced model: static cases as one matrix, and loads over time."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.digits import LARGEST, SHORT_DIGITS, SMALLEST
from faying.exceptions import StudyError, refuse_study
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.integrators import ImplicitEuler, Integrator, named_integrator
from faying.simulation.load import History, Load
from faying.study.inputs.load_table import (
    FACTOR,
    LoadTable,
    read_load_table,
    table_inputs,
)
from faying.study.inputs.loads import case_load, time_span, time_step
from faying.study.keys.requirement_tables import RequirementSection
from faying.study.keys.schema import read_load_cases
from faying.study.keys.tables import LoadCaseSection

TABLES = (".csv", ".parquet")
"""File name endings of load tables."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TimedLoad:
    """A load over time.

    Attributes
    ----------
    load
    step, duration : [time]
    integrator
    """

    load: Load
    step: float
    duration: float
    integrator: Integrator


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadSet:
    """Static cases and loads over time for a reduced model.

    Attributes
    ----------
    names
        Names of the static cases.
    inputs : (n_case, n_input) [force]
        Inputs of the static cases.
    transients
        Loads over time.
    requirement
        Requirements in the file of the loads; None without them.
    repetitions
        Number of occurrences of a load case in the life of the joint, by case, where known.
    """

    names: Sequence[str]
    inputs: Matrix
    transients: tuple[TimedLoad, ...]
    requirement: RequirementSection | None = None
    repetitions: Mapping[str, float] = field(default_factory=dict)


def read_loads(
    path: Path,
    rom: ReducedModel,
    *,
    step: float | None = None,
    integrator: Integrator | None = None,
) -> LoadSet:
    """Read loads for a reduced model.

    The path is a TOML file with load cases; a csv or Parquet table with a row per static case, or
    per instant where it has a column ``time``; or a folder of tables over time. Step [time] and
    integrator apply to tables over time. The default step is the interval of the table, the
    smallest if they differ, shortened to end with the table; then :class:`ImplicitEuler`.
    """
    if path.is_dir():
        files = sorted(file for file in path.iterdir() if file.suffix in TABLES)
        if not files:
            message = f"{path} has no tables ({', '.join(TABLES)}); give a file or another folder"
            raise StudyError(message)
        twice = [file for file, following in pairwise(files) if file.stem == following.stem]
        if twice:
            refuse_study(
                f"{path} has two tables named '{twice[0].stem}', whose results would have the same "
                "name; rename or remove one"
            )
        tables = [read_load_table(file) for file in files]
        static = next((file for file in tables if file.times is None), None)
        if static is not None:
            refuse_study(
                f"{static.path.name} has no column 'time'; a folder holds loads over time, give a "
                "table of static cases as a file"
            )
        return _of_histories(rom, tables, step, integrator)
    if path.suffix in TABLES:
        table = read_load_table(path)
        if table.times is not None:
            return _of_histories(rom, [table], step, integrator)
        inputs = table_inputs(table, rom)
        repeated = table.repetitions
        counted = () if repeated is None else zip(table.names, repeated.tolist(), strict=True)
        return LoadSet(
            names=table.names,
            inputs=inputs,
            transients=(),
            repetitions={name: often for name, often in counted if often},
        )
    cases, requirement = read_load_cases(path)
    return replace(_of_cases(cases, rom), requirement=requirement)


def _not_solved(case: LoadCaseSection) -> Iterator[str]:
    """Yield the reasons why only a run of a study solves a load case, with remedies."""
    if not (case.kind == "static" or case.transient):
        yield (
            f"is a {case.kind}, which only a run of a study solves; leave it out, or solve it in "
            "Python with faying.solve_path"
        )
    if case.tolerance is not None:
        yield (
            "has a 'tolerance' for time steps, which needs a run; give a 'step' and no 'tolerance'"
        )
    if case.kind == "static" and "increments" in case.model_fields_set:
        yield (
            "has 'increments', which only a run of a study uses; leave 'increments' out, and "
            f"static cases use {DEFAULT_INCREMENTS} here"
        )


def _of_cases(cases: Sequence[LoadCaseSection], rom: ReducedModel) -> LoadSet:
    for case in cases:
        for why in _not_solved(case):
            refuse_study(f"load case '{case.name}' {why}")
    static = [case for case in cases if case.kind == "static"]
    start = np.zeros(1)
    rows = [case_load(case).inputs(rom, start) for case in static]
    width = len(rom.port_compliance.input_rows)
    return LoadSet(
        names=tuple(case.name for case in static),
        inputs=np.concatenate(rows) if rows else np.zeros((0, width)),
        repetitions={case.name: case.repetitions for case in cases if case.repetitions},
        transients=_checked(
            rom,
            (
                TimedLoad(
                    load=case_load(case),
                    step=time_step(case, _period(case, rom)),
                    duration=time_span(case, _period(case, rom)),
                    integrator=named_integrator(case.integrator, case.rho_infinity),
                )
                for case in cases
                if case.kind != "static"
            ),
        ),
    )


def _of_histories(
    rom: ReducedModel,
    tables: Iterable[LoadTable],
    step: float | None,
    integrator: Integrator | None,
) -> LoadSet:
    loads: list[TimedLoad] = []
    for table in tables:
        table_inputs(table, rom)  # refuses unknown columns, all at once
        locked = [name for name in table.columns if name.partition(".")[0] == FACTOR]
        if locked:
            refuse_study(
                f"{table.path.name}: column '{locked[0]}' cannot change over time, since bolts are "
                "locked; remove it"
            )
        times = np.asarray(table.times)
        forces = {name: History(times, values) for name, values in table.columns.items()}
        loads.append(
            TimedLoad(
                load=Load(forces, name=table.path.stem),
                step=_table_step(times) if step is None else step,
                duration=float(times[-1]),
                integrator=integrator or ImplicitEuler(),
            )
        )
    nothing = np.zeros((0, len(rom.port_compliance.input_rows)))
    return LoadSet(names=(), inputs=nothing, transients=_checked(rom, loads))


def _table_step(times: Vector) -> float:
    """Return the length of equal time steps of about an interval that end with the table."""
    intervals, end = np.diff(times), float(times[-1])
    shortest, mean = float(intervals.min()), float(intervals.mean())
    if np.ptp(intervals) <= SHORT_DIGITS * mean:
        return end / max(round(end / mean), 1)
    return end / float(np.ceil(end / shortest * (1 - SHORT_DIGITS)))


def _checked(rom: ReducedModel, loads: Iterable[TimedLoad]) -> tuple[TimedLoad, ...]:
    """Return loads after refusing those, and time steps, that the model cannot compute."""
    checked = tuple(loads)
    for load in checked:
        load.load.inputs(rom, np.zeros(1))
        if not (load.step >= SMALLEST and max(load.step, load.duration) <= LARGEST):
            refuse_study(
                f"{load.load.name}: the time step is {load.step:g} and the duration "
                f"{load.duration:g}; expected both from {SMALLEST:g} to {LARGEST:g}"
            )
    return checked


def _period(case: LoadCaseSection, rom: ReducedModel) -> float:
    """Return the longest period of the full model, in which a load case may measure time."""
    timed = case.steps_per_period is not None or case.periods is not None
    if timed and rom.period is None:
        refuse_study(
            f"load case '{case.name}' measures time in the longest period, which this model does "
            "not store; give 'step' and 'duration', or write the model with faying reduce"
        )
    return rom.period or 1.0
