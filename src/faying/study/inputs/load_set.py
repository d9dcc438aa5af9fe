"""Loads for a reduced model: static cases as one matrix, and transients one by one."""

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
"""Endings of files that are tables of loads."""


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
    """What a reduced model is to be solved for.

    Attributes
    ----------
    names
        Of the static cases.
    inputs : (n_case, n_input) [force]
        Of the static cases.
    transients
        Loads over time.
    requirement
        What the file of the loads demands of the joint; None if it says nothing.
    repetitions
        Load case to how often it comes in the life of the joint, where that is known.
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
    integrator are those of tables over time: by default their interval, of uneven ones the
    smallest, or a little less so that whole steps end with the table, and :class:`ImplicitEuler`.
    """
    if path.is_dir():
        files = sorted(file for file in path.iterdir() if file.suffix in TABLES)
        if not files:
            message = f"{path} has no tables ({', '.join(TABLES)}); name a file or another folder"
            raise StudyError(message)
        twice = [file for file, following in pairwise(files) if file.stem == following.stem]
        if twice:
            refuse_study(
                f"{path} has two tables of the name '{twice[0].stem}', which is that of their "
                "results; rename or remove one"
            )
        tables = [read_load_table(file) for file in files]
        static = next((file for file in tables if file.times is None), None)
        if static is not None:
            refuse_study(
                f"{static.path.name} has no column 'time'; a folder holds loads over time, name a "
                "table of static cases itself"
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
    """Yield what of a load case only a run of a study follows, and what to do instead."""
    if not (case.kind == "static" or case.transient):
        yield (
            f"is a {case.kind}, which only a run of a study follows; leave it out, or follow it in "
            "Python with faying.solve_path"
        )
    if case.tolerance is not None:
        yield (
            "leaves its time steps to a run of a study; give a number for 'step' and no 'tolerance'"
        )
    if case.kind == "static" and "increments" in case.model_fields_set:
        yield (
            "says its increments, which only a run of a study follows; leave 'increments' out, and "
            f"static cases take {DEFAULT_INCREMENTS} here"
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
                f"{table.path.name}: column '{locked[0]}' cannot change over time, for bolts are "
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
    """Return the length of equal steps to the end of a table, as long as its intervals."""
    intervals, end = np.diff(times), float(times[-1])
    shortest, mean = float(intervals.min()), float(intervals.mean())
    if np.ptp(intervals) <= SHORT_DIGITS * mean:
        return end / max(round(end / mean), 1)
    return end / float(np.ceil(end / shortest * (1 - SHORT_DIGITS)))


def _checked(rom: ReducedModel, loads: Iterable[TimedLoad]) -> tuple[TimedLoad, ...]:
    """Refuse loads and time steps that the model cannot follow before anything is computed."""
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
    """Return the longest period of the full model, which a study may measure time by."""
    timed = case.steps_per_period is not None or case.periods is not None
    if timed and rom.period is None:
        refuse_study(
            f"load case '{case.name}' measures time by the longest period, which this model does "
            "not know; give 'step' and 'duration', or make the model with faying reduce"
        )
    return rom.period or 1.0
