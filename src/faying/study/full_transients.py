"""Load cases over time that the full model solves, those that fit together side by side."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from faying.execution.groups import grouped
from faying.execution.transients import step_responses
from faying.simulation.divided_steps import divided_steps
from faying.simulation.integrators import Integrator, named_integrator
from faying.simulation.solution import Solution
from faying.simulation.stepping import transient_solver
from faying.study.loads import case_load
from faying.study.offline import PreparedJoint
from faying.study.responses import respond
from faying.study.results import Response
from faying.study.tables import LoadCaseSection
from faying.study.timing import instants, time_span, time_step


@dataclass(frozen=True)
class FullTransient:
    """A load case over time that the full model solves, its time step divided by ``refinement``."""

    case: LoadCaseSection
    refinement: int = 1


def case_groups(
    cases: Sequence[LoadCaseSection], *, half_step: bool
) -> list[dict[str, FullTransient]]:
    """Return which transients the full model computes together, by the keys they are kept under.

    Their steps, their lengths and their integrators are the same. With half the step last, where a
    study asks for it.
    """
    alike: dict[object, dict[str, FullTransient]] = {}
    for refinement in (1, 2) if half_step else (1,):
        for case in cases:
            if case.transient and not (case.tolerance and refinement > 1):
                # Steps that are chosen are so for each case alone.
                alone = case.name if case.tolerance else ""
                kind = (refinement, instants(case), integrator_of(case), alone)
                run = FullTransient(case=case, refinement=refinement)
                key = response_key(case, refinement=refinement)
                alike.setdefault(kind, {})[key] = run
    return [group for some in alike.values() for group in grouped(some)]


def full_transients(
    joint: PreparedJoint,
    runs: Sequence[FullTransient],
    progress: Callable[[int], object] | None = None,
) -> list[Response]:
    """Solve transients with the full model, side by side; each has its share of the time."""
    first, start = runs[0], time.perf_counter()
    step, duration = (of(first.case, joint.period) for of in (time_step, time_span))
    loads, scheme = [case_load(run.case) for run in runs], integrator_of(first.case)
    found: Iterable[Solution]
    # The rest is given: solved anew it would depend, in the last digits, on what was solved before.
    if first.case.tolerance:
        divided = divided_steps(
            joint.model, step=step, tolerance=first.case.tolerance, integrator=scheme
        )
        found = [
            divided.solve(load, duration=duration, initial=joint.rest, progress=progress)
            for load in loads
        ]
    else:
        solver = transient_solver(joint.model, step=step / first.refinement, integrator=scheme)
        found = step_responses(
            solver, loads, duration=duration, initial=joint.rest, progress=progress
        )
    responses = [
        respond(solution, joint.model, 0.0, moves=run.refinement == 1)
        for run, solution in zip(runs, found, strict=True)
    ]
    seconds = (time.perf_counter() - start) / len(runs)
    return [replace(response, seconds=seconds) for response in responses]


def response_key(case: LoadCaseSection, label: str = "full", refinement: int = 1) -> str:
    """Return the key that a response is kept under; that of the full model unless told."""
    return f"{case.name} {label} {refinement}"


def integrator_of(case: LoadCaseSection) -> Integrator:
    """Return the integrator of a transient load case; the seed's implicit Euler by default."""
    return named_integrator(case.integrator, case.rho_infinity)
