"""Pressure recovery: accurate contact pressures from any reduced trajectory, (R5).

Pressures of a reduced trajectory are inaccurate because few trial vectors have to represent the
contact. Its inertia and damping forces are accurate, as they are spread over the whole structure.
Recovery takes only these and solves, at each instant, the static contact problem of the full
model:

    g_free = g₀ + G K⁻¹ (f − M Φ q̈ − C Φ q̇),   s = (S + D) λ + g_free ≥ 0,  λ ≥ 0,  λᵀ s = 0.

It is the mode-acceleration method of structural dynamics with contact. ``docs/theory/recovery.md``
derives it and states its limits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from faying._typing import Indices, Matrix, Vector, frozen
from faying.exceptions import refuse_model
from faying.joint.model import Model
from faying.joint.system import (
    Joint,
    System,
    bolt_input,
    boundary_slices,
    input_forces,
    unstretched_bolt_forces,
)
from faying.reduction.recovery import (
    Recovery,
    at_ports,
    static_displacements,
    supported_operator,
)
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.contact_fields import ContactFields, no_tangent, shear_everywhere
from faying.simulation.load import Load
from faying.simulation.path import contact_along, path_at, state_of
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import some_states
from faying.simulation.static import ContactStates, relative_forces


@dataclass(frozen=True, eq=False, kw_only=True)
class Recovered(ContactFields):
    """Pressures of the full model recovered from a reduced history or static solution.

    Read like a :class:`~faying.simulation.solution.Solution`; arrays have no leading axis for one
    static solution, otherwise one entry per case or instant. :func:`faying.compare` accepts it.

    Attributes
    ----------
    name
        Name of the load.
    system
        The full model, or its part at the ports.
    contact_forces : (..., n_point) [force]
        λ = w ∘ p.
    gap : (..., n_point) [length]
    port_displacements : (..., n_port) [length]
        Relative displacements of the pairs, boundary displacements, bolt elongations, and
        displacements on which load patterns do work.
    inputs : (..., n_input) [force]
    iterations : (...)
        Linear systems solved in each contact problem.
    times : (n_time,) or None
    shear_forces : (..., n_tangent, n_point) [force]
        Tangential components of the contact forces: two where some interface has friction, or none.
    shear_slip : (..., n_tangent, n_point) [length]
        Tangential components of the slip.
    deepest : (..., n_point) or None [length]
        Largest closures so far, of a joint with gaskets.
    """

    name: str
    system: Joint
    contact_forces: Matrix
    gap: Matrix
    port_displacements: Matrix
    inputs: Matrix
    iterations: Indices
    times: Vector | None = None
    shear_forces: Matrix = field(default_factory=no_tangent)
    shear_slip: Matrix = field(default_factory=no_tangent)
    deepest: Matrix | None = None

    def __post_init__(self) -> None:
        for name in ("contact_forces", "gap", "port_displacements", "inputs"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        shear_everywhere(self)

    def displacement(self, boundary: str) -> Matrix:
        """Return the recovered displacements at a boundary (..., n) in its components' order."""
        columns = boundary_slices(self.system.boundaries)[boundary]
        return self._outer_ports[..., columns]

    def bolt_force(self, bolt: str) -> Matrix:
        """Return the axial force of a bolt (...) [force], tension positive."""
        column = bolt_input(self.system, bolt)
        elongation = self._outer_ports[..., column]
        unstretched = unstretched_bolt_forces(self.system, self.inputs)
        number = list(self.system.bolts).index(bolt)
        stiffness = self.system.bolts[bolt].stiffness
        return np.asarray(stiffness * elongation + unstretched[..., number])

    @property
    def _outer_ports(self) -> Matrix:
        return self.port_displacements[..., self.system.port_compliance.n_relative :]


def recover_pressure(
    model: Model | ReducedModel,
    solution: Solution,
    *,
    instants: Indices | None = None,
    operator: Recovery | None = None,
) -> Recovered:
    """Recover the pressures of the full model from a static or transient solution.

    Parameters
    ----------
    model
        The full model, whose contact law is used instead of that of the solution; or the reduced
        model that was solved, which has the necessary data of the full one.
    solution
        Solution of a reduced model with any basis, or of the full model (which is returned).
    instants
        Indices of instants or cases; by default all.
    operator
        Result of :func:`recovery_operator` if it has been computed.

    Returns
    -------
    Recovered

    Raises
    ------
    ModelError
        If the solution does not belong to the model.

    Notes
    -----
    Accelerations are those that balance the reduced equations at each instant under the contact
    forces of the solution, q̈ = M_r⁻¹ (f_r + (GΦ)ᵀ λ − C_r q̇ − K_r q). For implicit Euler they are
    the stored ones. Generalized-α enforces balance between instants and stores accelerations that
    are only first-order accurate at them; the balanced ones are consistent at every instant. The
    first instant is the state before the load, at rest: static balance.

    Cost: one small matrix product for all instants and one warm contact problem each.

    With friction the contact problems are increments of a path, from instant to instant: pressures
    and tractions at one depend on all before it, so that these are solved too. The first takes its
    slip from the solution. Errors of the trajectory before an instant stay in the slip there;
    recovery corrects forces, not their history.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4))
    >>> push = fy.Load({"tip.Fz": -100.0})
    >>> recovered = fy.recover_pressure(joint, fy.solve_static(rom, push))
    >>> fy.compare(recovered, fy.solve_static(joint, push)).max_relative_error < 1e-8
    True
    """
    joint = model.joint if isinstance(model, ReducedModel) else model
    chosen, taken = solution, None
    if instants is not None and solution.contact_forces.ndim > 1:
        wanted = np.asarray(instants, dtype=np.int64) % len(solution.contact_forces)
        way = joint.contact.way_to(wanted)
        chosen, taken = some_states(solution, way), np.searchsorted(way, wanted)
    if isinstance(chosen.system, ReducedModel):
        free = _free_from_reduced(model, joint, chosen.system, chosen, operator)
    elif isinstance(model, ReducedModel):
        refuse_model("a solution of the full model is recovered with the full model; give that")
    else:
        free = _free_from_full(model, chosen)
    path = solve_instants(joint, chosen.name, chosen.inputs, free, chosen.times, begin=solution)
    return path if taken is None else _select_instants(path, taken)


