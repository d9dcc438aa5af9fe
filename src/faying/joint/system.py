"""The common interface of full and reduced models, for every solver.

A system obeys M ü + C u̇ + K u = f + Pᵀ Nᵀ λ (15.13, 15.16). Forces enter and quantities of
interest leave through its *ports*: relative displacements of the contact pairs, boundary
displacements, bolt elongations, and displacements on which load patterns do work. All static
contact problems depend on the compliance between ports alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector, frozen
from faying.contact.between_pairs import BetweenPairs, ByCompliance, Stiffness
from faying.contact.condensed import CondensedContact, ContactSolver
from faying.contact.contact import Contact
from faying.interface.interface import Interface
from faying.interface.surface import ContactSurface
from faying.joint.load_pattern import LoadPattern, pattern_forces
from faying.joint.weak_support import WeakSupport
from faying.linalg.interface import Factorization
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@dataclass(frozen=True, eq=False, kw_only=True)
class PortCompliance(Frozen):
    """Displacement at the ports per force at the ports, Q K⁻¹ Qᵀ, symmetric.

    Ports come in the order relative displacements, boundary, bolts, load patterns.

    Attributes
    ----------
    pairs
        Relative displacement per contact force, or its inverse, a stiffness.
    contact_columns : (n_input, n_relative)
        All other ports per contact force.
    input_rows : (n_input, n_input)
        All other ports per force at them.
    n_boundary
        Number of boundary degrees of freedom.
    n_pattern
        Number of load patterns.
    """

    pairs: BetweenPairs
    contact_columns: Matrix
    input_rows: Matrix
    n_boundary: int
    n_pattern: int = 0

    @property
    def relative(self) -> Matrix:
        """Relative displacement per contact force (n_relative, n_relative), a dense matrix.

        Raises
        ------
        ModelError
            If it exceeds the dense budget.
        """
        return self.pairs.compliance

    @property
    def bolts(self) -> slice:
        """Slice of the bolts in the inputs."""
        return slice(self.n_boundary, len(self.input_rows) - self.n_pattern)

    @property
    def n_relative(self) -> int:
        """Number of relative displacements."""
        return int(self.contact_columns.shape[1])

    @property
    def n_port(self) -> int:
        """Number of all ports."""
        return self.n_relative + len(self.input_rows)

    @property
    def whole(self) -> Matrix:
        """The compliance of all ports as one matrix (n_port, n_port)."""
        return np.block(
            [[self.relative, self.contact_columns.T], [self.contact_columns, self.input_rows]]
        )

    def per_contact(self, forces: Matrix) -> Matrix:
        """Return displacements of all ports (..., n_port) under forces between the pairs."""
        forces = np.asarray(forces)
        inner = (self.pairs @ forces.T).T
        return np.concatenate([inner, forces @ self.contact_columns.T], axis=-1)

    def per_input(self, forces: Matrix) -> Matrix:
        """Return displacements of all ports (..., n_port) under forces at the inputs."""
        return np.concatenate([forces @ self.contact_columns, forces @ self.input_rows], axis=-1)


def port_compliance_of(
    matrix: Matrix,
    n_relative: int,
    n_boundary: int,
    n_pattern: int = 0,
    stiffness: Matrix | None = None,
) -> PortCompliance:
    """Return the port compliance from one symmetric matrix (n_port, n_port).

    A known stiffness between the pairs (n_relative, n_relative) is used instead of its inverse.
    """
    known = None if stiffness is None else Stiffness(frozen(stiffness))
    return PortCompliance(
        pairs=ByCompliance(frozen(matrix[:n_relative, :n_relative]), known),
        contact_columns=matrix[n_relative:, :n_relative],
        input_rows=matrix[n_relative:, n_relative:],
        n_boundary=n_boundary,
        n_pattern=n_pattern,
    )


class Joint(Protocol):
    """The part of a system at its ports, sufficient for static contact problems and recovery."""

    @property
    def contact(self) -> Contact:
        """All contact points."""

    @property
    def boundaries(self) -> Mapping[str, Boundary]:
        """Boundaries for loads."""

    @property
    def bolts(self) -> Mapping[str, Bolt]:
        """Bolts, with the initial forces they are locked at."""

    @property
    def load_patterns(self) -> Mapping[str, LoadPattern]:
        """Distributed loads that may be scaled."""

    @property
    def port_compliance(self) -> PortCompliance:
        """Static compliance between the ports, without any residual compliance."""

    @property
    def static_contact(self) -> ContactSolver:
        """The static contact problem, its flexibility formed once."""


class System(Joint, Protocol):
    """A full or reduced model, as used by solvers."""

    @property
    def name(self) -> str:
        """Name of the model."""

    @property
    def units(self) -> str:
        """Label of the consistent unit set."""

    @property
    def interfaces(self) -> Mapping[str, Interface | ContactSurface]:
        """Interfaces by name, in the order of the contact points."""

    @property
    def M(self) -> SparseMatrix | Matrix:
        """Mass matrix (n_dof, n_dof) [mass]."""

    @property
    def C(self) -> SparseMatrix | Matrix:
        """Damping matrix (n_dof, n_dof) [force·time/length]."""

    @property
    def K(self) -> SparseMatrix | Matrix:
        """Stiffness matrix (n_dof, n_dof) [force/length]."""

    @property
    def rigid_motions(self) -> Matrix:
        """R (n_dof, n_motion), free rigid motions; RᵀMR = I."""

    @property
    def weak_supports(self) -> Mapping[str, WeakSupport]:
        """Springs for bodies that contact alone holds, by the names of both bodies."""

    def factorize_static(self) -> Factorization:
        """Return a factorization of K, or K⁺ of (M11) for a free structure."""

    def expand(self, states: Matrix) -> Matrix:
        """Return displacements (..., n_dof) at the free degrees of freedom of the full model."""


def boundary_dofs(boundaries: Mapping[str, Boundary]) -> Indices:
    """Return the indices of all boundary degrees of freedom, boundary by boundary."""
    empty = np.empty(0, dtype=np.int64)
    return np.concatenate([empty, *(boundary.dofs for boundary in boundaries.values())])


def boundary_slices(boundaries: Mapping[str, Boundary]) -> dict[str, slice]:
    """Return the slice of each boundary in all boundary degrees of freedom."""
    slices, start = {}, 0
    for name, boundary in boundaries.items():
        slices[name] = slice(start, start + len(boundary.dofs))
        start += len(boundary.dofs)
    return slices


def input_slices(system: Joint) -> dict[tuple[str, str], slice]:
    """Return the slice of each boundary, bolt and load pattern, by kind and name, in the inputs."""
    slices = {
        ("boundary", name): columns for name, columns in boundary_slices(system.boundaries).items()
    }
    n = sum(len(boundary.dofs) for boundary in system.boundaries.values())
    for kind, names in (("bolt", system.bolts), ("load pattern", system.load_patterns)):
        slices |= {(kind, name): slice(n + i, n + i + 1) for i, name in enumerate(names)}
        n += len(names)
    return slices


def elongations(bolts: Mapping[str, Bolt], n_dof: int) -> Matrix:
    """Return the elongation rows of all bolts (n_bolt, n_dof)."""
    rows = [bolt.elongation for bolt in bolts.values()]
    return np.array(rows, dtype=float).reshape(len(rows), n_dof)


def input_forces(system: System, inputs: Matrix) -> Matrix:
    """Return external forces f_e (..., n_dof) from inputs (..., n_input).

    Inputs are boundary forces, then initial bolt forces N₀, which pull head and nut together by
    −elongationᵀ N₀, then amplitudes of load patterns.
    """
    inputs = np.asarray(inputs, dtype=float)
    dofs = boundary_dofs(system.boundaries)
    n_dof, first = system.K.shape[0], len(dofs) + len(system.bolts)
    forces = -(inputs[..., len(dofs) : first] @ elongations(system.bolts, n_dof))
    forces[..., dofs] += inputs[..., : len(dofs)]
    if system.load_patterns:
        forces += inputs[..., first:] @ pattern_forces(system.load_patterns, n_dof)
    return forces


def bolt_input(system: Joint, bolt: str) -> int:
    """Return the index of a bolt's initial force in the inputs."""
    n_boundary = sum(len(boundary.dofs) for boundary in system.boundaries.values())
    return n_boundary + list(system.bolts).index(bolt)


