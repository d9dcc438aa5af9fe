"""Paths of many increments: what is followed of them is kept for a run that resumes."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from faying._typing import Matrix
from faying.contact.increment import IncrementSolver
from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.path import (
    PathStep,
    assembled,
    follow,
    moved_alone,
    path_inputs,
    path_start,
    solve_path,
)
from faying.simulation.solution import Solution
from faying.study.stages.checkpointed_steps import CheckpointedSteps

INCREMENTS_AT_ONCE = 50
"""Increments that are kept together: to write them takes 12 ms with 600 contact points, 18 ms with
3000, some hundredths of what it takes to compute them, or less."""


@dataclass(frozen=True, eq=False)
class _Piece:
    """Increments that are kept together."""

    steps: tuple[PathStep, ...]


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
    if system.contact.increments(len(loads)) <= INCREMENTS_AT_ONCE:
        path = solve_path(system, loads, initial=initial, name=name)
        progress(len(loads))
        return path, time.perf_counter() - start
    inputs = path_inputs(system, loads)
    state, relative = path_start(system, initial), moved_alone(system, inputs)
    solver = system.static_contact.increments
    seconds, steps = time.perf_counter() - start, list[PathStep]()
    for first in range(0, len(inputs), INCREMENTS_AT_ONCE):
        part = range(first, min(first + INCREMENTS_AT_ONCE, len(inputs)))
        compute = partial(_followed, solver, relative, state, part)
        followed, took = kept_parts.value(_Piece, f"increments {first + 1} to {part.stop}", compute)
        for step in followed.steps:
            state = replace(step, previous=replace(state, previous=None))
            steps.append(state)
        seconds += took
        progress(len(part))
    start = time.perf_counter()
    path = assembled(system, inputs, steps, name)
    return path, seconds + time.perf_counter() - start


def _followed(solver: IncrementSolver, relative: Matrix, state: PathStep, part: range) -> _Piece:
    """Return what is reached after some of the loads."""
    steps = follow(solver, relative, state, part=part)
    return _Piece(tuple(replace(step, previous=None) for step in steps))
