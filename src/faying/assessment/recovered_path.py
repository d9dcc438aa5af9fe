"""Frictional contact of a full model along a row of instants known at its ports."""

from functools import partial

from faying._typing import Matrix
from faying.joint.system import Joint
from faying.simulation.path import contact_along, path_at, state_of
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
    first = None if begin is None else state_of(begin, 0)
    return contact_along(model, free, partial(path_at, model, free[0], first))
