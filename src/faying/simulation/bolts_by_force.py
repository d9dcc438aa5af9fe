"""Joints whose bolts are known by their forces: initial forces are unknown beside contact."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Matrix, Vector
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import ForcedContact, Increment
from faying.exceptions import ConvergenceError
from faying.joint.system import Joint


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class BoltsByForce:
    """The contact problem of a joint some of whose bolts are known by their forces.

    Attributes
    ----------
    joint
        Without a reduced set of contact forces.
    bolts : (n_known,)
        Their numbers.
    """

    joint: Joint
    bolts: Indices

    def solve(
        self, forces: Vector, locked: Vector, slip: Matrix | float, start: Increment | None
    ) -> tuple[Increment, Vector]:
        """Return where contact stands, and the initial forces of all bolts (n_bolt,).

        Forces T (n_known,) [force] are known; of locked bolts the initial forces (n_bolt,) [force]
        are. Slip so far is (2, n_point) [length]. The start is the increment before, or a similar
        one.

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
        """Return where contact stands with all initial forces (n_bolt,) given."""
        ports, contact = self.joint.port_compliance, self.joint.contact
        free, offset = -initial @ ports.contact_columns[ports.bolts], contact.offset(slip)
        return self.joint.static_contact.increments.solve(free, offset, start)

    @cached_property
    def _springs(self) -> ForcedSprings:
        """The known bolts."""
        ports, bolts = self.joint.port_compliance, self.bolts
        every = list(self.joint.bolts.values())
        return ForcedSprings(
            columns=ports.contact_columns[ports.bolts][bolts],
            between=ports.input_rows[ports.bolts, ports.bolts][np.ix_(bolts, bolts)],
            stiffness=np.array([every[bolt].stiffness for bolt in bolts]),
        )

    @cached_property
    def _loosened(self) -> ForcedContact:
        """The contact of the joint without their springs."""
        return self.joint.static_contact.increments.loosened(self._springs)


def forces_of_bolts(system: Joint, initial: Vector, contact: Increment) -> Vector:
    """Return the forces of all bolts (n_bolt,), locked at initial forces where contact stands."""
    ports = system.port_compliance
    pressed = system.contact.at_pairs(contact.forces[0], contact.forces[1:])
    elongation = ports.contact_columns[ports.bolts] @ pressed
    elongation = elongation - ports.input_rows[ports.bolts, ports.bolts] @ initial
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    return np.asarray(stiffness * elongation + initial)
