"""A second-order scheme whose energy cannot grow, whatever contact does."""

from dataclasses import dataclass

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.joint.system import System
from faying.simulation.integrators.integrator import Motion
from faying.simulation.integrators.spectral_radius import SpectralRadius
from faying.simulation.step_contact import MeanContact, StepContact


@dataclass(frozen=True)
class EnergyDecaying(SpectralRadius):
    """Second order, chosen damping of unresolved frequencies, and no growth of energy.

    The midpoint rule with a term of second order that damps. With Δ and a bar for the change and
    the mean over a step, and w and a for velocity and acceleration that follow their motion with
    a lag of 2 d h,

        M Δv/h + C Δu/h + K (ū + d² h Δw) = f̄ + Gᵀλ̄,     Δu/h = v̄ + d² h Δa,
        Δu/h = w̄ + 2 d Δw,                                Δv/h = ā + 2 d Δa,

    d = (1 − ρ)/(2 (1 + ρ)). The mean contact force λ̄ of :class:`~.MeanContact` never does more
    work than the stored energy of contact can give. The proof is in
    ``docs/theory/time_integration.md``. For models with residual compliance its pressures are
    poor (``docs/theory/transient_accuracy.md``): take another scheme for them.

    Attributes
    ----------
    rho_infinity
        Spectral radius at infinite frequency, 0 (annihilates) to 1 (no damping; the midpoint rule).
        Above 0 unresolved frequencies ring on in pressures. A motion of 100 steps a period is
        damped by 6e-5 of critical at 0, by 1e-7 at 0.8, an eighth of that with half the step.
        To measure the damping of a joint take 0.8, as :func:`faying.ring_down` does.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> step = fy.Load({"tip.Fz": -100.0})
    >>> moved = fy.solve_transient(
    ...     joint, step, step=1e-5, duration=1e-4, integrator=fy.EnergyDecaying(rho_infinity=0.5)
    ... )
    >>> len(moved.times)
    11
    """

    rho_infinity: float = 0.0

    @property
    def name(self) -> str:
        """Name in reports and studies."""
        return "energy-decaying"

    @property
    def lag(self) -> float:
        """The parameter d, in steps."""
        return 0.5 * (1 - self.rho_infinity) / (1 + self.rho_infinity)

    @property
    def lead(self) -> float:
        """Weight d²/(½ + 2 d) of the lagging terms beside the midpoint rule."""
        return self.lag**2 / (0.5 + 2 * self.lag)

    @property
    def order(self) -> int:
        """Two: half the step has a quarter of the error."""
        return 2

    @property
    def force_weight(self) -> float:
        """One half: forces at both ends have the same weight."""
        return 0.5

    @property
    def needs_acceleration(self) -> bool:
        """False: lagging velocities start at zero, and without energy."""
        return False

    def step_contact(self, condensed: CondensedContact) -> StepContact:
        """Return the law of the mean contact force of a step."""
        return MeanContact(condensed)

    def effective_matrix(self, system: System, step: float) -> SparseMatrix | Matrix:
        """Return M/(κ h²) + C/h + κ K with κ = ½ + d²/(½ + 2 d)."""
        new = 0.5 + self.lead
        return system.M / (new * step**2) + system.C / step + new * system.K

    def right_hand_side(self, system: System, motion: Motion, step: float) -> Vector:
        """Return the terms of the start of the step, without the contact force there."""
        u, v, a, new = motion.u, motion.v, motion.a, 0.5 + self.lead
        inertia = system.M @ (u / step**2 + (v - self.lead * step * a) / step) / new
        elastic = system.K @ ((1 - new) * u - self.lead * step * motion.lagging)
        return inertia + system.C @ (u / step) - elastic + 0.5 * motion.force

    def kept_force(self, applied: Vector, contact: Vector) -> Vector:  # noqa: ARG002
        """Return the external forces; contact enters the balance as the mean over the step."""
        return applied

    def advance(self, motion: Motion, u: Vector, force: Vector, step: float) -> Motion:
        """Return the motion at the end of the step."""
        follow = 0.5 + 2 * self.lag
        speed = (u - motion.u) / step
        change = (speed - motion.v + self.lead * step * motion.a) / (0.5 + self.lead)
        return Motion(
            u=u,
            v=motion.v + change,
            a=motion.a + (change / step - motion.a) / follow,
            force=force,
            lagging=motion.lagging + (speed - motion.lagging) / follow,
            contact=motion.contact,
        )
