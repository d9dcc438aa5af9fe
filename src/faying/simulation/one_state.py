"""One state of a solution that has several."""

from dataclasses import replace

import numpy as np

from faying.simulation.solution import Solution


def one_state(solution: Solution, number: int = -1) -> Solution:
    """Return one case or increment of a static solution by itself, the last unless told."""
    if solution.contact_forces.ndim == 1:
        return solution
    shear, slip = solution.shear_forces, solution.shear_slip
    every = (len(solution.contact_forces),)
    return replace(
        solution,
        states=solution.states[number],
        contact_forces=solution.contact_forces[number],
        gap=solution.gap[number],
        inputs=solution.inputs[number],
        iterations=solution.iterations[number],
        contact_error=np.broadcast_to(solution.contact_error, every)[number],
        shear_forces=None if shear is None else shear[number],
        shear_slip=None if slip is None else slip[number],
        dissipation=np.broadcast_to(solution.dissipation, every)[number],
    )