def solve_cases_at_ports(joint: Joint, loads: Sequence[Load]) -> Recovered:
    """Return static solutions of a full model from its ports, exact up to round-off."""
    inputs = np.concatenate([load.inputs(joint, np.zeros(1)) for load in loads])
    free = static_displacements(joint.port_compliance, inputs)
    return solve_instants(joint, "cases", inputs, free, None)


def _free_from_reduced(
    model: Model | ReducedModel,
    joint: Joint,
    rom: ReducedModel,
    solution: Solution,
    operator: Recovery | None,
) -> Matrix:
    """Return port displacements without contact, from a solution of a reduced model."""
    if solution.velocities is None:
        return static_displacements(joint.port_compliance, solution.inputs)
    matrices = _matrices(model, rom) if operator is None else operator
    n_port = joint.port_compliance.n_port
    if matrices.inertia.shape != (n_port, len(rom.K)):
        refuse_model(
            f"the recovery matrices have shape {matrices.inertia.shape}, but the model has "
            f"{n_port} ports and the solution {len(rom.K)}"
            " coordinates; recover with the model that was "
            "solved, or the one it was reduced from"
        )
    accelerations = balanced_accelerations(rom, solution)
    moving = accelerations @ matrices.inertia.T + solution.velocities @ matrices.damping.T
    return static_displacements(joint.port_compliance, solution.inputs) - moving


def _matrices(model: Model | ReducedModel, rom: ReducedModel) -> Recovery:
    """Return the recovery matrices of a reduced model, or new ones if the structure changed."""
    if isinstance(model, ReducedModel):
        return model.recovery
    ports = rom.ports
    alike = ports is not None and ports.input_rows is model.port_compliance.input_rows
    if alike or not len(rom.basis.vectors):
        return rom.recovery
    return supported_operator(model, rom.basis)


def _free_from_full(model: Model, solution: Solution) -> Matrix:
    """Return Q (u − K⁻¹ Gᵀ λ): by balance, port displacements of the full model without contact."""
    if solution.states.shape[-1] != model.structure.n_dof:
        refuse_model(
            f"the solution has {solution.states.shape[-1]} degrees of freedom but the model "
            f"{model.structure.n_dof}; recover with the model that was solved"
        )
    displacements = at_ports(model, solution.states.T).T
    return displacements - _contact_displacements(
        model, solution.contact_forces, solution.shear_forces
    )


def balanced_accelerations(system: System, solution: Solution) -> Matrix:
    """Return q̈ (n_time, n_mode) that balances a reduced model at the instants themselves.

    Massless coordinates, which feel no inertia force, get the least-norm value.
    """
    rates = solution.velocities
    velocities = np.zeros_like(solution.states) if rates is None else rates
    contact = relative_forces(system, solution.contact_forces, solution.shear_forces)
    force = input_forces(system, solution.inputs) + contact
    elastic, damping, mass = (np.asarray(matrix) for matrix in (system.K, system.C, system.M))
    unbalanced = force - solution.states @ elastic - velocities @ damping
    # Scaled, because masses of coordinates differ by many orders of magnitude.
    diagonal = np.diag(mass)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = np.linalg.lstsq(mass * scale[:, None] * scale, (unbalanced * scale).T, rcond=None)[0]
    return np.asarray(scaled.T * scale, dtype=np.float64)


def solve_instants(
    model: Joint,
    name: str,
    inputs: Matrix,
    free: Matrix,
    times: Vector | None,
    begin: Solution | None = None,
) -> Recovered:
    """Solve the static contact problem of every row, each starting from a similar one before it.

    With friction the first state of ``begin`` has the slip before the first row, by default none.
    """
    rows = np.atleast_2d(free)[:, : model.port_compliance.n_relative]
    index = 0 if free.ndim == 1 else slice(None)
    path = solve_increments(model, rows, begin)
    forces, shear = path.forces[index], path.shear_forces[index]
    return Recovered(
        name=name,
        system=model,
        contact_forces=forces,
        gap=path.gap[index],
        port_displacements=free + _contact_displacements(model, forces, shear),
        inputs=inputs,
        iterations=path.iterations[index],
        times=times,
        shear_forces=shear,
        shear_slip=path.slip[index],
        deepest=None if path.deepest is None else path.deepest[index],
    )


def _select_instants(recovered: Recovered, chosen: Indices) -> Recovered:
    """Return some instants."""
    members: dict[str, Any] = {
        name: value[chosen]
        for name, value in vars(recovered).items()
        if isinstance(value, np.ndarray)
    }
    return replace(recovered, **members)


def _contact_displacements(model: Joint, forces: Matrix, shear: Matrix | None) -> Matrix:
    """Return Q K⁻¹ Gᵀ λ (..., n_port)."""
    return model.port_compliance.per_contact(model.contact.at_pairs(forces, shear).T)


def solve_increments(model: Joint, free: Matrix, begin: Solution | None) -> ContactStates:
    """Solve contact at every instant, each starting from the state after the one before.

    Without contact forces pairs move by ``free`` (n_time, n_relative). The first state of ``begin``
    has the slip and the forces to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided.
    """
    first = None if begin is None else state_of(begin, 0)
    return contact_along(model, free, partial(path_at, model, free[0], first))
