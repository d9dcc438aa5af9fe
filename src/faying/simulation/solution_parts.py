"""Parts of solutions, solutions joined to one, and states of other joints."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from faying._typing import Indices, Vector
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_model
from faying.joint.system import System, input_slices
from faying.simulation.solution import Solution

OF_EACH_STATE = (
    "states",
    "contact_forces",
    "gap",
    "inputs",
    "iterations",
    "shear_forces",
    "shear_slip",
    "dissipation",
    "deepest",
)
"""Arrays of a solution with the case or instant as first axis, if there are several."""

OF_EACH_INSTANT = ("times", "velocities", "accelerations", "substeps", "step_error")
"""Further arrays of transients."""


def some_states(solution: Solution, at: Indices) -> Solution:
    """Return a solution with some of its states, copied so that the others can be freed."""
    arrays = _arrays(solution)
    return replace(solution, **{name: getattr(solution, name)[at] for name in arrays})


def without_states(solution: Solution) -> Solution:
    """Return a transient with its contact alone, without displacements and their derivatives."""
    nothing = np.zeros((len(solution.states), 0))
    return replace(solution, states=nothing, velocities=None, accelerations=None)


def joined(solutions: Sequence[Solution]) -> Solution:
    """Return one solution with the states of several in sequence, otherwise as the last one."""
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(solution, name) for solution in solutions])
        for name in _arrays(solutions[-1])
    }
    return replace(solutions[-1], **arrays)


def arrays_of(solution: Solution) -> dict[str, Any]:
    """Return all numerical arrays of a static solution, by name."""
    values = {name: getattr(solution, name) for name in OF_EACH_STATE}
    return {name: np.asarray(value) for name, value in values.items() if value is not None}


def check_points(system: System, state: Solution) -> None:
    """Refuse a state whose contact points differ from those of a joint."""
    ours, theirs = dict(system.contact.slices), dict(state.system.contact.slices)
    for name in {**ours, **theirs}:
        if ours.get(name) == theirs.get(name):
            if system.contact is state.system.contact:
                continue
            mine, other = (joint.interfaces[name].points for joint in (system, state.system))
            # Points of another mesh differ by parts of an element; saved models keep theirs.
            reach = DECK_DIGITS * float(np.ptp(mine, axis=0).max(initial=0.0))
            if mine is other or (np.abs(mine - other) <= reach).all():
                continue
        refuse_model(
            f"the state '{state.name}' is of another joint: its contact points of interface "
            f"'{name}' are others; give one of a joint with the same interfaces"
        )


def carried_inputs(system: System, state: Solution) -> Vector:
    """Return the inputs (n_input,) of a joint under the loads of the last state of a solution."""
    check_points(system, state)
    inputs: Vector = np.atleast_2d(state.inputs)[-1]
    if state.system is system:
        return inputs
    places = input_slices(system)
    result = np.zeros(sum(at.stop - at.start for at in places.values()))
    for (kind, name), at in input_slices(state.system).items():
        to, values = places.get((kind, name), slice(0, 0)), inputs[at]
        if to.stop - to.start == len(values):
            result[to] = values
        elif values.any():
            refuse_model(
                f"the state '{state.name}' carries {kind} '{name}', which the joint does not have "
                "like that; give the joint that too, or a state without it"
            )
    return result


def _arrays(solution: Solution) -> list[str]:
    return [name for name in OF_EACH_STATE + OF_EACH_INSTANT if np.ndim(getattr(solution, name))]
