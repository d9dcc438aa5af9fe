"""Transient contact solutions of full and reduced models, Eqs. (15.13) and (15.16)."""

from collections.abc import Callable

import numpy as np

from faying._typing import Vector
from faying.contact.condensed import CondensedContact, relative_compliance
from faying.exceptions import ModelError
from faying.linalg.factorization import Factorization, factorize
from faying.linalg.threads import threads_for
from faying.model.system import System, input_forces
from faying.simulation.integrators import ImplicitEuler, Integrator, Motion
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import relative_forces, solve_static

INITIAL_FRACTION = 1e-3
"""Part of a step over which the initial acceleration is averaged.

It bounds the acceleration of massless degrees of freedom; modes the step resolves see a relative
error of its square.
"""


def solve_transient(
    system: System,
    load: Load,
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
) -> Solution:
    """Integrate the response to a load that acts from t = 0+ on a prestressed joint at rest.

    Parameters
    ----------
    system
        Full or reduced model.
    load
        Constant forces act as a step; histories are taken at the end of each step.
    step, duration : [time]
    integrator
        :class:`ImplicitEuler` unless given.
    initial
        Static solution to start from; by default the joint under its bolts alone.
    progress
        Called with 1 after every step.

    Returns
    -------
    Solution
        With ``n_time = round(duration / step) + 1`` instants, the first one being ``initial``.

    Raises
    ------
    ModelError
        If the step is not positive or longer than the duration, or the load does not fit.

    Notes
    -----
    One factorization of the effective matrix, then per step two back-substitutions and a warm
    contact problem. Contact is implicit: the forces at the end of a step obey Eq. (15.7) or
    (15.12) there.
    """
    if not 0 < step <= duration:
        message = (
            f"the time step is {step:g} and the duration {duration:g}; "
            "the step must be positive and no longer than the duration"
        )
        raise ModelError(message)
    scheme = ImplicitEuler() if integrator is None else integrator
    start = solve_static(system) if initial is None else initial
    times: Vector = step * np.arange(round(duration / step) + 1, dtype=np.float64)
    inputs = load.inputs(system, times)
    external = input_forces(system, inputs)
    effective = factorize(scheme.effective_matrix(system, step))
    condensed = _condense_step(system, scheme, effective)

    motion = _initial_motion(system, scheme, start, external[0], step)
    n_time, n_dof = len(times), len(motion.u)
    states, velocities, accelerations = (np.zeros((n_time, n_dof)) for _ in range(3))
    forces = np.zeros((n_time, system.contact.n_points))
    gaps, iterations = np.zeros_like(forces), np.zeros(n_time, dtype=np.int64)
    errors = np.zeros(n_time)
    states[0], accelerations[0] = motion.u, motion.a
    forces[0], gaps[0] = start.contact_forces, start.gap
    active = start.contact_forces > 0
    with threads_for(system.contact.n_points):
        for n in range(1, n_time):
            right = scheme.right_hand_side(system, motion, step) + scheme.force_weight * external[n]
            free = system.contact.relative_operator @ effective.solve(right)
            contact = condensed.solve(free, active)
            from_contact = relative_forces(system, contact.forces)
            u = effective.solve(right + scheme.force_weight * from_contact)
            motion = scheme.advance(motion, u, external[n] + from_contact, step)
            states[n], velocities[n], accelerations[n] = motion.u, motion.v, motion.a
            forces[n], gaps[n] = contact.forces, condensed.gap(contact)
            iterations[n], active = contact.iterations, contact.active
            errors[n] = contact.error
            if progress is not None:
                progress(1)
    return Solution(
        name=load.name,
        system=system,
        states=states,
        contact_forces=forces,
        gap=gaps,
        inputs=np.concatenate([start.inputs[None], inputs[1:]]),
        iterations=iterations,
        contact_error=errors,
        times=times,
        velocities=velocities,
        accelerations=accelerations,
    )


def _condense_step(
    system: System, scheme: Integrator, effective: Factorization
) -> CondensedContact:
    """Compliance of one time step, P A⁻¹ Pᵀ times the weight of the new forces."""
    return CondensedContact(
        contact=system.contact,
        compliance=relative_compliance(system.contact, effective, scheme.force_weight),
    )


def _initial_motion(
    system: System, scheme: Integrator, start: Solution, external: Vector, step: float
) -> Motion:
    """Return the state at rest, with the acceleration the suddenly applied load causes."""
    force = external + relative_forces(system, start.contact_forces)
    rest = np.zeros_like(start.states)
    if not scheme.needs_acceleration:
        return Motion(start.states, rest, rest, force)
    unbalanced = force - system.K @ start.states
    averaging = system.M + (INITIAL_FRACTION * step) ** 2 * system.K
    return Motion(start.states, rest, factorize(averaging).solve(unbalanced), force)
