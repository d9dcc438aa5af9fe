"""Campaigns of transient responses of one model to many loads, several loads side by side."""

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
    """Compute the transient responses of one full or reduced model to many loads.

    Parameters
    ----------
    build
        Builds the preloaded model; called once by each worker, which factorizes it once for all
        its loads. A function of a module, or ``functools.partial`` of one.
    loads
        Loads by name.
    executor
        Executor of the tasks; this process unless given.
    step, duration : [time]
    integrator
        :class:`ImplicitEuler` unless given.
    take
        Function of a module from a solution to the arrays to keep; :func:`responses` unless given.
    side_by_side
        Largest number of loads that a worker integrates together; :func:`grouped` chooses it unless
        given. Their histories are in memory at once, so the number is smaller where
        :data:`faying.simulation.instants.HISTORY_BYTES` are too few for them.
    keep
        Folder in which results are kept as they come, to resume from; see :func:`run_campaign`.
    progress
        Called with the name of each load when its result is complete.

    Returns
    -------
    Mapping
        Name of the load to its arrays.

    Raises
    ------
    FayingError
        As :func:`run_campaign`, or if ``side_by_side`` is not positive.

    Notes
    -----
    The factorization is read once a step for all loads of a group. Groups depend on the order and
    number of the loads alone, so that every executor gives the same numbers. Other groups change
    pressures by about 1e-10 of the largest.
    """
    prepare = partial(
        _prepare, build, step=step, duration=duration, integrator=integrator, take=take or responses
    )
    groups = grouped(loads, side_by_side)
    return run_grouped_campaign(prepare, groups, executor, keep=keep, progress=progress)


def responses(solution: Solution) -> Arrays:
    """Return pressures, gaps, forces and boundary displacements of a transient solution.

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
    """Build and factorize the model on a worker, and return the function of its tasks."""
    system = build()
    solver, start = transient_solver(system, step=step, integrator=integrator), solve_static(system)
    # Keep no solution here: it refers to the histories of its whole group.
    return lambda loads: map(take, step_responses(solver, loads, duration=duration, initial=start))


def step_responses(
    solver: TransientSolver,
    loads: Sequence[Load],
    *,
    duration: float,
    initial: Solution | None,
    progress: Callable[[int], object] | None = None,
) -> Iterator[Solution]:
    """Yield the responses to loads from one state, as many side by side as memory holds."""
    count = runs_at_once(solver.system, round(duration / solver.step) + 1)
    for part in even_parts(loads, count):
        yield from solver.solve_cases(
            part,
            duration=duration,
            initial=None if initial is None else [initial] * len(part),
            progress=progress,
        )
