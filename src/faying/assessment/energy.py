"""The energy balance of a transient, as a check of its time integration."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import refuse_model
from faying.joint.system import bolt_input
from faying.simulation.energies import contact_energy, half_form, input_displacements
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class EnergyBalance:
    """Energies of a transient at its instants, each (n_time,) [force·length].

    Attributes
    ----------
    times : [time]
    kinetic
        ½ vᵀ M v.
    strain
        ½ uᵀ K u, bolts and sticking springs included.
    contact
        ½ λᵀ (D + R) λ: energy of the penalties in penetration and shear, and of the residual
        compliance of a reduced model.
    dissipated
        ∫ vᵀ C v since the start.
    friction
        Energy dissipated by friction since the start, zero without friction.
    work
        Work of the boundary forces and load patterns since the start.
    bolt_work
        Work of the initial bolt forces since the start.
    """

    times: Vector
    kinetic: Vector
    strain: Vector
    contact: Vector
    dissipated: Vector
    friction: Vector
    work: Vector
    bolt_work: Vector

    @property
    def stored(self) -> Vector:
        """Kinetic energy and all elastic energies."""
        return self.kinetic + self.strain + self.contact

    @property
    def numerical_dissipation(self) -> Vector:
        """Energy lost by the integrator since the start (negative: gained); zero if it were exact.

        Implicit Euler under constant forces can only lose. The generalized-α method with
        ``rho_infinity = 1`` keeps the balance to round-off while no contact point opens or closes.
        """
        supplied = self.work + self.bolt_work - self.dissipated - self.friction
        return np.asarray(supplied - (self.stored - self.stored[0]))


def energy_balance(solution: Solution) -> EnergyBalance:
    """Return the energies of a transient solution of a full or reduced model.

    Raises
    ------
    ModelError
        If the solution is not a transient.

    Notes
    -----
    In M v̇ + C v + K u = f + Gᵀλ the power of the contact forces is λᵀG u̇ = λᵀṡ − λᵀ(D + R) λ̇.
    λᵀṡ vanishes since either the force or the slack s of a point is zero; this gives the stored
    contact energy, and −λ_tᵀṡ_t is the dissipation by friction. Work is summed by the trapezoidal
    rule and dissipation with the mean velocity of each step, both of second order and exactly as
    the midpoint rule balances them. In the first step the force at its end is taken, because the
    load jumps at t = 0+; the error is of third order since the system starts at rest.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> moved = fy.solve_transient(joint, fy.Load({"tip.Fz": -50.0}), step=1e-5, duration=1e-4)
    >>> bool((fy.energy_balance(moved).kinetic[1:] > 0.0).all())
    True
    """
    system, u, v = solution.system, solution.states, solution.velocities
    if solution.times is None or v is None:
        refuse_model(
            f"solution '{solution.name}' is not a transient, so it has no energy balance; "
            "use the result of solve_transient"
        )
    steps, move = np.diff(solution.times), np.diff(u, axis=0)
    work = _trapezoidal(solution.inputs, input_displacements(system, u))
    bolts = [bolt_input(system, bolt) for bolt in system.bolts]
    return EnergyBalance(
        times=solution.times,
        kinetic=half_form(system.M, v),
        strain=half_form(system.K, u),
        contact=contact_energy(system.contact, solution.contact_forces, solution.shear_forces),
        dissipated=_cumulative(2 * half_form(system.C, move) / steps),
        friction=np.cumsum(np.broadcast_to(solution.dissipation, len(u))),
        work=_cumulative(np.delete(work, bolts, axis=1).sum(axis=1)),
        bolt_work=_cumulative(work[:, bolts].sum(axis=1)),
    )


def _trapezoidal(forces: Matrix, displacements: Matrix) -> Matrix:
    """Return the work (n_time - 1, n) of each input in each step."""
    mean = (forces[1:] + forces[:-1]) / 2
    mean[0] = forces[1]
    return mean * np.diff(displacements, axis=0)


def _cumulative(increments: Vector) -> Vector:
    return np.concatenate([[0.0], np.cumsum(increments)])
