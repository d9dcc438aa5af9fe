"""One load case of a study, solved by one model."""

import time
from collections.abc import Callable

from faying.joint.system import System
from faying.simulation.divided_steps import divided_steps
from faying.simulation.path import solve_static
from faying.simulation.solution import Solution
from faying.simulation.transient import solve_transient
from faying.study.inputs.loads import case_load
from faying.study.inputs.timing import time_span, time_step
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.values import Response
from faying.study.stages.full_transients import integrator_of
from faying.study.stages.offline import PreparedJoint


def solve_case(
    joint: PreparedJoint,
    case: LoadCaseSection,
    system: System,
    progress: Callable[[int], object] | None = None,
    refinement: int = 1,
    initial: Solution | None = None,
    like: Response | None = None,
) -> tuple[Solution, float]:
    """Solve a load case with one model; return how many seconds that took as well.

    Transients start from ``initial``, where it is given: what has slipped before. Where steps are
    chosen, they are those of ``like``, so that errors against it are not of the steps.
    """
    start, load = time.perf_counter(), case_load(case)
    if case.kind == "static":
        return solve_static(system, load), time.perf_counter() - start
    step, duration = (of(case, joint.period) for of in (time_step, time_span))
    scheme = integrator_of(case)
    if case.tolerance is not None:
        steps = None if like is None else like.substeps
        solution = divided_steps(
            system, step=step, tolerance=case.tolerance, integrator=scheme
        ).solve(load, duration=duration, initial=initial, substeps=steps, progress=progress)
    else:
        solution = solve_transient(
            system,
            load,
            step=step / refinement,
            duration=duration,
            integrator=scheme,
            initial=initial,
            progress=progress,
        )
    return solution, time.perf_counter() - start
