"""A trajectory of a reduced model under contact forces that are known."""

from dataclasses import replace

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.joint.system import input_forces
from faying.linalg.factorization import factorize
from faying.simulation.integrators import ImplicitEuler, Integrator, Motion
from faying.simulation.solution import Solution
from faying.simulation.static import relative_forces


def reintegrate(
    solution: Solution, contact_forces: Matrix, *, integrator: Integrator | None = None
) -> Solution:
    """Repeat a reduced simulation with given contact forces in place of its own.

    One sweep of the waveform iteration *recover, reintegrate, recover*: the contact forces that
    :func:`~faying.assessment.recovery.recover_pressure` finds give better accelerations than the
    reduced model's own. One or two sweeps halve the error after a jump of the load; more of them
    slowly amplify what the basis cannot follow.

    Parameters
    ----------
    solution
        Transient of a reduced model at equal steps.
    contact_forces : (n_time, n_point) [force]
    integrator
        The one that made the solution; :class:`ImplicitEuler` unless given.

    Returns
    -------
    Solution
        Of the same system, with these contact forces; the start is their static state.

    Raises
    ------
    ModelError
        If the solution is no transient, has unequal steps or friction, or the scheme takes forces
        from within a step.

    Notes
    -----
    Linear: one dense factorization and two products per step.
    """
    scheme = ImplicitEuler() if integrator is None else integrator
    step = _equal_step(solution)
    if scheme.force_weight != 1:
        message = (
            f"reintegration takes the forces at the end of each step, {scheme.name} those of its "
            "whole length: simulate with a compliance model instead"
        )
        raise ModelError(message)
    system = solution.system
    system.contact.check_frictionless()
    force = input_forces(system, solution.inputs) + relative_forces(system, contact_forces)
    effective = factorize(scheme.effective_matrix(system, step))
    start = system.factorize_static().solve(force[0])
    rest = np.zeros_like(start)
    motion = Motion(start, rest, rest, force[0], rest, contact_forces[0])
    motions = [motion]
    for new in force[1:]:
        right = scheme.right_hand_side(system, motion, step) + scheme.force_weight * new
        motion = scheme.advance(motion, effective.solve(right), new, step)
        motions.append(motion)
    states = np.array([motion.u for motion in motions])
    relative = states @ system.contact.relative_operator.T
    return replace(
        solution,
        states=states,
        velocities=np.array([motion.v for motion in motions]),
        accelerations=np.array([motion.a for motion in motions]),
        contact_forces=contact_forces,
        gap=(system.contact.interpolation @ relative.T).T + system.contact.initial_gap,
    )


def _equal_step(solution: Solution) -> float:
    times = solution.times
    if times is None or len(times) < 2:
        message = "only a transient solution can be reintegrated"
        raise ModelError(message)
    steps = np.diff(times)
    if np.ptp(steps) > 1e-6 * steps.mean():
        message = "the instants of the solution are not equally spaced; reintegrate all of them"
        raise ModelError(message)
    return float(steps.mean())
