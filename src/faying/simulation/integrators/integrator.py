"""The interface of one-step time integrators."""

from dataclasses import dataclass
from typing import Protocol

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.joint.system import System
from faying.simulation.step_contact import StepContact


@dataclass(frozen=True, eq=False)
class Motion:
    """State of a system at one instant, or states of several cases with one case a column.

    Attributes
    ----------
    u, v, a : (n_dof,) or (n_dof, n_case)
        Displacement, velocity, acceleration.
    force : (n_dof,) or (n_dof, n_case)
        Forces at that instant, as the next step uses them: external and contact forces,
        f_e + Gᵀλ, or external ones alone.
    lagging : (n_dof,) or (n_dof, n_case)
        Lagging velocity, of schemes that use one for damping.
    contact : (n_point,) or (n_point, n_case)
        Contact forces λ at that instant.
    """

    u: Vector
    v: Vector
    a: Vector
    force: Vector
    lagging: Vector
    contact: Vector


class Integrator(Protocol):
    """A one-step method that reduces M ü + C u̇ + K u = f to A u₁ = b, linear but for contact."""

    @property
    def name(self) -> str:
        """Name in reports and studies."""

    @property
    def order(self) -> int:
        """Order of convergence for smooth motions."""

    @property
    def force_weight(self) -> float:
        """Weight of the new forces in the equation of a step."""

    @property
    def needs_acceleration(self) -> bool:
        """Whether a step uses the acceleration at its start."""

    def effective_matrix(self, system: System, step: float) -> SparseMatrix | Matrix:
        """Return A of the equation A u₁ = b for the new displacement."""

    def right_hand_side(self, system: System, motion: Motion, step: float) -> Vector:
        """Return b without the new forces."""

    def step_contact(self, condensed: CondensedContact) -> StepContact:
        """Return the contact law of a step for contact condensed to its compliance."""

    def kept_force(self, applied: Vector, contact: Vector) -> Vector:
        """Return the forces at the end of a step that the next step needs."""

    def advance(self, motion: Motion, u: Vector, force: Vector, step: float) -> Motion:
        """Return the motion at the end of a step that ends at displacement ``u``.

        The contact forces λ of the motion are not set here.
        """
