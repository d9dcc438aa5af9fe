"""States of contact points along a path: stick, slip or open, and slip of a whole interface.

A point slips in an increment where its traction reaches the bound μ p and its slip changes.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.contact import Contact
from faying.digits import SOLVED
from faying.simulation.path import last_of
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import check_points

OPEN, STICK, SLIP = 0, 1, 2
"""States of a contact point; closed points without friction always slip."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipStates:
    """The states of contact points in each increment of a path.

    Attributes
    ----------
    status : (n_increment, n_point)
        0 open, 1 stick, 2 slip.
    open_share, stick_share, slip_share : (n_increment,)
        Shares of the area of all interfaces with friction; zero without friction.
    macroslip : (n_increment,)
        Whether all closed points slip on some interface with friction.
    """

    status: Indices
    open_share: Vector
    stick_share: Vector
    slip_share: Vector
    macroslip: Mask

    @property
    def slip_of_closed(self) -> Vector:
        """Slipping area over the area in contact (n_increment,); zero without contact."""
        closed = self.stick_share + self.slip_share
        return self.slip_share / np.where(closed > 0, closed, 1.0)


def slip_states(path: Solution, initial: Solution | None = None) -> SlipStates:
    """Return the states of points in each increment of a path.

    The slip before the path is zero, or that of the state from which it continued.
    """
    return point_states(
        path.system.contact, path.contact_forces, path.shear_forces, slip_history(path, initial)
    )


def point_states(contact: Contact, normal: Matrix, shear: Matrix, slip: Matrix) -> SlipStates:
    """Return the states of points under given forces.

    Normal (n_increment, n_point) and shear forces (n_increment, n_tangent, n_point) [force]; slip
    (n_increment + 1, n_tangent, n_point) [length] before the first increment and after each.
    """
    farthest = np.linalg.norm(slip, axis=1).max(initial=0.0)
    moved = np.linalg.norm(np.diff(slip, axis=0), axis=1) > SOLVED * farthest
    status = np.where(moved & ~contact.sticking(normal, shear), SLIP, STICK)
    status[:, contact.coefficients == 0] = SLIP
    status = np.where(normal > 0, status, OPEN)
    shares = _area_shares(status, contact.weights, contact.rubbing)
    whole = [all_slip(status[:, contact.slices[name]]) for name in contact.rubbing_interfaces]
    return SlipStates(
        status=status,
        open_share=shares[OPEN],
        stick_share=shares[STICK],
        slip_share=shares[SLIP],
        macroslip=np.any(whole, axis=0) if whole else np.zeros(len(normal), dtype=bool),
    )


def slip_history(path: Solution, initial: Solution | None = None) -> Matrix:
    """Return the slip before a path and after each increment (n_increment + 1, n_tangent, n_point).

    An initial state without friction has zero slip.
    """
    shape = (np.size(path.iterations), *path.shear_slip.shape[-2:])
    first = np.zeros((1, *shape[1:]))
    if initial is not None:
        check_points(path.system, initial)
        earlier = last_of(initial).shear_slip[: shape[1]]
        first[0, : len(earlier)] = earlier
    return np.concatenate([first, path.shear_slip.reshape(shape)])


def _area_shares(status: Indices, weights: Vector, rubbing: Indices) -> Matrix:
    """Return the shares of area (3, n_increment) in each state, of points with friction."""
    statuses, area = status[:, rubbing], weights[rubbing]
    total = float(area.sum()) or 1.0
    return np.array([(statuses == state) @ area / total for state in (OPEN, STICK, SLIP)])


def all_slip(status: Indices) -> Mask:
    """Return in which increments all closed points slip, from states (n_increment, n_point)."""
    return np.asarray((status != STICK).all(axis=1) & (status == SLIP).any(axis=1))
