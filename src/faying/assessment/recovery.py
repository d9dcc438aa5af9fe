"""Pressure recovery: trustworthy contact pressures from any reduced trajectory, (R5).

A reduced trajectory is poor in pressure because its few trial vectors must carry the contact. Its
inertia and damping forces are good all the same, as they are spread over the whole structure.
Recovery takes only those from it and solves, at each instant, the static contact problem of the
full model:

    g_free = g₀ + G K⁻¹ (f − M Φ q̈ − C Φ q̇),   s = (S + D) λ + g_free ≥ 0,  λ ≥ 0,  λᵀ s = 0.

It is the mode-acceleration method of structural dynamics with contact. ``docs/theory/recovery.md``
derives it and says what limits it.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying._typing import Indices, Matrix, Vector, frozen
from faying.contact.condensed import ContactSolver
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.joint.system import (
    Joint,
    PortCompliance,
    System,
    bolt_input,
    boundary_slices,
    input_forces,
)
from faying.reduction.basis import Basis
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.frame_motion import frame_loads
from faying.simulation.solution import Solution
from faying.simulation.static import port_forces, relative_forces


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Recovered:
    """Pressures of the full model recovered from a reduced history or static solution.

    Read like a :class:`~faying.simulation.solution.Solution`; arrays have no leading axis for one
    static solution, otherwise one entry per case or instant. :func:`faying.compare` accepts it.

    Attributes
    ----------
    name
        Name of the load.
    system
        The full model, or what is known of it at its ports.
    contact_forces : (..., n_point) [force]
        λ = w ∘ p.
    gap : (..., n_point) [length]
    port_displacements : (..., n_port) [length]
        Relative displacements of the pairs, boundary displacements, bolt elongations, and what
        load patterns do work on.
    inputs : (..., n_input) [force]
    iterations : (...)
        Linear systems each contact problem took.
    times : (n_time,) or None
    """

    name: str
    system: Joint
    contact_forces: Matrix
    gap: Matrix
    port_displacements: Matrix
    inputs: Matrix
    iterations: Indices
    times: Vector | None = None

    def __post_init__(self) -> None:
        for name in ("contact_forces", "gap", "port_displacements", "inputs"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def pressure(self) -> Matrix:
        """Contact pressure p (..., n_point) [force/length²], compression positive."""
        pressure: Matrix = self.contact_forces / self.system.contact.weights
        return pressure

    @property
    def max_pressure(self) -> Matrix:
        """Largest pressure over the contact points (...)."""
        return np.asarray(self.pressure.max(axis=-1, initial=0.0))

    def contact_force(self, interface: str | None = None) -> Matrix:
        """Return the total normal force Σ λ of one interface, or of all (...) [force]."""
        points = slice(None) if interface is None else self.system.contact.slices[interface]
        return np.asarray(self.contact_forces[..., points].sum(axis=-1))

    def displacement(self, boundary: str) -> Matrix:
        """Return the recovered displacements at a boundary (..., n) in its components' order."""
        place = boundary_slices(self.system.boundaries)[boundary]
        displacement: Matrix = self._outer_ports[..., place]
        return displacement

    def bolt_force(self, bolt: str) -> Matrix:
        """Return the axial force of a bolt (...) [force], tension positive."""
        place = bolt_input(self.system, bolt)
        elongation = self._outer_ports[..., place]
        return np.asarray(self.system.bolts[bolt].stiffness * elongation + self.inputs[..., place])

    @property
    def _outer_ports(self) -> Matrix:
        outer: Matrix = self.port_displacements[..., self.system.port_compliance.n_relative :]
        return outer


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Recovery:
    """What recovery needs of a model and a basis: a few dense matrices, no finite elements.

    With Q the ports (relative displacements, boundary, bolt elongations, load patterns):

    Attributes
    ----------
    model
        The full model, or what is known of it at its ports.
    ports
        Q K⁻¹ Qᵀ.
    static_contact
        Contact points, law and compliance S of the full model.
    inertia : (n_port, n_mode)
        Q K⁻¹ M Φ.
    damping : (n_port, n_mode)
        Q K⁻¹ C Φ.
    frame : (n_port, 12) or None
        Q K⁻¹ M A for supports that move, see :mod:`faying.simulation.frame_motion`.
    """

    model: Joint
    ports: PortCompliance
    static_contact: ContactSolver
    inertia: Matrix
    damping: Matrix
    frame: Matrix | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "inertia", frozen(self.inertia))
        object.__setattr__(self, "damping", frozen(self.damping))

    def free_displacements(
        self, inputs: Matrix, velocities: Matrix, accelerations: Matrix
    ) -> Matrix:
        """Return Q K⁻¹ (f − M Φ q̈ − C Φ q̇) (..., n_port) for all instants at once."""
        moving = accelerations @ self.inertia.T + velocities @ self.damping.T
        free: Matrix = static_displacements(self.ports, inputs) - moving
        return free


