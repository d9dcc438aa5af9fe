"""Paths of many increments: what is followed of them is kept for a run that resumes."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.contact.increment import Increment
from faying.contact.increment_solver import IncrementSolver
from faying.execution.checkpoint import Arrays
from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.path import (
    PathStep,
    assembled,
    deepest_of,
    follow,
    moved_alone,
    path_inputs,
    path_start,
    solve_path,
)
from faying.simulation.solution import Solution
from faying.study.stages.checkpointed_steps import SECONDS, CheckpointedSteps

PIECE = 50
"""Increments that are kept together: to write them takes 2 ms with 600 contact points, 13 ms with
3000, a hundredth of what it takes to compute them, or less."""


def follow_path(
    system: System,
    loads: Sequence[Load],
    initial: Solution,
    name: str,
    kept_parts: CheckpointedSteps,
    progress: Callable[[int], object],
) -> tuple[Solution, float]:
    """Solve a sequence of loads, and say what seconds that took, in whichever run.

    The same numbers as of :func:`faying.solve_path`: an increment takes from those before it where
    the last of them left the joint, which is kept with them. It goes on from ``initial``;
    ``progress`` is called with the number of increments that there are more of.
    """
    start = time.perf_counter()
    if system.contact.increments(len(loads)) <= PIECE:
        path = solve_path(system, loads, initial=initial, name=name)
        progress(len(loads))
        return path, time.perf_counter() - start
    inputs = path_inputs(system, loads)
    state, relative = path_start(system, initial), moved_alone(system, inputs)
    solver = system.static_contact.increments
    seconds, steps = time.perf_counter() - start, list[PathStep]()
    for first in range(0, len(inputs), PIECE):
        part = range(first, min(first + PIECE, len(inputs)))
        compute = partial(_followed, solver, relative, state, part)
        arrays = kept_parts.take(f"increments {first + 1} to {part.stop}", compute)
        steps += _unpacked(arrays, relative[first : part.stop], state)
        state, seconds = steps[-1], seconds + float(arrays[SECONDS])
        progress(len(part))
    start = time.perf_counter()
    path = assembled(system, inputs, steps, name)
    return path, seconds + time.perf_counter() - start


def _followed(solver: IncrementSolver, relative: Matrix, state: PathStep, part: range) -> Arrays:
    """Return what is reached after some of the loads, by name, each with them as first axis."""
    steps = list(follow(solver, relative, state, part=part))
    deepest = deepest_of(solver.contact, steps)
    return {
        **({} if deepest is None else {"deepest": deepest}),
        "forces": np.array([step.increment.forces for step in steps]),
        "slack": np.array([step.increment.slack for step in steps]),
        "moved": np.array([step.increment.moved for step in steps]),
        "last": np.array([[step.increment.iterations, step.increment.residual] for step in steps]),
        "slip": np.array([step.slip for step in steps]),
        "iterations": np.array([step.iterations for step in steps]),
        "dissipation": np.array([step.dissipation for step in steps]),
    }


def _unpacked(
    arrays: Mapping[str, Matrix], relative: Matrix, state: PathStep
) -> Iterator[PathStep]:
    """Yield what :func:`_followed` took from the steps after a state."""
    for row, moved in enumerate(relative):
        state = PathStep(
            relative=moved,
            increment=Increment(
                forces=arrays["forces"][row],
                slack=arrays["slack"][row],
                moved=arrays["moved"][row],
                iterations=int(arrays["last"][row, 0]),
                residual=float(arrays["last"][row, 1]),
                deepest=arrays["deepest"][row] if "deepest" in arrays else None,
            ),
            slip=arrays["slip"][row],
            iterations=int(arrays["iterations"][row]),
            dissipation=float(arrays["dissipation"][row]),
            previous=replace(state, previous=None),
        )
        yield state
