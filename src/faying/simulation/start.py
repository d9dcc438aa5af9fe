"""Initial states of transients: the joint at rest under its bolts, or given static states."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying.contact.state import ContactState
from faying.exceptions import ModelError, refuse_model
from faying.joint.smooth_joint import smooth_joint
from faying.joint.system import System, input_forces
from faying.linalg.factorization import factorize
from faying.simulation.integrators import Integrator, Motion
from faying.simulation.load import Load
from faying.simulation.path import (
    last_of,
    left_by,
    moved_alone,
    solve_static,
    unstressed,
)
from faying.simulation.path_steps import follow
from faying.simulation.restart import Restart, each_of
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import carried_inputs
from faying.simulation.static import AT_REST, relative_forces


def released_state(system: System, load: Load = AT_REST) -> Solution:
    """Solve a load without friction, as a state of the joint without traction.

    A path that continues from it (``initial`` of :func:`faying.solve_path`) is that of a joint
    tightened without friction. The solution has one entry, of the system itself.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`faying.solve_static`.
    """
    joint, inputs = smooth_joint(system), load.inputs(system, np.zeros(1))
    relative = moved_alone(joint, inputs)
    (step,) = follow(joint.static_contact.increments, relative, unstressed(joint))
    return left_by(system, joint, inputs[0], step, load.name)


def starting_states(
    system: System, loads: Sequence[Load], initial: Sequence[Solution] | None
) -> list[Solution]:
    """Return one static state for each load."""
    if initial is None:
        return [solve_static(system)] * len(loads)
    if len(initial) != len(loads):
        message = f"{len(loads)} loads and {len(initial)} initial solutions; give one for each load"
        raise ModelError(message)
    return [_checked_start(system, last_of(start), start.times is not None) for start in initial]


def _checked_start(system: System, start: Solution, moves: bool) -> Solution:
    """Return a static solution; refuse one from which a transient of this system cannot start."""
    if moves:
        refuse_model(
            f"a transient cannot start from the end of another ('{start.name}'), for it starts at "
            "rest; give a static solution or a path, or solve the longer transient"
        )
    system.contact.check_slip(start.shear_slip, start.name)
    return start if start.system is system else _carried_state(system, start)


def _carried_state(system: System, start: Solution) -> Solution:
    """Return a state of a joint with the same interfaces as a state of this joint."""
    inputs = carried_inputs(system, start)
    contact = relative_forces(system, start.contact_forces, start.shear_forces)
    states = system.factorize_static().solve(input_forces(system, inputs) + contact)
    return replace(start, system=system, inputs=inputs, states=states)


def begun(
    system: System,
    scheme: Integrator,
    step: float,
    loads: Sequence[Load],
    starts: Sequence[Solution],
) -> list[Restart]:
    """Return restarts at rest, with the accelerations due to the suddenly applied loads.

    Accelerations are averaged over the first step, M + h² K in place of M. This changes resolved
    motions by (ω h)². Unresolved ones, massless degrees of freedom among them, start with no more
    energy than the loads can supply.
    """
    now = np.zeros(1)
    inputs = np.concatenate([load.inputs(system, now) for load in loads])
    forces = np.array([start.contact_forces for start in starts])
    shear = np.array([start.shear_forces for start in starts])
    u = np.array([start.states for start in starts]).T
    applied = input_forces(system, inputs).T
    contact = relative_forces(system, forces, shear).T
    a = np.zeros_like(u)
    if scheme.needs_acceleration:
        a = factorize(system.M + step**2 * system.K).solve(applied + contact - system.K @ u)
    carried_force = scheme.kept_force(applied, contact)
    every = np.concatenate([forces, shear.reshape(len(forces), -1)], axis=1)
    motion = Motion(u, np.zeros_like(u), a, carried_force, np.zeros_like(u), every.T)
    whole, slips = (np.zeros((len(starts), n, forces.shape[1])) for n in (3, 2))
    whole[:, : system.contact.components] = every.reshape(len(starts), -1, forces.shape[1])
    slips[:, : system.contact.components - 1] = [start.shear_slip for start in starts]
    states = [
        ContactState(active=x[0] > 0, slip=slip, forces=x)
        for x, slip in zip(whole, slips, strict=True)
    ]
    return each_of(0, motion, states)