def unstretched_bolt_forces(system: Joint, inputs: Matrix) -> Matrix:
    """Return the forces (..., n_bolt) of bolts at zero elongation, from inputs (..., n_input).

    They are the initial forces N₀, plus those of load patterns where a shank expands.
    """
    patterns, bolts = list(system.load_patterns.values()), list(system.bolts)
    first = inputs.shape[-1] - len(patterns)
    added = np.array(
        [[pattern.bolt_forces.get(bolt, 0.0) for bolt in bolts] for pattern in patterns]
    )
    expanded = inputs[..., first:] @ added.reshape(len(patterns), len(bolts))
    return np.asarray(inputs[..., first - len(bolts) : first] + expanded)


def initial_bolt_forces(system: Joint) -> Vector:
    """Return the initial forces the bolts are locked at (n_bolt,) [force]."""
    return np.array([bolt.initial_force for bolt in system.bolts.values()], dtype=float)


def static_contact_of(system: Joint) -> CondensedContact:
    """Return the static contact problem of a system, for any initial forces of bolts."""
    ports = system.port_compliance
    columns = ports.contact_columns[ports.bolts]
    pulled = -columns.sum(axis=0) if len(columns) else None
    return CondensedContact(contact=system.contact, compliance=ports.pairs, pulled=pulled)


@dataclass(frozen=True, eq=False, kw_only=True)
class PortableJoint:
    """A full or reduced model, or another contact law on it, reduced to its ports.

    Attributes
    ----------
    contact
        Where there are no degrees of freedom behind the pairs, ``relative_operator`` has no
        columns.
    boundaries, bolts, load_patterns
        By name; without degrees of freedom those of the boundaries are numbered through, bolts have
        no elongation row and load patterns no forces.
    port_compliance
        Q K⁻¹ Qᵀ.
    """

    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    load_patterns: Mapping[str, LoadPattern]
    port_compliance: PortCompliance

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem at the ports."""
        return static_contact_of(self)
