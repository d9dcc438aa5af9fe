"""Campaign of transient runs: one model, many loads, some of them side by side."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from faying.execution.campaign import run_grouped_campaign
from faying.execution.checkpoint import Arrays
from faying.execution.executor import Executor
from faying.execution.groups import even_parts, grouped
from faying.joint.system import System
from faying.simulation.instants import runs_at_once
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.path import solve_static
from faying.simulation.solution import Solution
from faying.simulation.stepping import TransientSolver, transient_solver


def transient_campaign(
    build: Callable[[], System],
    loads: Mapping[str, Load],
    executor: Executor | None = None,
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    take: Callable[[Solution], Arrays] | None = None,
    side_by_side: int | None = None,
    keep: Path | str | None = None,
    progress: Callable[[str], object] | None = None,
) -> Mapping[str, Arrays]:
    """Integrate the responses of one full or reduced model to many loads.

    Parameters
    ----------
    build
        Builds the preloaded model; called once by each worker, which factorizes it once for all
        its loads. A function of a module, or ``functools.partial`` of one.
    loads
        By name.
    executor
        Where; in this process unless given.
    step, duration : [time]
    integrator
        :class:`ImplicitEuler` unless given.
    take
        What is kept of each solution, a function of a module; :func:`responses` unless given.
    side_by_side
        Loads a worker advances together at most; unless given, :func:`grouped` decides by how many
        there are. Their histories are in memory at once, so that fewer go together where
        :data:`faying.simulation.instants.HISTORY_BYTES` do not hold them.
    keep
        Folder in which results are kept as they come, to resume from; see :func:`run_campaign`.
    progress
        Called with the name of each load when its result is there.

    Returns
    -------
    Mapping
        Name of the load to its arrays.

    Raises
    ------
    FayingError
        As :func:`run_campaign`, or if the number side by side is not positive.

    Notes
    -----
    Side by side the factorization is read once a step for all loads of a group. Groups follow from
    the order and number of the loads: whoever computes them, they are the same, and so are the
    numbers. Another grouping moves pressures by 1e-10 of the largest or so.
    """
    prepare = partial(
        _prepare, build, step=step, duration=duration, integrator=integrator, take=take or responses
    )
    groups = grouped(loads, side_by_side)
    return run_grouped_campaign(prepare, groups, executor, keep=keep, progress=progress)


def responses(solution: Solution) -> Arrays:
    """Return what is seen of a transient, without the states of the whole structure.

    Returns
    -------
    Mapping
        ``times`` (n_time,), ``pressure`` and ``gap`` (n_time, n_point), ``displacement/BOUNDARY``
        (n_time, n_component), ``bolt_force/BOLT`` and ``contact_force/INTERFACE`` (n_time,).
    """
    system = solution.system
    return {
        "times": np.asarray(solution.times),
        "pressure": solution.pressure,
        "gap": solution.gap,
        **{f"displacement/{name}": solution.displacement(name) for name in system.boundaries},
        **{f"bolt_force/{name}": np.asarray(solution.bolt_force(name)) for name in system.bolts},
        **{f"contact_force/{name}": solution.contact_force(name) for name in system.contact.slices},
    }


def _prepare(
    build: Callable[[], System],
    *,
    step: float,
    duration: float,
    integrator: Integrator | None,
    take: Callable[[Solution], Arrays],
) -> Callable[[Sequence[Load]], Iterator[Arrays]]:
    """Build and factorize on a worker."""
    system = build()
    solver, start = transient_solver(system, step=step, integrator=integrator), solve_static(system)
    # Nothing here may hold a solution: the histories of all that were beside it hang on it.
    return lambda loads: map(take, step_responses(solver, loads, duration=duration, initial=start))


def step_responses(
    solver: TransientSolver,
    loads: Sequence[Load],
    *,
    duration: float,
    initial: Solution | None,
    progress: Callable[[int], object] | None = None,
) -> Iterator[Solution]:
    """Integrate responses from one state, as many side by side as have room in memory."""
    count = runs_at_once(solver.system, round(duration / solver.step) + 1)
    for part in even_parts(loads, count):
        yield from solver.solve_cases(
            part,
            duration=duration,
            initial=None if initial is None else [initial] * len(part),
            progress=progress,
        )
