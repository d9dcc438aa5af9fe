"""Load cases in increments: static loads of joints with friction, paths, cycles, backbones.

Finished increments and amplitudes are stored, for a run that resumes.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from faying._typing import Matrix
from faying.assessment.backbone import Backbone
from faying.assessment.modal_analysis import modal_analysis
from faying.assessment.modal_cycles import ModalCycle, StillModeError
from faying.assessment.slip_reserve import SlipReserve, slip_reserve
from faying.assessment.tresca import IncrementCertificate, certify_increments
from faying.contact.increment import IncrementSolver
from faying.exceptions import naming
from faying.joint.model import Model
from faying.joint.system import System
from faying.simulation.cycles import Cycles, solve_cycles
from faying.simulation.load import Load
from faying.simulation.path import (
    assembled,
    last_of,
    moved_alone,
    path_inputs,
    path_start,
    solve_path,
)
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.solution import Solution
from faying.simulation.start import released_state
from faying.study.inputs.loads import case_load
from faying.study.keys.load_files import ALL, read_load_factors
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.nodal_motion import NodalMotion, nodal_motion
from faying.study.results.path_record import CycleRecord, cycle_record, path_record
from faying.study.results.responses import respond
from faying.study.results.values import Response
from faying.study.stages.books import Books

T = TypeVar("T")


@dataclass(frozen=True, eq=False, kw_only=True)
class IncrementalCase:
    """A load case that is solved in increments from the preloaded state of a system.

    Attributes
    ----------
    model
        The full model.
    books, key
        Store of finished amplitudes and increments, and key of the whole response.
    progress
        Called with the number of further increments or amplitudes, computed or read.
    led
        Called with the states after the increments of a path.
    """

    case: LoadCaseSection
    model: Model
    system: System
    preloaded: Solution
    books: Books
    key: str
    progress: Callable[[int], object]
    led: Callable[[Sequence[PathStep]], object]

    def piece(self, kind: type[T], name: str, compute: Callable[[], T]) -> tuple[T, float]:
        """Return a piece that is kept, or computed and kept, and the seconds that took."""
        return self.books.timed_value(kind, f"{self.key}, {name}", compute)


def goes_in_increments(case: LoadCaseSection, model: Model) -> bool:
    """Return whether a load case is solved in increments."""
    return case.kind in ("path", "cycle", "backbone") or (
        case.kind == "static" and not model.contact.forgets
    )


def advances(case: LoadCaseSection, model: Model) -> int:
    """Return the number of increments of a load case, or of amplitudes of cycles and backbones."""
    if not goes_in_increments(case, model):
        return 1
    if case.kind == "backbone":
        return len(case.modes) * len(case.levels)
    if case.kind == "cycle":
        return len(case.amplitudes or (1.0,))
    return len(_factors(case)[1])


def rest_state(
    system: System, tightening: tuple[Load, ...], full: Solution | None = None
) -> Solution:
    """Return the preloaded state of a full or reduced model.

    ``tightening`` is the path that tightened the bolts with friction; empty if they were tightened
    without. Reduced models with the static compliance of the full model start in its state.
    """
    if tightening and full is not None and system.contact.residual_compliance is not None:
        state = last_of(solve_path(system, tightening[-1:], full, name="preload"))
        return replace(state, dissipation=full.dissipation)
    if tightening:
        return last_of(solve_path(system, tightening, name="preload"))
    return last_of(released_state(system))


def path_response(run: IncrementalCase, like: Response | None = None) -> Response:
    """Solve a load case in increments, with as many cycles as the response ``like``."""
    case, model, preloaded = run.case, run.model, run.preloaded
    if case.kind == "backbone":
        return _backbone_response(run)
    if case.kind == "cycle":
        return _cycle_response(run, like)
    load = case_load(case)
    names, factors = _factors(case)
    loads = _loads(case, model, names, factors)
    path, seconds = follow_path(run, loads)
    record = path_record(path, preloaded, load, names, factors)
    return respond(
        last_of(path),
        model,
        seconds,
        path=record,
        motion=_motion(model, path),
        certificate=_certificate(run, path),
    )


def _cycle_response(run: IncrementalCase, like: Response | None) -> Response:
    """Solve the cycles of all amplitudes, each from the preloaded joint.

    The largest amplitude is last, and its end is the state of the response.
    """
    case, load, seconds = run.case, case_load(run.case), 0.0
    records: dict[str, CycleRecord] = {}

    def cycles(amplitude: float) -> Cycles:
        return solve_cycles(
            run.system,
            load,
            amplitude,
            run.preloaded,
            increments=case.increments,
            count=None if like is None else len(like.cycles[str(amplitude)].energies),
        )

    def recorded(amplitude: float) -> CycleRecord:
        return cycle_record(cycles(amplitude), load)

    *others, largest = sorted(case.amplitudes or (1.0,))
    for amplitude in others:
        compute = partial(recorded, amplitude)
        record, took = run.piece(CycleRecord, f"amplitude {amplitude}", compute)
        records[str(amplitude)], seconds = record, seconds + took
        run.progress(1)
    start = time.perf_counter()
    last = cycles(largest)
    seconds += time.perf_counter() - start
    run.progress(1)
    records[str(largest)] = cycle_record(last, load)
    motion = _motion(run.model, last.cycle)
    return respond(last_of(last.cycle), run.model, seconds, cycles=records, motion=motion)


def _certificate(run: IncrementalCase, path: Solution) -> IncrementCertificate | None:
    """Return error bounds of the increments of a reduced model; None for the full model."""
    model = run.model
    if path.system is model or model.contact.forgets or not model.contact.proportional:
        return None
    with run.books.attempt(f"{run.case.name}, bounds"):
        return certify_increments(model, path, run.preloaded)
    return None


def _motion(model: Model, path: Solution) -> NodalMotion | None:
    """Return the displacements along a path of the full model; None for other models."""
    return nodal_motion(model, path) if path.system is model else None


def reserve_of(
    model: Model,
    case: LoadCaseSection,
    preloaded: Solution,
    open_below: float | None = None,
    along: Sequence[PathStep] = (),
) -> SlipReserve:
    """Return the slip reserve of a load case of the full model, from its preloaded state.

    An area is open below a share ``open_below`` of its area pressed at rest; None follows no
    opening. ``along`` holds increments of the case that were solved already.
    """
    return slip_reserve(
        model,
        case_load(case),
        preloaded,
        share=case.slip_share,
        increments=case.increments,
        open_below=open_below,
        along=along,
    )


def _factors(case: LoadCaseSection) -> tuple[tuple[str, ...], Matrix]:
    """Return names and values (n_increment, n_column) of the load factors of a case."""
    if case.factors is None:
        return (ALL,), np.arange(1, case.increments + 1)[:, None] / case.increments
    table = read_load_factors(case.factors, [force.target for force in case.forces])
    return table.names, table.values


def _loads(
    case: LoadCaseSection, model: Model, names: tuple[str, ...], factors: Matrix
) -> list[Load]:
    """Return the loads of every increment, with initial bolt forces where they change."""
    values = {force.target: force.value or 0.0 for force in case.forces}
    rows: list[Mapping[str, float]] = [
        dict(zip(names, row, strict=True)) for row in factors.tolist()
    ]
    return [
        Load(
            {name: value * row.get(name, row.get(ALL, 0.0)) for name, value in values.items()},
            name=case.name,
            bolt_forces={
                name: bolt.initial_force * row[name]
                for name, bolt in model.bolts.items()
                if name in row
            },
        )
        for row in rows
    ]


@dataclass(frozen=True, eq=False, kw_only=True)
class TimedBackbone:
    """A backbone, and the seconds of its computation."""

    curve: Backbone
    seconds: float


def _backbone_response(run: IncrementalCase) -> Response:
    """Return the backbones of a load case, for modes with motion where they are measured."""
    case, curves, seconds = run.case, {}, 0.0
    still: StillModeError | None = None
    for mode in sorted(case.modes):
        name = f"mode {mode}"
        if run.books.checkpoint.has(f"{run.key}, {name}"):
            run.progress(len(case.levels))
        with naming(f"load case '{case.name}'"):
            try:
                kept, _ = run.piece(TimedBackbone, name, partial(_curve, run, mode))
            except StillModeError as error:
                still = error
                run.progress(len(case.levels))
                continue
        curves[str(mode)] = kept.curve
        seconds += kept.seconds
    if still is not None and not curves:
        with naming(f"load case '{case.name}'"):
            raise still
    return respond(run.preloaded, run.model, seconds, backbones=curves)


def _curve(run: IncrementalCase, mode: int) -> TimedBackbone:
    """Compute a backbone.

    Every amplitude starts from the preloaded joint, so stored ones are not needed for others.
    """
    start, case = time.perf_counter(), run.case
    analysis = modal_analysis(
        run.system,
        mode,
        case.levels,
        over=case.over,
        at=case.at,
        initial=run.preloaded,
        increments=cycle_increments(case),
    )
    seconds, cycles = time.perf_counter() - start, []
    for number in range(len(case.levels)):
        name = f"mode {mode}, amplitude {number + 1}"
        cycle, took = run.piece(ModalCycle, name, partial(analysis.cycle, number))
        cycles.append(cycle)
        seconds += took
        run.progress(1)
    curve = analysis.backbone(cycles, masing=case.masing)
    return TimedBackbone(curve=curve, seconds=seconds)


def cycle_increments(case: LoadCaseSection) -> int:
    """Return the number of increments of a full cycle."""
    return 4 * case.increments


INCREMENTS_AT_ONCE = 50
"""Increments that are stored together: writing takes 12 ms with 600 contact points, 18 ms with
3000, a few percent of computing them, or less."""


@dataclass(frozen=True, eq=False)
class _Increments:
    """Increments that are stored together."""

    steps: tuple[PathStep, ...]


def follow_path(run: IncrementalCase, loads: Sequence[Load]) -> tuple[Solution, float]:
    """Solve a sequence of loads; return the path, and the seconds of its computation.

    The results equal those of :func:`faying.solve_path`: an increment needs only the last state of
    the previous increments, which is stored with them.
    """
    start, system, name = time.perf_counter(), run.system, run.case.name
    if system.contact.forgets:
        path = solve_path(system, loads, initial=run.preloaded, name=name)
        run.progress(len(loads))
        return path, time.perf_counter() - start
    inputs = path_inputs(system, loads)
    state, relative = path_start(system, run.preloaded), moved_alone(system, inputs)
    solver = system.static_contact.increments
    steps = list[PathStep]()
    if len(inputs) <= INCREMENTS_AT_ONCE:
        steps += follow(solver, relative, state)
        run.progress(len(inputs))
    seconds = time.perf_counter() - start
    for first in range(len(steps), len(inputs), INCREMENTS_AT_ONCE):
        part = range(first, min(first + INCREMENTS_AT_ONCE, len(inputs)))
        compute = partial(_solve_part, solver, relative, state, part)
        followed, took = run.piece(_Increments, f"increments {first + 1} to {part.stop}", compute)
        for step in followed.steps:
            state = replace(step, previous=replace(state, previous=None))
            steps.append(state)
        seconds += took
        run.progress(len(part))
    run.led(steps)
    start = time.perf_counter()
    path = assembled(system, inputs, steps, name)
    return path, seconds + time.perf_counter() - start


def _solve_part(
    solver: IncrementSolver, relative: Matrix, state: PathStep, part: range
) -> _Increments:
    """Return the increments of some of the loads."""
    steps = follow(solver, relative, state, part=part)
    return _Increments(tuple(replace(step, previous=None) for step in steps))