def recovery_operator(model: Model, basis: Basis) -> Recovery:
    """Precompute the recovery matrices of a model and a basis.

    Independent of any solution; the matrices are all an importing program needs.

    Raises
    ------
    ModelError
        If the basis belongs to a model with another number of degrees of freedom.
    SingularMatrixError
        If the structure is not held without its boundary.

    Notes
    -----
    Two back-substitutions per trial vector, the cost of :func:`frame_operator`, and the port
    compliance the model keeps.
    """
    return replace(supported_operator(model, basis), frame=frame_operator(model))


def supported_operator(model: Model, basis: Basis) -> Recovery:
    """Precompute the recovery matrices of a model whose supports rest, as the model's own do.

    As :func:`recovery_operator`, without what only moving supports need.
    """
    structure = model.structure
    if basis.vectors.shape[0] != structure.n_dof:
        message = (
            f"the basis has {basis.vectors.shape[0]} rows but the model has {structure.n_dof} "
            "degrees of freedom; recover with the model the basis was made from"
        )
        raise ModelError(message)
    return Recovery(
        model=model,
        ports=model.port_compliance,
        static_contact=model.static_contact,
        inertia=at_ports(model, structure.solve(model.M @ basis.vectors)),
        damping=at_ports(model, structure.solve(model.C @ basis.vectors)),
    )


def frame_operator(model: Model) -> Matrix:
    """Return Q K⁻¹ M A (n_port, 12) for supports that move.

    Notes
    -----
    One assembly of the mass matrix and twelve back-substitutions.
    """
    return at_ports(model, model.structure.solve(frame_loads(model)))


def recover_pressure(
    model: Model,
    solution: Solution,
    *,
    instants: Indices | None = None,
    operator: Recovery | None = None,
) -> Recovered:
    """Recover the pressures of the full model from a static or transient solution.

    Parameters
    ----------
    model
        The full model; its contact law counts, that of the solution does not.
    solution
        Of a reduced model with any basis, or of the full model (which gives itself back).
    instants
        Indices of the instants or cases wanted; all unless given.
    operator
        Result of :func:`recovery_operator` where it is known already.

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
    """
    at = slice(None) if instants is None else np.asarray(instants, dtype=np.int64)
    chosen = _selected(solution, at)
    if isinstance(solution.system, ReducedModel):
        free = _free_from_reduced(model, solution.system, chosen, operator)
    else:
        free = _free_from_full(model, chosen)
    return solve_instants(model, chosen.name, chosen.inputs, free, chosen.times)


def recover_reduced(operator: Recovery, solution: Solution) -> Recovered:
    """Recover the pressures of a reduced transient whose recovery matrices are known.

    As :func:`recover_pressure`, without the finite element model.

    Raises
    ------
    ModelError
        If the solution is no transient, or of a model with another number of coordinates.
    """
    shape = solution.states.shape
    if solution.velocities is None or shape[-1] != operator.inertia.shape[1]:
        message = (
            f"the solution has states of shape {shape}; expected a transient with "
            f"{operator.inertia.shape[1]} coordinates, those of the recovery matrices"
        )
        raise ModelError(message)
    accelerations = balanced_accelerations(solution.system, solution)
    free = operator.free_displacements(solution.inputs, solution.velocities, accelerations)
    return solve_instants(operator.model, solution.name, solution.inputs, free, solution.times)


def static_displacements(ports: PortCompliance, inputs: Matrix) -> Matrix:
    """Return port displacements Q K⁻¹ f (..., n_port) under inputs alone."""
    return ports.per_input(port_forces(ports, inputs))


