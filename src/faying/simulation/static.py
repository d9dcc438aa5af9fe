"""Static contact solutions of full and reduced models through the condensed problem."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.increment import Increment
from faying.contact.similar_cases import side_by_side, solve_similar
from faying.joint.system import Joint, PortCompliance, System, input_forces
from faying.linalg.memory import require_room
from faying.linalg.threads import threads_for
from faying.simulation.load import Load
from faying.simulation.solution import Solution

AT_REST = Load(name="preload")
"""No boundary force: the joint under its locked bolts alone."""


TOGETHER = 128
"""Most cases solved side by side: of 10 000 of three bolts (3912 points) 67 take 6 ms each."""


def solve_static_cases(system: System, loads: Sequence[Load], name: str = "cases") -> Solution:
    """Solve many load cases; every array of the solution has the case as its first axis.

    Notes
    -----
    Free gaps and displacements of all cases are one matrix product each. Similar contact problems
    are solved together, or start from each other's solution.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> loads = [fy.Load({"tip.Fz": -force}) for force in (100.0, 200.0, 300.0)]
    >>> fy.solve_static_cases(joint, loads).pressure.shape
    (3, 112)
    """
    start = np.zeros(1)
    inputs = np.concatenate([load.inputs(system, start) for load in loads])
    return solve_static_inputs(system, inputs, name)


def solve_static_inputs(system: System, inputs: Matrix, name: str = "cases") -> Solution:
    """Solve many load cases given as inputs (n_case, n_input)."""
    require_states(system, len(inputs))
    return solved_inputs(system, system, inputs, name)


def require_states(system: System, count: int) -> None:
    """Refuse more states than fit into memory, before they are solved."""
    require_room(
        8.0 * count * (2 * system.K.shape[0] + 4 * system.contact.n_points),
        f"solutions of {count} load cases",
        "solve fewer at a time",
    )


def solved_inputs(system: System, touching: Joint, inputs: Matrix, name: str) -> Solution:
    """Solve many load cases given as inputs (n_case, n_input), with the contact of ``touching``.

    ``touching`` is the system, or the same joint without friction.
    """
    ports = touching.port_compliance
    free = port_forces(ports, inputs) @ ports.contact_columns
    with threads_for(touching.contact.n_points):
        contact = solved_cases(touching, free)
    return solution_of(system, inputs, contact, name)


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactStates:
    """Contact of some cases, instants or increments, which are the first axis of every array.

    Attributes
    ----------
    forces, gap : (n_case, n_point) [force], [length]
    shear_forces, slip : (n_case, n_tangent, n_point) [force], [length]
        Tangential components.
    iterations : (n_case,)
    dissipation : (n_case,) [force·length]
    deepest : (n_case, n_point) or None [length]
    """

    forces: Matrix
    gap: Matrix
    shear_forces: Matrix
    slip: Matrix
    iterations: Indices
    dissipation: Vector
    deepest: Matrix | None = None


def solution_of(system: System, inputs: Matrix, contact: ContactStates, name: str) -> Solution:
    """Return the solution for known contact, by one back-substitution for each case."""
    external = input_forces(system, inputs)
    external = external + relative_forces(system, contact.forces, contact.shear_forces)
    return Solution(
        name=name,
        system=system,
        states=system.factorize_static().solve(external.T).T,
        contact_forces=contact.forces,
        gap=contact.gap,
        inputs=inputs,
        iterations=contact.iterations,
        shear_forces=contact.shear_forces,
        shear_slip=contact.slip,
        dissipation=contact.dissipation,
        deepest=contact.deepest,
    )


def similar_loads(system: System, inputs: Matrix, size: int) -> list[Indices]:
    """Divide loads (n_case, n_input) into groups of at most ``size`` with similar displacements."""
    columns = system.port_compliance.contact_columns
    sizes, shapes = np.linalg.eigh(columns @ columns.T)
    scaled = shapes * np.sqrt(np.maximum(sizes, 0.0))
    return similar_groups(port_forces(system.port_compliance, inputs) @ scaled, size)


def solved_cases(system: Joint, free: Matrix) -> ContactStates:
    """Return contact of cases with displacements of the pairs (n_case, n_relative) without it.

    Similar cases are solved side by side where closure is proportional to pressure; otherwise each
    starts from the solution of another.
    """
    contact, solver = system.contact, system.static_contact.increments
    contact.check_cases()
    shape = (len(free), contact.n_points)
    forces, gaps = np.empty(shape), np.empty(shape)
    iterations = np.empty(len(free), dtype=np.int64)
    shapes, offset = contact.free_gap(free), contact.offset()
    start: Increment | None = None
    if side_by_side(solver, len(free)):
        for cases in similar_groups(shapes, TOGETHER):
            central = ((shapes[cases] - shapes[cases].mean(axis=0)) ** 2).sum(axis=1).argmin()
            first = solver.solve(free[cases[central]], offset).moved
            begin = np.broadcast_to(first, (len(cases), len(first)))
            solution = solve_similar(solver, free[cases], begin)
            forces[cases], gaps[cases], iterations[cases] = solution
    else:
        for (case,) in similar_groups(shapes, 1):
            start = solver.solve(free[case], offset, start)
            forces[case], gaps[case] = start.forces[0], start.gap(solver.laws)
            iterations[case] = start.iterations
    none = np.zeros((len(free), 0, contact.n_points))
    return ContactStates(
        forces=forces,
        gap=gaps,
        shear_forces=none,
        slip=none,
        iterations=iterations,
        dissipation=np.zeros(len(free)),
    )


def port_forces(ports: PortCompliance, inputs: Matrix) -> Matrix:
    """Return forces at the ports from inputs: an initial force N₀ shortens its bolt."""
    signed = np.array(inputs, dtype=float)
    signed[..., ports.bolts] *= -1.0
    return signed


def relative_forces(
    system: System, contact_forces: Matrix, shear_forces: Matrix | None = None
) -> Matrix:
    """Return forces Pᵀ Nᵀ λ (..., n_dof) from contact forces (..., n_point), Eq. (15.11).

    Tangential components are (..., n_tangent, n_point).
    """
    contact = system.contact
    return (contact.transposed[1] @ contact.at_pairs(contact_forces, shear_forces)).T


def similar_groups(vectors: Matrix, size: int) -> list[Indices]:
    """Divide vectors (n, k) into groups of at most ``size``, with similar groups in sequence.

    Groups are halved repeatedly, across the line between two distant members.
    """

    def divided(rows: Indices) -> list[Indices]:
        count = -(-len(rows) // size)
        if count <= 1:
            return [rows] if len(rows) else []
        inside = vectors[rows]
        end = inside[((inside - inside.mean(axis=0)) ** 2).sum(axis=1).argmax()]
        opposite = inside[((inside - end) ** 2).sum(axis=1).argmax()]
        order = rows[np.argsort(inside @ (opposite - end), kind="stable")]
        middle = len(rows) * (count // 2) // count
        return divided(order[:middle]) + divided(order[middle:])

    return divided(np.arange(len(vectors)))
