"""Static contact solutions of full and reduced models through the condensed problem."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.contact.state import ContactState
from faying.joint.system import Joint, PortCompliance, System, input_forces
from faying.linalg.memory import require_room
from faying.linalg.threads import threads_for
from faying.simulation.load import Load
from faying.simulation.similar import SimilarProblems
from faying.simulation.solution import Solution

AT_REST = Load(name="preload")
"""No boundary force: the joint under its locked bolts alone."""


def solve_static_cases(system: System, loads: Sequence[Load], name: str = "cases") -> Solution:
    """Solve many load cases; every array of the solution has the case as its first axis.

    Notes
    -----
    Free gaps and displacements of all cases are one matrix product each; the contact problems
    follow one another, each started from the most similar one among those before it.
    """
    start = np.zeros(1)
    inputs = np.concatenate([load.inputs(system, start) for load in loads])
    return solve_static_inputs(system, inputs, name)


def solve_static_inputs(system: System, inputs: Matrix, name: str = "cases") -> Solution:
    """Solve many load cases given as inputs (n_case, n_input)."""
    contact = system.contact
    contact.check_frictionless()
    require_room(
        8.0 * len(inputs) * (2 * system.K.shape[0] + 4 * contact.n_points),
        f"solutions of {len(inputs)} load cases",
        "solve fewer at a time",
    )
    return solved_inputs(system, system, inputs, name)


def solved_inputs(system: System, touching: Joint, inputs: Matrix, name: str) -> Solution:
    """Solve many load cases given as inputs (n_case, n_input).

    Parameters
    ----------
    touching
        Whose contact it is: the system, or the same joint without friction.
    """
    ports = touching.port_compliance
    free = port_forces(ports, inputs) @ ports.contact_columns
    with threads_for(touching.contact.n_points):
        forces, gaps, iterations, errors = solved_cases(touching, free)
    external = input_forces(system, inputs) + relative_forces(system, forces)
    return Solution(
        name=name,
        system=system,
        states=system.factorize_static().solve(external.T).T,
        contact_forces=forces,
        gap=gaps,
        inputs=inputs,
        iterations=iterations,
        contact_error=errors,
    )


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedCase:
    """Contact of one case.

    Attributes
    ----------
    forces, gap : (n_point,)
    iterations
        Linear systems solved.
    error
        Bound on the relative error of the forces.
    state
        What a similar case starts from.
    """

    forces: Vector
    gap: Vector
    iterations: int
    error: float
    state: Increment | ContactState


def solved_case(
    system: Joint, free: Vector, start: Increment | ContactState | None = None
) -> SolvedCase:
    """Solve the case whose pairs move (n_relative,) without contact."""
    condensed = system.static_contact
    if (solver := condensed.cases) is not None:
        begun = start if isinstance(start, Increment) else None
        increment = solver.solve(free, system.contact.offset(), begun)
        return SolvedCase(
            forces=increment.forces[0],
            gap=increment.gap(solver.laws),
            iterations=increment.iterations,
            error=0.0,
            state=increment,
        )
    begun_state = start if isinstance(start, ContactState) else None
    solution, state = condensed.solve(condensed.free_gap(free), begun_state)
    return SolvedCase(
        forces=solution.forces,
        gap=condensed.gap(solution),
        iterations=solution.iterations,
        error=solution.error,
        state=state,
    )


def solved_cases(system: Joint, free: Matrix) -> tuple[Matrix, Matrix, Indices, Vector]:
    """Return forces, gaps, iterations and error bounds of cases whose pairs move without contact.

    Each case starts from the most similar one before it.
    """
    system.contact.check_forgetful("cases that do not follow each other", "solve_path")
    shape = (len(free), system.contact.n_points)
    forces, gaps = np.empty(shape), np.empty(shape)
    iterations, errors = np.empty(len(free), dtype=np.int64), np.zeros(len(free))
    solved_before = SimilarProblems[Increment | Mask](system.contact.n_points)
    state: Increment | ContactState | None = None
    for case, gap in enumerate(system.static_contact.free_gap(free)):
        nearest = solved_before.nearest(gap)
        if isinstance(nearest, Increment):
            state = nearest
        elif nearest is not None and isinstance(state, ContactState):
            state = replace(state, active=nearest)
        case_solution = solved_case(system, free[case], state)
        state = case_solution.state
        solved_before.remember(gap, state.active if isinstance(state, ContactState) else state)
        forces[case], gaps[case] = case_solution.forces, case_solution.gap
        iterations[case], errors[case] = case_solution.iterations, case_solution.error
    return forces, gaps, iterations, errors


def port_forces(ports: PortCompliance, inputs: Matrix) -> Matrix:
    """Return forces at the ports of inputs: an initial force N₀ shortens its bolt."""
    signed = np.array(inputs, dtype=float)
    signed[..., ports.bolts] *= -1.0
    return signed


def relative_forces(
    system: System, contact_forces: Matrix, shear_forces: Matrix | None = None
) -> Matrix:
    """Return forces Pᵀ Nᵀ λ (..., n_dof) of contact forces (..., n_point), Eq. (15.11).

    Parameters
    ----------
    shear_forces : (..., 2, n_point)
        Tangential components of a joint with friction.
    """
    contact = system.contact
    forces: Matrix = (contact.transposed[1] @ contact.at_pairs(contact_forces, shear_forces)).T
    return forces
