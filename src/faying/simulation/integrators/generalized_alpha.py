"""Generalized-α (Chung & Hulbert 1993, doi:10.1115/1.2900803)."""

from dataclasses import dataclass

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.joint.system import System
from faying.simulation.integrators.integrator import Motion
from faying.simulation.integrators.spectral_radius import SpectralRadius
from faying.simulation.step_contact import EndContact, StepContact


@dataclass(frozen=True)
class GeneralizedAlpha(SpectralRadius):
    """Second order with a chosen damping of frequencies that the step cannot resolve.

    Balance holds between the ends of the step, M a_m + C v_f + K u_f = f_f with
    x_m = (1 − α_m) x₁ + α_m x₀ and x_f = (1 − α_f) x₁ + α_f x₀; displacement and velocity follow
    Newmark's formulas. Contact forces are weighted like external ones.

    Attributes
    ----------
    rho_infinity
        Spectral radius at infinite frequency, 0 (annihilates) to 1 (no damping; the trapezoidal
        rule in its midpoint form).

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> step = fy.Load({"tip.Fz": -100.0})
    >>> moved = fy.solve_transient(
    ...     joint, step, step=1e-5, duration=1e-4, integrator=fy.GeneralizedAlpha(rho_infinity=0.5)
    ... )
    >>> len(moved.times)
    11
    """

    @property
    def name(self) -> str:
        """Name in reports and studies."""
        return "generalized-alpha"

    @property
    def alpha_m(self) -> float:
        """Weight of the old acceleration."""
        return (2 * self.rho_infinity - 1) / (self.rho_infinity + 1)

    @property
    def alpha_f(self) -> float:
        """Weight of the old displacement, velocity and force."""
        return self.rho_infinity / (self.rho_infinity + 1)

    @property
    def gamma(self) -> float:
        """Newmark's γ for second order."""
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self) -> float:
        """Newmark's β for the most high-frequency damping."""
        return 0.25 * (1 - self.alpha_m + self.alpha_f) ** 2

    @property
    def order(self) -> int:
        """Two: half the step has a quarter of the error."""
        return 2

    @property
    def force_weight(self) -> float:
        """Weight 1 − α_f of the new forces."""
        return 1.0 - self.alpha_f

    @property
    def needs_acceleration(self) -> bool:
        """True: a step uses the acceleration at its start."""
        return True

    def effective_matrix(self, system: System, step: float) -> SparseMatrix | Matrix:
        """Return (1 − α_m)/(β h²) M + (1 − α_f) γ/(β h) C + (1 − α_f) K."""
        mass = (1 - self.alpha_m) / (self.beta * step**2)
        damping = (1 - self.alpha_f) * self.gamma / (self.beta * step)
        return mass * system.M + damping * system.C + (1 - self.alpha_f) * system.K

    def right_hand_side(self, system: System, motion: Motion, step: float) -> Vector:
        """Return the terms of the start of the step."""
        u, v, a = motion.u, motion.v, motion.a
        beta, gamma, new = self.beta, self.gamma, 1 - self.alpha_f
        inertia = (1 - self.alpha_m) / beta * (u / step**2 + v / step)
        inertia = inertia + ((1 - self.alpha_m) * (0.5 / beta - 1) - self.alpha_m) * a
        drag = new * gamma / (beta * step) * u + (new * gamma / beta - 1) * v
        drag = drag + new * step * (0.5 * gamma / beta - 1) * a
        old: Vector = self.alpha_f * (motion.force - system.K @ u)
        return system.M @ inertia + system.C @ drag + old

    def step_contact(self, condensed: CondensedContact) -> StepContact:
        """Return the contact law at the end of a step."""
        return EndContact(condensed)

    def kept_force(self, applied: Vector, contact: Vector) -> Vector:
        """Return the sum of applied and contact forces."""
        return applied + contact

    def advance(self, motion: Motion, u: Vector, force: Vector, step: float) -> Motion:
        """Return the motion at the end of the step by Newmark's formulas."""
        change = (u - motion.u - step * motion.v) / (self.beta * step**2)
        a = change - (0.5 / self.beta - 1) * motion.a
        v = motion.v + step * ((1 - self.gamma) * motion.a + self.gamma * a)
        return Motion(u, v, a, force, motion.lagging, motion.contact)
