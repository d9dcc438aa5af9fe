"""Static contact solutions of full and reduced models through the condensed problem."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.contact.laws_at_points import LawsAtPoints
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
    free = port_forces(system.port_compliance, inputs) @ system.port_compliance.contact_columns
    with threads_for(contact.n_points):
        forces, gaps, iterations, errors = solved_cases(system, free)
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


def solved_cases(system: Joint, free: Matrix) -> tuple[Matrix, Matrix, Indices, Vector]:
    """Return forces, gaps, iterations and error bounds of cases whose pairs move without contact.

    Each case starts from the most similar one before it.
    """
    condensed, contact = system.static_contact, system.contact
    shape = (len(free), contact.n_points)
    forces, gaps = np.empty(shape), np.empty(shape)
    iterations, errors = np.empty(len(free), dtype=np.int64), np.zeros(len(free))
    moved_apart = condensed.free_gap(free)
    if (solver := condensed.cases) is not None:
        laws, offset = LawsAtPoints(contact=contact), contact.offset()
        like = SimilarProblems[Increment](contact.n_points)
        for case, gap in enumerate(moved_apart):
            found = solver.solve(free[case], offset, like.nearest(gap))
            like.remember(gap, found)
            forces[case], gaps[case] = found.forces[0], found.gap(laws)
            iterations[case] = found.iterations
        return forces, gaps, iterations, errors
    similar = SimilarProblems[Mask](contact.n_points)
    state: ContactState | None = None
    for case, gap in enumerate(moved_apart):
        nearest = similar.nearest(gap)
        if state is not None and nearest is not None:
            state = replace(state, active=nearest)
        solution, state = condensed.solve(gap, state)
        similar.remember(gap, solution.active)
        forces[case], gaps[case] = solution.forces, condensed.gap(solution)
        iterations[case], errors[case] = solution.iterations, solution.error
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
