"""Implicit Euler, the seed's integrator (§15.4.3)."""

from dataclasses import dataclass

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.joint.system import System
from faying.simulation.integrators.integrator import Motion
from faying.simulation.step_contact import EndContact, StepContact


@dataclass(frozen=True)
class ImplicitEuler:
    """Backward differences for displacement and velocity; first order, strongly damping.

    u₁ = u₀ + h v₁ and M (v₁ − v₀)/h + C v₁ + K u₁ = f₁ combine to

        (M/h² + C/h + K) u₁ = f₁ + M (u₀/h² + v₀/h) + C u₀/h.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> step = fy.Load({"tip.Fz": -100.0})
    >>> moved = fy.solve_transient(
    ...     joint, step, step=1e-5, duration=1e-4, integrator=fy.ImplicitEuler()
    ... )
    >>> len(moved.times)
    11
    """

    @property
    def name(self) -> str:
        """Name in reports and studies."""
        return "implicit-euler"

    @property
    def order(self) -> int:
        """One: half the step has half the error."""
        return 1

    @property
    def force_weight(self) -> float:
        """One: only the new forces enter."""
        return 1.0

    @property
    def needs_acceleration(self) -> bool:
        """False: a step uses displacement and velocity alone."""
        return False

    def effective_matrix(self, system: System, step: float) -> SparseMatrix | Matrix:
        """Return M/h² + C/h + K."""
        return system.M / step**2 + system.C / step + system.K

    def right_hand_side(self, system: System, motion: Motion, step: float) -> Vector:
        """Return M (u₀/h² + v₀/h) + C u₀/h."""
        inertia = system.M @ (motion.u / step**2 + motion.v / step)
        return inertia + system.C @ (motion.u / step)

    def step_contact(self, condensed: CondensedContact) -> StepContact:
        """Return the contact law at the end of a step."""
        return EndContact(condensed)

    def kept_force(self, applied: Vector, contact: Vector) -> Vector:
        """Return the sum of applied and contact forces."""
        return applied + contact

    def advance(self, motion: Motion, u: Vector, force: Vector, step: float) -> Motion:
        """Return the motion at the end of the step."""
        v = (u - motion.u) / step
        a = (v - motion.v) / step
        return Motion(u, v, a, force, motion.lagging, motion.contact)
