"""Frictional contact of a full model along a row of instants known at its ports."""

from functools import partial

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.increment import Increment, displaced
from faying.joint.system import Joint
from faying.simulation.path import PathStep, contact_along, state_of
from faying.simulation.solution import Solution
from faying.simulation.static import ContactStates


def solve_increments(model: Joint, free: Matrix, begin: Solution | None) -> ContactStates:
    """Solve contact at every instant, each going on from where the one before left the joint.

    Without contact forces pairs move by ``free`` (n_time, n_relative). The first state of ``begin``
    has the slip and the forces to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.
    """
    return contact_along(model, free, partial(_begun, model, free[0], begin))


def _begun(model: Joint, free: Vector, begin: Solution | None) -> PathStep:
    contact, solver = model.contact, model.static_contact.increments
    slip, forces = np.zeros((2, contact.n_points)), np.zeros((3, contact.n_points))
    deepest = None
    if begin is not None:
        first = state_of(begin, 0)
        forces[: 1 + len(first.shear_forces)] = [first.contact_forces, *first.shear_forces]
        slip[: len(first.shear_slip)], deepest = first.shear_slip, first.deepest
    return PathStep(
        relative=free,
        increment=Increment(
            forces=forces,
            slack=np.zeros_like(forces),
            moved=displaced(solver, free, forces),
            iterations=0,
            residual=0.0,
            deepest=deepest,
        ),
        slip=slip,
    )
