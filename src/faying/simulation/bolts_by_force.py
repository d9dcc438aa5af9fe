"""Joints with bolts of prescribed force, whose initial forces are unknowns beside contact."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Matrix, Vector
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import ForcedContact, Increment
from faying.exceptions import ConvergenceError
from faying.joint.system import Joint


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltsByForce:
    """The contact problem of a joint in which the forces of some bolts are prescribed.

    Attributes
    ----------
    joint
        Model whose contact forces are not reduced.
    bolts : (n_known,)
        Numbers of these bolts.
    """

    joint: Joint
    bolts: Indices

    def solve(
        self, forces: Vector, locked: Vector, slip: Matrix | float, start: Increment | None
    ) -> tuple[Increment, Vector]:
        """Return the contact state, and the initial forces of all bolts (n_bolt,).

        ``forces`` T (n_known,) [force] are prescribed, ``locked`` (n_bolt,) [force] are the initial
        forces of all other bolts, and ``slip`` (2, n_point) [length] is the slip so far. ``start``
        is the increment before, or a similar one.

        Raises
        ------
        ConvergenceError
            If nothing resists the bolts, or contact is not solved.

        Notes
        -----
        One contact problem, (T1).
        """
        ports, springs = self.joint.port_compliance, self._springs
        others = locked.copy()
        others[self.bolts] = 0.0
        free = -others @ ports.contact_columns[ports.bolts]
        rows = ports.input_rows[ports.bolts, ports.bolts]
        elongations = forces / springs.stiffness + rows[self.bolts] @ others
        about, offset = np.maximum(locked[self.bolts], forces), self.joint.contact.offset(slip)
        try:
            increment, initial = self._loosened.solve(free, offset, elongations, about, start)
        except LinAlgError:
            names = np.array(list(self.joint.bolts))[self.bolts]
            message = (
                f"bolt{'s' * (len(names) > 1)} {', '.join(names)} cannot be tightened to "
                f"{', '.join(f'{force:g}' for force in forces)}: what they pull at gives way; "
                "check that each clamps an interface"
            )
            raise ConvergenceError(message) from None
        others[self.bolts] = initial
        return increment, others

    def at(self, initial: Vector, slip: Matrix | float, start: Increment | None) -> Increment:
        """Return the contact state for given initial forces of all bolts (n_bolt,)."""
        ports, contact = self.joint.port_compliance, self.joint.contact
        free, offset = -initial @ ports.contact_columns[ports.bolts], contact.offset(slip)
        return self.joint.static_contact.increments.solve(free, offset, start)

    @cached_property
    def _springs(self) -> ForcedSprings:
        """The bolts of prescribed force as springs across the pairs."""
        ports, bolts = self.joint.port_compliance, self.bolts
        every = list(self.joint.bolts.values())
        return ForcedSprings(
            columns=ports.contact_columns[ports.bolts][bolts],
            between=ports.input_rows[ports.bolts, ports.bolts][np.ix_(bolts, bolts)],
            stiffness=np.array([every[bolt].stiffness for bolt in bolts]),
        )

    @cached_property
    def _loosened(self) -> ForcedContact:
        """The contact solver of the joint without these springs."""
        return self.joint.static_contact.increments.loosened(self._springs)


def forces_of_bolts(system: Joint, initial: Vector, contact: Increment) -> Vector:
    """Return the forces of all bolts (n_bolt,) from initial forces and the contact state."""
    ports = system.port_compliance
    pressed = system.contact.at_pairs(contact.forces[0], contact.forces[1:])
    elongation = ports.contact_columns[ports.bolts] @ pressed
    elongation = elongation - ports.input_rows[ports.bolts, ports.bolts] @ initial
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    return np.asarray(stiffness * elongation + initial)