def _selected(solution: Solution, at: slice | Indices) -> Solution:
    """Take some instants; nothing to choose from in a single static solution."""
    if solution.contact_forces.ndim == 1:
        return solution
    return Solution(
        name=solution.name,
        system=solution.system,
        states=solution.states[at],
        contact_forces=solution.contact_forces[at],
        gap=solution.gap[at],
        inputs=solution.inputs[at],
        iterations=solution.iterations[at],
        times=None if solution.times is None else solution.times[at],
        velocities=None if solution.velocities is None else solution.velocities[at],
        accelerations=None if solution.accelerations is None else solution.accelerations[at],
    )


def _free_from_reduced(
    model: Model, rom: ReducedModel, solution: Solution, operator: Recovery | None
) -> Matrix:
    """Port displacements without contact forces, from a solution of a reduced model."""
    if solution.velocities is None:
        return static_displacements(model.port_compliance, solution.inputs)
    known = supported_operator(model, rom.basis) if operator is None else operator
    accelerations = balanced_accelerations(rom, solution)
    return known.free_displacements(solution.inputs, solution.velocities, accelerations)


def _free_from_full(model: Model, solution: Solution) -> Matrix:
    """Q (u − K⁻¹ Gᵀ λ): by balance, what the full model displaces without contact forces."""
    if solution.states.shape[-1] != model.structure.n_dof:
        message = (
            f"the solution has {solution.states.shape[-1]} degrees of freedom but the model "
            f"{model.structure.n_dof}; recover with the model that was solved"
        )
        raise ModelError(message)
    displacements = at_ports(model, solution.states.T).T
    return displacements - _contact_displacements(model, solution.contact_forces)


def balanced_accelerations(system: System, solution: Solution) -> Matrix:
    """Return q̈ (n_time, n_mode) that balances a reduced model at the instants themselves.

    Massless coordinates, which feel no inertia force, get the least-norm value.
    """
    known = solution.velocities
    velocities = np.zeros_like(solution.states) if known is None else known
    force = input_forces(system, solution.inputs) + relative_forces(system, solution.contact_forces)
    elastic, damping, mass = (np.asarray(matrix) for matrix in (system.K, system.C, system.M))
    unbalanced = force - solution.states @ elastic - velocities @ damping
    # Masses of coordinates differ by many orders; unscaled, the pseudoinverse mixes their errors.
    own = np.diag(mass)
    scale = 1 / np.sqrt(np.where(own > 0, own, 1.0))
    scaled = np.linalg.lstsq(mass * scale[:, None] * scale, (unbalanced * scale).T, rcond=None)[0]
    return np.asarray(scaled.T * scale, dtype=np.float64)


def solve_instants(
    model: Joint, name: str, inputs: Matrix, free: Matrix, times: Vector | None
) -> Recovered:
    """Solve the static contact problem of every row, each started from the one before."""
    condensed, n_relative = model.static_contact, model.port_compliance.n_relative
    rows = np.atleast_2d(free)
    shape = (len(rows), model.contact.n_points)
    forces, gaps = np.empty(shape), np.empty(shape)
    iterations = np.empty(len(rows), dtype=np.int64)
    state = None
    for row, gap in enumerate(condensed.free_gap(rows[:, :n_relative])):
        solution, state = condensed.solve(gap, state)
        forces[row], gaps[row] = solution.forces, condensed.gap(solution)
        iterations[row] = solution.iterations
    one = free.ndim == 1
    lambdas = forces[0] if one else forces
    return Recovered(
        name=name,
        system=model,
        contact_forces=lambdas,
        gap=gaps[0] if one else gaps,
        port_displacements=free + _contact_displacements(model, lambdas),
        inputs=inputs,
        iterations=iterations[0] if one else iterations,
        times=times,
    )


def _contact_displacements(model: Joint, forces: Matrix) -> Matrix:
    """Q K⁻¹ Gᵀ λ (..., n_port)."""
    ports = model.port_compliance
    at_pairs = (model.contact.interpolation.T @ np.asarray(forces).T).T
    return ports.per_contact(at_pairs)


def at_ports(model: Model, displacements: Matrix) -> Matrix:
    """Q U (n_port[, k]) of displacements U (n_dof[, k])."""
    structure = model.structure
    return np.concatenate(
        [
            structure.relative_operator @ displacements,
            displacements[structure.boundary],
            structure.elongations @ displacements,
            model.pattern_forces @ displacements,
        ]
    )
