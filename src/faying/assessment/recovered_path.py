"""Frictional contact of a full model along a row of instants known at its ports."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Indices, Matrix
from faying.contact.increment import Increment
from faying.contact.increment_solver import displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.joint.system import Joint
from faying.simulation.path import PathStep, deepest_of, follow
from faying.simulation.solution import Solution


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ContactPath:
    """Contact at every instant.

    Attributes
    ----------
    forces, gap : (n_time, n_point) [force], [length]
    shear_forces, slip : (n_time, 2, n_point) [force], [length]
        Tangential components.
    iterations : (n_time,)
    """

    forces: Matrix
    gap: Matrix
    shear_forces: Matrix
    slip: Matrix
    iterations: Indices
    deepest: Matrix | None


def solve_increments(model: Joint, free: Matrix, begin: Solution | None) -> ContactPath:
    """Solve one increment for each instant, from where the one before left the joint.

    Without contact forces pairs move by ``free`` (n_time, n_relative). The first state of ``begin``
    has the slip and the forces to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.
    """
    contact, solver = model.contact, model.static_contact.increments
    slip, forces = np.zeros((2, contact.n_points)), np.zeros((3, contact.n_points))
    deepest = None if begin is None or begin.deepest is None else np.atleast_2d(begin.deepest)[0]
    if begin is not None and begin.shear_slip is not None and begin.shear_forces is not None:
        slip = np.reshape(begin.shear_slip, (-1, *slip.shape))[0]
        forces[0] = np.atleast_2d(begin.contact_forces)[0]
        forces[1:] = np.reshape(begin.shear_forces, (-1, *slip.shape))[0]
    state = PathStep(
        relative=free[0],
        increment=Increment(
            forces=forces,
            slack=np.zeros_like(forces),
            moved=displaced(solver, free[0], forces),
            iterations=0,
            residual=0.0,
            deepest=deepest,
        ),
        slip=slip,
    )
    steps, laws = list(follow(solver, free, state)), LawsAtPoints(contact=contact)
    return ContactPath(
        forces=np.array([step.increment.forces[0] for step in steps]),
        gap=np.array([step.increment.gap(laws) for step in steps]),
        shear_forces=np.array([step.increment.forces[1:] for step in steps]),
        slip=np.array([step.slip for step in steps]),
        iterations=np.array([step.iterations for step in steps]),
        deepest=deepest_of(contact, steps),
    )
