"""Frictional contact of a full model along a row of instants known at its ports."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.frictional import FrictionalContact, Increment
from faying.exceptions import ConvergenceError
from faying.joint.system import Joint
from faying.simulation.path import MOST_DIVISIONS
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


def solve_increments(model: Joint, free: Matrix, begin: Solution | None) -> ContactPath:
    """Solve one increment for each instant, from where the one before left the joint.

    Parameters
    ----------
    free : (n_time, n_relative)
        What pairs move without contact forces.
    begin
        Whose first state has the slip and the forces to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.
    """
    contact, solver = model.contact, model.static_contact.frictional
    slip, forces = np.zeros((2, contact.n_points)), None
    if begin is not None and begin.shear_slip is not None and begin.shear_forces is not None:
        slip = np.reshape(begin.shear_slip, (-1, *slip.shape))[0]
        shear = np.reshape(begin.shear_forces, (-1, *slip.shape))[0]
        forces = np.vstack([np.atleast_2d(begin.contact_forces)[0], shear])
    path = ContactPath(
        forces=np.empty((len(free), contact.n_points)),
        gap=np.empty((len(free), contact.n_points)),
        shear_forces=np.empty((len(free), *slip.shape)),
        slip=np.empty((len(free), *slip.shape)),
        iterations=np.empty(len(free), dtype=np.int64),
    )
    before = free[0]
    for row, relative in enumerate(free):
        found, slip = _to(solver, before, relative, slip, forces, MOST_DIVISIONS)
        before, forces = relative, found.forces
        path.forces[row], path.shear_forces[row], path.slip[row] = forces[0], forces[1:], slip
        path.gap[row] = solver.gap(found)
        path.iterations[row] = found.iterations
    return path


def _to(
    solver: FrictionalContact,
    before: Vector,
    relative: Vector,
    slip: Matrix,
    forces: Matrix | None,
    divisions: int,
) -> tuple[Increment, Matrix]:
    """Return an increment and the slip after it; by halves of the way where that is too far."""
    try:
        found = solver.solve(solver.contact.free_slack(relative, slip), forces)
    except ConvergenceError:
        if divisions == 0:
            raise
        middle = (before + relative) / 2
        half, slip = _to(solver, before, middle, slip, forces, divisions - 1)
        return _to(solver, middle, relative, slip, half.forces, divisions - 1)
    return found, slip + found.slack[1:]
