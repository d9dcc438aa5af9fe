"""Quasi-static paths: increments of load, with friction that remembers its slip."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.frictional import FrictionalContact, Increment
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System, input_forces
from faying.linalg.threads import threads_for
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import port_forces, relative_forces, solve_static_inputs

MOST_DIVISIONS = 6
"""Times an increment is halved before its path is given up."""


def solve_path(
    system: System, loads: Sequence[Load], initial: Solution | None = None, name: str = "path"
) -> Solution:
    """Solve a sequence of loads, each from where the one before left the joint.

    Parameters
    ----------
    system
        Full or reduced model; interfaces with and without friction.
    loads
        States of load, one after the other, not their differences; histories are taken at time
        zero. The bolts act with the initial forces they are locked at, unless a load says else.
    initial
        Solution of an earlier path to go on from, its last state; by default the joint is
        unstressed and nothing has slipped, so that the first increment tightens the bolts.

    Returns
    -------
    Solution
        One entry per load, with ``traction``, ``slip`` and ``dissipation`` (zero without friction).

    Raises
    ------
    ModelError
        If a load does not fit the system, ``initial`` is of another joint, or the structure is not
        held.
    ConvergenceError
        If an increment is not solved even when it is divided; the message names it.

    Notes
    -----
    Increments are implicit (backward Euler in the slip). An increment that does not converge is
    halved, up to 64 parts. Path and increments are part of the answer: one large increment and
    several small ones give different slips, and energy by slip and by the loop of load and
    displacement agree as increments shrink. Each costs some Newton steps between pairs, of 2 n³/3
    for n relative displacements in contact, and a back-substitution. Without friction nothing is
    remembered, and the loads are cases of :func:`~faying.simulation.static.solve_static_cases`.
    """
    times, start = np.zeros(1), _start(system, initial)
    inputs = np.concatenate([load.inputs(system, times) for load in loads])
    if system.contact.forgets:
        solved = solve_static_inputs(system, inputs, name)
        return replace(solved, dissipation=np.zeros(len(inputs)))
    solver = system.static_contact.frictional
    steps = list(_walk(system, solver, inputs, start))
    normal = np.array([step.increment.forces[0] for step in steps])
    shear = np.array([step.increment.forces[1:] for step in steps])
    gap = np.array([solver.gap(step.increment) for step in steps])
    external = input_forces(system, inputs) + relative_forces(system, normal, shear)
    return Solution(
        name=name,
        system=system,
        states=system.factorize_static().solve(external.T).T,
        contact_forces=normal,
        gap=gap,
        inputs=inputs,
        iterations=np.array([step.iterations for step in steps]),
        shear_forces=shear,
        shear_slip=np.array([step.slip for step in steps]),
        dissipation=np.array([step.dissipation for step in steps]),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Step:
    """Where the path stands after a load.

    Attributes
    ----------
    inputs : (n_input,)
    increment
        The last increment of the load.
    slip : (2, n_point)
    iterations, dissipation
        Of all increments of the load.
    """

    inputs: Vector
    increment: Increment
    slip: Matrix
    iterations: int = 0
    dissipation: float = 0.0


def _start(system: System, initial: Solution | None) -> _Step:
    n = system.contact.n_points
    forces, slip = np.zeros((3, n)), np.zeros((2, n))
    if initial is None:
        n_input = len(system.port_compliance.input_rows)
        nothing = Increment(forces=forces, slack=np.zeros((3, n)), iterations=0, residual=0.0)
        return _Step(inputs=np.zeros(n_input), increment=nothing, slip=slip)
    normal = np.atleast_2d(initial.contact_forces)[-1]
    if len(normal) != n:
        message = (
            f"the path should go on from a solution with {len(normal)} contact points, but the "
            f"joint has {n}; give a solution of this joint"
        )
        raise ModelError(message)
    if initial.shear_forces is not None and initial.shear_slip is not None:
        shape = (-1, 2, n)
        forces[1:] = initial.shear_forces.reshape(shape)[-1]
        slip = initial.shear_slip.reshape(shape)[-1]
    forces[0] = normal
    last = Increment(forces=forces, slack=np.zeros((3, n)), iterations=0, residual=0.0)
    return _Step(inputs=np.atleast_2d(initial.inputs)[-1], increment=last, slip=slip)


def _walk(
    system: System, solver: FrictionalContact, inputs: Matrix, here: _Step
) -> Iterator[_Step]:
    """Yield where the path stands after each load."""
    with threads_for(len(solver.S)):
        for number, target in enumerate(inputs):
            try:
                here = _to(system, solver, here, target, MOST_DIVISIONS)
            except ConvergenceError as error:
                message = f"load {number + 1} of {len(inputs)} on the path: {error}"
                raise ConvergenceError(message) from None
            yield here


def _to(
    system: System, solver: FrictionalContact, here: _Step, target: Vector, divisions: int
) -> _Step:
    """Go to a load in one increment, or by halves of it where that is too far."""
    ports, contact = system.port_compliance, system.contact
    relative = port_forces(ports, target) @ ports.contact_columns
    z_free = np.zeros((3, contact.n_points))
    z_free[0] = contact.interpolation @ relative + contact.initial_gap
    if contact.shear is not None:
        z_free[1:, contact.rubbing] = (contact.shear @ relative).reshape(2, -1)
    z_free[1:] -= here.slip
    pressed = here.increment.forces[0].any()
    try:
        found = solver.solve(z_free, here.increment.forces if pressed else None)
    except ConvergenceError:
        if divisions == 0:
            raise
        middle = _to(system, solver, here, (here.inputs + target) / 2, divisions - 1)
        end = _to(system, solver, middle, target, divisions - 1)
        return _Step(
            inputs=target,
            increment=end.increment,
            slip=end.slip,
            iterations=middle.iterations + end.iterations,
            dissipation=middle.dissipation + end.dissipation,
        )
    return _Step(
        inputs=target,
        increment=found,
        slip=here.slip + found.slack[1:],
        iterations=found.iterations,
        dissipation=found.dissipation,
    )
