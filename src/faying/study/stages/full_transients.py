"""Transients of the full model, solved side by side in groups."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices
from faying.execution.groups import even_parts, grouped
from faying.joint.model import Model
from faying.joint.system import System
from faying.linalg.memory import require_room
from faying.simulation.divided_steps import DividedSteps, divided_steps
from faying.simulation.energy_guard import AT_ONCE
from faying.simulation.instants import runs_at_once
from faying.simulation.integrators import Integrator, named_integrator
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import joined, some_states, without_states
from faying.simulation.stepping import TransientSolver, transient_solver
from faying.simulation.transient_windows import Steps, transient_windows
from faying.study.inputs.loads import case_load, instants, time_span, time_step
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.nodal_motion import even_states, motion_in, shown_states
from faying.study.results.responses import Seen, respond, seen_of
from faying.study.results.values import Response
from faying.study.stages.offline import PreparedJoint

INSTANTS_AT_ONCE = AT_ONCE
"""Instants computed at a time: as many as the energy check uses together."""


@dataclass(frozen=True)
class FullTransient:
    """A transient of the full model, its time step divided by ``refinement``."""

    case: LoadCaseSection
    refinement: int = 1


def case_groups(
    cases: Sequence[LoadCaseSection], *, half_step: bool
) -> list[dict[str, FullTransient]]:
    """Return the groups of transients that the full model computes together, by checkpoint key.

    A group has equal time step, duration and integrator. Transients with half the step are last,
    if a study asks for them.
    """
    alike: dict[object, dict[str, FullTransient]] = {}
    for refinement in (1, 2) if half_step else (1,):
        for case in cases:
            if case.transient and not (case.tolerance and refinement > 1):
                # Chosen steps differ from case to case.
                alone = case.name if case.tolerance else ""
                kind = (refinement, instants(case), integrator_of(case), alone)
                run = FullTransient(case=case, refinement=refinement)
                key = response_key(case, refinement=refinement)
                alike.setdefault(kind, {})[key] = run
    return [group for together in alike.values() for group in grouped(together)]


def full_transients(
    joint: PreparedJoint,
    runs: Sequence[FullTransient],
    progress: Callable[[int], object] | None = None,
) -> list[Response]:
    """Solve transients with the full model, side by side; each gets an equal share of the time.

    Raises
    ------
    NotEnoughMemoryError
        If contact forces and gaps of all instants do not fit in memory.

    Notes
    -----
    Displacements are in memory for :data:`INSTANTS_AT_ONCE` instants, and for drawn ones.
    """
    first, start = runs[0], time.perf_counter()
    step, duration = (of(first.case, joint.period) for of in (time_step, time_span))
    step /= first.refinement
    n_time = round(duration / step) + 1
    _require_room(joint.model, len(runs), n_time)
    steps = steps_of(joint.model, first.case, step)
    together = even_parts(runs, runs_at_once(joint.model, n_time, INSTANTS_AT_ONCE + 1))
    responses = [
        response
        for part in together
        for response in _side_by_side(steps, joint, part, duration, n_time, progress)
    ]
    seconds = (time.perf_counter() - start) / len(runs)
    return [replace(response, seconds=seconds) for response in responses]


def _require_room(model: Model, n_run: int, n_time: int) -> None:
    """Refuse transients whose contact forces and gaps do not fit in memory twice."""
    contact = model.contact
    require_room(
        8.0 * n_run * n_time * 4 * contact.components * contact.n_points,
        f"contact forces and gaps of {n_run} transients with {n_time} instants at "
        f"{contact.n_points} points",
        "shorten them or enlarge the step",
    )


def steps_of(system: System, case: LoadCaseSection, step: float) -> DividedSteps | TransientSolver:
    """Return the time integration of a load case, with given or chosen steps."""
    scheme = integrator_of(case)
    if case.tolerance:
        return divided_steps(system, step=step, tolerance=case.tolerance, integrator=scheme)
    return transient_solver(system, step=step, integrator=scheme)


def _side_by_side(
    steps: Steps,
    joint: PreparedJoint,
    runs: Sequence[FullTransient],
    duration: float,
    n_time: int,
    progress: Callable[[int], object] | None,
) -> list[Response]:
    """Solve transients piece by piece, and return their responses."""
    model = joint.model
    # The initial state is given: its last digits would depend on earlier solutions.
    parts_of_runs = transient_windows(
        steps,
        [case_load(run.case) for run in runs],
        duration=duration,
        length=INSTANTS_AT_ONCE,
        initial=[joint.rest] * len(runs),
        progress=progress,
    )
    even = even_states(n_time)
    parts_by_run: list[list[_Piece]] = [[] for _ in runs]
    for solutions, _ in parts_of_runs:
        for parts, solution in zip(parts_by_run, solutions, strict=True):
            first = parts[-1].end if parts else 0
            parts.append(_piece(model, solution, first, even))
    return [
        _response(model, parts, moves=run.refinement == 1)
        for run, parts in zip(runs, parts_by_run, strict=True)
    ]


@dataclass(frozen=True, eq=False, kw_only=True)
class _Piece:
    """Stored results of a piece of a transient.

    Attributes
    ----------
    end
        Number of the instant after the piece.
    contact
        Solution without displacements.
    seen
        Quantities from displacements at all instants.
    numbers, moved
        Instants that may be drawn, and the solution with displacements at them.
    """

    end: int
    contact: Solution
    seen: Seen
    numbers: Indices
    moved: Solution


def _piece(model: Model, solution: Solution, first: int, even: Indices) -> _Piece:
    """Return the stored results of a piece that begins at the instant ``first``."""
    instants = np.arange(first, first + len(solution.states))
    peak = instants[solution.max_pressure.argmax()]
    numbers = instants[np.isin(instants, even) | (instants == peak)]
    return _Piece(
        end=int(instants[-1]) + 1,
        contact=without_states(solution),
        seen=seen_of(solution, model),
        numbers=numbers,
        moved=some_states(solution, numbers - first),
    )


def _response(model: Model, parts: Sequence[_Piece], *, moves: bool) -> Response:
    """Return the response of a transient from its pieces."""
    contact, motion = joined([part.contact for part in parts]), None
    if moves:
        chosen = shown_states(contact.max_pressure)
        numbers = np.concatenate([part.numbers for part in parts])
        moved = joined([part.moved for part in parts])
        motion = motion_in(model, some_states(moved, np.searchsorted(numbers, chosen)), chosen)
    seen = {
        member: {
            name: np.concatenate([part.seen[member][name] for part in parts]) for name in by_name
        }
        for member, by_name in parts[0].seen.items()
    }
    return respond(contact, model, 0.0, motion=motion, seen=seen)


def response_key(case: LoadCaseSection, label: str = "full", refinement: int = 1) -> str:
    """Return the checkpoint key of a response, by default of the full model."""
    return f"{case.name} {label} {refinement}"


def integrator_of(case: LoadCaseSection) -> Integrator:
    """Return the integrator of a transient load case; implicit Euler by default."""
    return named_integrator(case.integrator, case.rho_infinity)
