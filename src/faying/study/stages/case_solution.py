"""Solution of a load case of a study by one model, with estimated errors."""

import time
from collections.abc import Callable
from dataclasses import replace

from faying.assessment.recovery import recover_pressure
from faying.assessment.transient_error import finer_model, transient_error
from faying.joint.system import System
from faying.simulation.divided_steps import DividedSteps
from faying.simulation.path import solve_static
from faying.simulation.solution import Solution
from faying.study.inputs.loads import case_load, time_span, time_step
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.second_solution import Remedy, Tried
from faying.study.results.values import Response
from faying.study.stages.full_transients import integrator_of, steps_of
from faying.study.stages.offline import PreparedJoint
from faying.study.stages.path_cases import rest_state


def solve_case(
    joint: PreparedJoint,
    case: LoadCaseSection,
    system: System,
    progress: Callable[[int], object] | None = None,
    refinement: int = 1,
    initial: Solution | None = None,
    like: Response | None = None,
) -> tuple[Solution, float]:
    """Solve a load case with one model; return the solution and the seconds it took.

    Transients start from ``initial``, where given, with its slip. Where steps are
    chosen, they are the steps of ``like``, so that errors against it do not come from steps.
    """
    start, load = time.perf_counter(), case_load(case)
    if case.kind == "static":
        return solve_static(system, load), time.perf_counter() - start
    step, duration = (of(case, joint.period) for of in (time_step, time_span))
    steps = steps_of(system, case, step / refinement)
    if isinstance(steps, DividedSteps):
        taken = None if like is None else like.substeps
        solution = steps.solve(
            load, duration=duration, initial=initial, substeps=taken, progress=progress
        )
    else:
        solution = steps.solve(load, duration=duration, initial=initial, progress=progress)
    return solution, time.perf_counter() - start


def judged(
    joint: PreparedJoint,
    case: LoadCaseSection,
    response: Response,
    solution: Solution,
    name: str,
    *,
    recovered: bool,
) -> Response:
    """Return the response of a reduced transient with errors estimated without the full model.

    ``name`` names load case and model. Pressures are also recovered from the motion if
    ``recovered``. Parts that fail are left out.
    """
    books, estimate = joint.books, None
    if recovered:
        with books.stage("recovery"), books.attempt(f"{name}, recovered pressures"):
            pressure = recover_pressure(joint.model, solution).pressure
            response = replace(response, recovered_pressure=pressure)
    with books.stage("estimated errors"), books.attempt(f"{name}, estimated error"):
        finer = finer_model(joint.model, solution)
        estimate = transient_error(
            finer,
            solution,
            case_load(case),
            integrator=integrator_of(case),
            initial=rest_state(finer, joint.preload_path, joint.rest),
        )
    return replace(response, estimate=estimate)


def remedy_of(
    first: tuple[str, Response], second: tuple[str, Response], tolerance: float
) -> Remedy:
    """Return the record of a transient that was solved by one model and then by another."""
    return Remedy(first=_record_of(*first), taken=_record_of(*second), tolerance=tolerance)


def _record_of(method: str, response: Response) -> Tried:
    estimate = response.estimate
    return Tried(
        method=method,
        estimate=None if estimate is None else estimate.max_relative_error,
        seconds=response.seconds,
    )
