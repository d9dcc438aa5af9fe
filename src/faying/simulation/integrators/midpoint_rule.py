"""A toy integrator: the energy-decaying scheme without its decay."""

from dataclasses import dataclass
from typing import final

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.joint.system import System
from faying.simulation.integrators.energy_decaying import EnergyDecaying
from faying.simulation.integrators.integrator import Motion
from faying.simulation.step_contact import MeanContact

_RULE = EnergyDecaying(1.0)


@final
@dataclass(frozen=True)
class MidpointRule:
    """The midpoint rule with the mean contact forces of :class:`EnergyDecaying`."""

    name = "midpoint-rule"
    force_weight = _RULE.force_weight
    needs_acceleration = _RULE.needs_acceleration

    def effective_matrix(self, system: System, step: float) -> SparseMatrix | Matrix:
        """Return A."""
        return _RULE.effective_matrix(system, step)

    def right_hand_side(self, system: System, motion: Motion, step: float) -> Vector:
        """Return b without the new forces."""
        return _RULE.right_hand_side(system, motion, step)

    def step_contact(self, condensed: CondensedContact) -> MeanContact:
        """Return the mean contact forces."""
        return _RULE.step_contact(condensed)

    def kept_force(self, applied: Vector, contact: Vector) -> Vector:
        """Return what the next step asks for."""
        return _RULE.kept_force(applied, contact)

    def advance(self, motion: Motion, u: Vector, force: Vector, step: float) -> Motion:
        """Return the motion at the end of the step."""
        return _RULE.advance(motion, u, force, step)
