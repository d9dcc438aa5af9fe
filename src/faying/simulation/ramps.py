"""Many loads of a joint that remembers, each ramped up on its own from one state."""

from collections import deque

import numpy as np

from faying._typing import Matrix
from faying.joint.system import System
from faying.simulation.path import PathStep, assembled, follow, moved_alone, path_start
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static_inputs


def solve_ramps(
    system: System, inputs: Matrix, rest: Solution, *, increments: int, name: str = "ramps"
) -> Solution:
    """Solve many loads, each in equal increments from the last state of a path; its end of each.

    Inputs (n_case, n_input) [force] are boundary forces and initial bolt forces. The solution has
    one entry per load, with ``traction`` and ``slip``; iterations and dissipation are those of the
    last increment.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.

    Notes
    -----
    As many increments as :func:`faying.solve_path` with the same loads, and one back-substitution
    for each load. Where contact remembers nothing they are cases, solved together.
    """
    if system.contact.forgets:
        return solve_static_inputs(system, inputs, name)
    step = path_start(system, rest)
    solver = system.static_contact.increments
    begun = np.atleast_2d(rest.inputs)[-1]
    shares = np.arange(1, increments + 1)[:, None] / increments
    ends: list[PathStep] = []
    for row in inputs:
        relative = moved_alone(system, begun + shares * (row - begun))
        ends += deque(follow(solver, relative, step), maxlen=1)
    return assembled(system, inputs, ends, name)
