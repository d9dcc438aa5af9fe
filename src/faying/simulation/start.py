"""Where transients start: the joint at rest under its bolts, or static states that are given."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Matrix
from faying.contact.state import ContactState
from faying.exceptions import ModelError
from faying.joint.system import System, input_forces
from faying.linalg.factorization import factorize
from faying.simulation.integrators import Integrator, Motion
from faying.simulation.load import Load
from faying.simulation.path import last_of, solve_path
from faying.simulation.restart import Restart, each_of
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import carried_inputs
from faying.simulation.static import AT_REST, relative_forces
from faying.simulation.static_case import solve_static


def at_rest(system: System) -> Solution:
    """Solve the joint under its bolts alone; with friction they are tightened in one increment."""
    if system.contact.forgets:
        return solve_static(system)
    return last_of(solve_path(system, [AT_REST], name=AT_REST.name))


def starting_states(
    system: System, loads: Sequence[Load], initial: Sequence[Solution] | None
) -> list[Solution]:
    """Return one static state for each load."""
    if initial is None:
        return [at_rest(system)] * len(loads)
    if len(initial) != len(loads):
        message = f"{len(loads)} loads and {len(initial)} initial solutions; give one for each load"
        raise ModelError(message)
    return [_checked(system, last_of(start), start.times is not None) for start in initial]


def _checked(system: System, start: Solution, moves: bool) -> Solution:
    """Refuse what a transient of this system cannot start from."""
    if moves:
        message = (
            f"a transient cannot start from the end of another ('{start.name}'), for it starts at "
            "rest; give a static solution or a path, or solve the longer transient"
        )
        raise ModelError(message)
    rubs, slipped = system.contact.components > 1, start.shear_slip is not None
    if rubs and not slipped:
        message = (
            f"the joint has friction, and the initial solution '{start.name}' does not say what "
            "has slipped; give one of solve_path, solve_path(model, [fy.Load()], initial=...) to "
            "close a joint that was tightened without friction"
        )
        raise ModelError(message)
    if slipped and not rubs and start.system.contact.components > 1:
        message = (
            f"the initial solution '{start.name}' has friction and the joint none; start from "
            "solve_static, or solve the transient with friction"
        )
        raise ModelError(message)
    return start if start.system is system else _carried(system, start)


def _carried(system: System, start: Solution) -> Solution:
    """Return a state of another joint with the same interfaces as one of this joint."""
    inputs = carried_inputs(system, start)
    contact = relative_forces(system, start.contact_forces, start.shear_forces)
    states = system.factorize_static().solve(input_forces(system, inputs) + contact)
    return replace(start, system=system, inputs=inputs, states=states)


def stacked_forces(normal: Matrix, shear: Matrix | None) -> Matrix:
    """Return all components of contact forces (n_case, components * n_point)."""
    if shear is None:
        return normal
    return np.concatenate([normal[:, None], shear], axis=1).reshape(len(normal), -1)


def begun(
    system: System,
    scheme: Integrator,
    step: float,
    loads: Sequence[Load],
    starts: Sequence[Solution],
) -> list[Restart]:
    """Return the states at rest, with the accelerations the suddenly applied loads cause.

    These are averaged over the first step, M + h² K in place of M: what the step resolves sees an
    error of (ω h)², and what it does not, massless degrees of freedom among it, does not begin
    with more energy than the loads can give.
    """
    now = np.zeros(1)
    inputs = np.concatenate([load.inputs(system, now) for load in loads])
    forces = np.array([start.contact_forces for start in starts])
    rubs = system.contact.components > 1
    shear = np.array([start.shear_forces for start in starts], dtype=float) if rubs else None
    u = np.array([start.states for start in starts]).T
    applied = input_forces(system, inputs).T
    contact = relative_forces(system, forces, shear).T
    a = np.zeros_like(u)
    if scheme.needs_acceleration:
        a = factorize(system.M + step**2 * system.K).solve(applied + contact - system.K @ u)
    carried_force = scheme.kept_force(applied, contact)
    every = stacked_forces(forces, shear)
    motion = Motion(u, np.zeros_like(u), a, carried_force, np.zeros_like(u), every.T)
    whole = np.zeros((len(starts), 3, forces.shape[1]))
    whole[:, : system.contact.components] = every.reshape(len(starts), -1, forces.shape[1])
    states = [
        ContactState(active=x[0] > 0, slip=start.shear_slip, forces=x)
        for x, start in zip(whole, starts, strict=True)
    ]
    return each_of(0, motion, states)
