"""Quasi-static load paths: increments of load, with friction that depends on the slip so far."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.increment import Increment, displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.exceptions import refuse_model
from faying.joint.system import Joint, System
from faying.linalg.memory import require_room
from faying.linalg.threads import threads_for
from faying.simulation.load import Load, StaticLoad
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import OF_EACH_STATE, carried_inputs
from faying.simulation.static import (
    AT_REST,
    ContactStates,
    port_forces,
    require_states,
    solution_of,
    solved_cases,
)


def solve_path(
    system: System,
    loads: Sequence[StaticLoad],
    initial: Solution | None = None,
    name: str = "path",
) -> Solution:
    """Solve a sequence of loads, each starting from the state after the one before.

    Parameters
    ----------
    system
        Full or reduced model; interfaces with and without friction.
    loads
        Total loads in sequence, not their differences; histories are taken at time zero. The bolts
        act with the initial forces they are locked at, unless a load changes them.
    initial
        Solution whose last state the path continues, of this joint or one with the same interfaces
        and the loads it carries; by default the joint is unstressed and free of slip, so that the
        first increment tightens the bolts.

    Returns
    -------
    Solution
        One entry per load, with ``traction``, ``slip`` and ``dissipation`` (zero without friction).

    Raises
    ------
    ModelError
        If there is no load, or one does not fit the system, ``initial`` is of another joint, the
        structure is not held.
    ConvergenceError
        If an increment is not solved even when it is divided; the message names it.

    Notes
    -----
    Increments are implicit (backward Euler in the slip). An increment that does not converge is
    halved, up to 64 parts, unless it starts at rest without gaps, where the half is the same
    problem. Slip depends on path and increments: one large increment and several small ones give
    different slips. The energy dissipated by slip tends to that of the loop of load and
    displacement as increments shrink. Each increment costs some Newton steps between pairs, of 2
    n³/3 for n relative displacements in contact, and a back-substitution. Without friction there is
    no history, and the loads are cases of :func:`~faying.simulation.static.solve_static_cases`.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> path = fy.solve_path(joint, [fy.Load({"tip.Fz": -200.0}), fy.Load()])
    >>> bool(path.dissipation[-1] > 0.0)
    True
    """
    inputs = path_inputs(system, loads)
    begun = partial(path_start, system, initial)
    contact = contact_along(system, moved_alone(system, inputs), begun)
    return solution_of(system, inputs, contact, name)


def contact_along(system: Joint, relative: Matrix, begun: Callable[[], PathStep]) -> ContactStates:
    """Return contact states for displacements of the pairs under loads alone.

    Displacements are (n_load, n_relative) [length]. Each load starts from the state after the one
    before; without history they are independent cases.

    Parameters
    ----------
    begun
        Function that returns the state before the first load, called if there is history.
    """
    contact = system.contact
    require_room(
        8.0 * len(relative) * 2 * contact.components * contact.n_points,
        f"contact of {len(relative)} loads",
        "solve fewer at a time",
    )
    if contact.forgets:
        with threads_for(contact.n_points):
            return solved_cases(system, relative)
    return states_of(contact, list(follow(system.static_contact.increments, relative, begun())))


def contact_at_ends(
    system: Joint, ways: Iterable[Matrix], begun: Callable[[], PathStep]
) -> ContactStates:
    """Return contact states at the ends of several paths.

    Each path is given and solved as in :func:`contact_along`. Without history the ends are
    independent cases and are solved together.
    """
    if system.contact.forgets:
        ends = np.array([way[-1] for way in ways])
        return contact_along(system, ends.reshape(-1, system.port_compliance.n_relative), begun)
    start, solver = begun(), system.static_contact.increments
    steps: list[PathStep] = []
    for way in ways:
        steps += deque(follow(solver, way, start), maxlen=1)
    return states_of(system.contact, steps)


def path_inputs(system: System, loads: Sequence[StaticLoad]) -> Matrix:
    """Return the inputs of a sequence of loads (n_load, n_input)."""
    if not loads:
        refuse_model("the path has no loads; give at least one, fy.Load() for the bolts alone")
    start = np.zeros(1)
    return np.concatenate([load.inputs(system, start) for load in loads])


def moved_alone(system: Joint, inputs: Matrix) -> Matrix:
    """Return displacements of the pairs (n_load, n_relative) [length] under inputs alone."""
    ports = system.port_compliance
    # Row by row, so that the digits of a load do not depend on the other loads.
    rows = [row @ ports.contact_columns for row in np.atleast_2d(port_forces(ports, inputs))]
    return np.array(rows).reshape(*np.shape(inputs)[:-1], ports.n_relative)


def assembled(system: System, inputs: Matrix, steps: Sequence[PathStep], name: str) -> Solution:
    """Return the solution of a path from its steps, by one back-substitution for each load."""
    return solution_of(system, inputs, states_of(system.contact, steps), name)


def left_by(system: System, joint: Joint, inputs: Vector, step: PathStep, name: str) -> Solution:
    """Return the state of a system under inputs (n_input,) after a step of its joint.

    If the joint is without the friction of the system, the tangential displacements count as slip,
    and friction starts there. The solution has one entry.
    """
    slip, rubbing = system.contact.moved(step.increment.moved)[1:], joint.contact.rubbing
    slip[:, rubbing] = step.slip[:, rubbing]
    return assembled(system, inputs[None], [replace(step, slip=slip)], name)


def states_of(contact: Contact, steps: Sequence[PathStep]) -> ContactStates:
    """Return contact states after the steps of a path."""
    laws, n_tangent, n = LawsAtPoints(contact=contact), contact.components - 1, contact.n_points
    forces = np.array([step.increment.forces for step in steps]).reshape(-1, 3, n)
    return ContactStates(
        forces=forces[:, 0],
        gap=np.array([step.increment.gap(laws) for step in steps]).reshape(-1, n),
        shear_forces=forces[:, 1 : 1 + n_tangent],
        slip=np.array([step.slip[:n_tangent] for step in steps]).reshape(len(steps), n_tangent, n),
        iterations=np.array([step.iterations for step in steps]),
        dissipation=np.array([step.dissipation for step in steps]),
        deepest=np.array([s.increment.deepest for s in steps]) if contact.remembers else None,
    )


def last_of(solution: Solution) -> Solution:
    """Return the last state of a path, or a static solution itself."""
    return state_of(solution, -1)


def state_of(solution: Solution, number: int) -> Solution:
    """Return one state of a path, or a static solution itself."""
    if solution.states.ndim == 1:
        return solution
    values = {name: getattr(solution, name) for name in OF_EACH_STATE}
    state = {name: value[number] for name, value in values.items() if np.ndim(value)}
    return replace(solution, **state)


def path_start(system: System, initial: Solution | None) -> PathStep:
    """Return the first step of a path: unstressed, or the last state of an earlier path.

    Raises
    ------
    ModelError
        If that has other contact points, or loads that the joint does not have.
    """
    if initial is None:
        return unstressed(system)
    relative = moved_alone(system, carried_inputs(system, initial))
    begins = initial.states.ndim == 1 or len(initial.states) == 1
    previous = None if begins else path_start(system, state_of(initial, -2))
    return replace(path_at(system, relative, last_of(initial)), previous=previous)


def unstressed(joint: Joint) -> PathStep:
    """Return the first step of a path without stress and slip."""
    return path_at(joint, np.zeros(joint.port_compliance.n_relative), None)


def path_at(joint: Joint, relative: Vector, state: Solution | None) -> PathStep:
    """Return the step of a path at one state; None is the state without stress and slip.

    ``relative`` (n_relative,) [length] are displacements of the pairs under its load alone.
    """
    n, deepest = joint.contact.n_points, None
    forces, slip = np.zeros((3, n)), np.zeros((2, n))
    if state is not None:
        forces[: 1 + len(state.shear_forces)] = [state.contact_forces, *state.shear_forces]
        slip[: len(state.shear_slip)], deepest = state.shear_slip, state.deepest
    increment = Increment(
        forces=forces,
        slack=np.zeros((3, n)),
        moved=displaced(joint.static_contact.increments, relative, forces),
        iterations=0,
        residual=0.0,
        deepest=deepest,
    )
    return PathStep(relative=relative, increment=increment, slip=slip)


def solve_static(system: System, load: Load = AT_REST, initial: Solution | None = None) -> Solution:
    """Solve the static contact problem of one load case.

    Parameters
    ----------
    system
        Full or reduced model; histories are taken at time zero.
    initial
        With friction or gaskets, the state to continue from in one increment; by default the joint
        is unstressed and free of slip. In all other cases it has no effect.

    Raises
    ------
    ModelError
        If the load does not fit the system, or the structure is not held.

    Notes
    -----
    One dense contact problem and one back-substitution; the first call forms the compliance of
    the system, and later calls use it again.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> pushed = fy.solve_static(joint, fy.Load({"tip.Fz": -500.0}))
    >>> bool(pushed.max_pressure > fy.solve_static(joint).max_pressure)
    True
    """
    return last_of(solve_path(system, [load], initial, name=load.name))


def solve_ramps(
    system: System, inputs: Matrix, rest: Solution, *, increments: int, name: str = "ramps"
) -> Solution:
    """Solve many loads, each in equal increments from the last state of a path; return the ends.

    Inputs (n_case, n_input) [force] are boundary forces and initial bolt forces. The solution has
    one entry per load, with ``traction`` and ``slip``; iterations and dissipation are those of the
    last increment.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.

    Notes
    -----
    As many increments as :func:`faying.solve_path` with the same loads.
    """
    begun = np.atleast_2d(rest.inputs)[-1]
    shares = np.arange(1, increments + 1)[:, None] / increments
    ways = [(1 - shares) * begun + shares * row for row in inputs]
    return solve_ends(system, ways, rest, name)


def solve_ends(
    system: System,
    ways: Sequence[Matrix],
    initial: Solution | None,
    name: str,
    walked: Callable[[Sequence[Matrix]], Iterable[Matrix]] = iter,
) -> Solution:
    """Solve many paths of inputs (n_load, n_input) from one state; return the end of each.

    One back-substitution for each. Paths with history are taken from ``walked`` as they are solved.
    """
    require_states(system, len(ways))
    n_input = len(system.port_compliance.input_rows)
    inputs = np.array([way[-1] for way in ways]).reshape(-1, n_input)
    relative = (moved_alone(system, way) for way in walked(ways))
    contact = contact_at_ends(system, relative, partial(path_start, system, initial))
    return solution_of(system, inputs, contact, name)
