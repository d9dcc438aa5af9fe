"""Some states of a solution, and solutions one after the other as one."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from faying._typing import Indices
from faying.simulation.solution import Solution

OF_EACH_STATE = (
    "states",
    "contact_forces",
    "gap",
    "inputs",
    "iterations",
    "contact_error",
    "shear_forces",
    "shear_slip",
    "dissipation",
)
"""Arrays of a solution that begin with the case or instant, where there are several."""

OF_EACH_INSTANT = ("times", "velocities", "accelerations", "substeps", "step_error")
"""Arrays that transients have besides."""


def some_states(solution: Solution, at: Indices) -> Solution:
    """Return a solution with some of its states, in arrays of their own: the rest may go."""
    kept = _arrays(solution)
    return replace(solution, **{name: getattr(solution, name)[at] for name in kept})


def without_states(solution: Solution) -> Solution:
    """Return what a transient says of contact, without its displacements and their derivatives."""
    nothing = np.zeros((len(solution.states), 0))
    return replace(solution, states=nothing, velocities=None, accelerations=None)


def joined(solutions: Sequence[Solution]) -> Solution:
    """Return the states of several solutions, one after the other, as one like the last."""
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(one, name) for one in solutions])
        for name in _arrays(solutions[-1])
    }
    return replace(solutions[-1], **arrays)


def _arrays(solution: Solution) -> list[str]:
    return [name for name in OF_EACH_STATE + OF_EACH_INSTANT if np.ndim(getattr(solution, name))]
