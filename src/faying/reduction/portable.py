"""A joint and its reduced models without finite elements: what travels in files.

A :class:`PortableJoint` keeps of the full model what static contact and recovery need: the
compliance between its ports. A :class:`PortableModel` is a reduced model without its trial vectors;
solvers take it like any other system.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

import numpy as np

from faying._typing import Matrix, frozen
from faying.contact.condensed import CondensedContact, relative_compliance
from faying.contact.contact import Contact
from faying.exceptions import ModelError
from faying.joint.load_pattern import LoadPattern, pattern_forces
from faying.joint.system import (
    PortCompliance,
    System,
    boundary_dofs,
    elongations,
    static_contact_of,
)
from faying.linalg.compressed import plus, symmetrized
from faying.linalg.factorization import Factorization, factorize
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PortableJoint:
    """The full model as seen through its ports.

    Attributes
    ----------
    contact
        Without degrees of freedom behind the pairs, ``relative_operator`` has no columns.
    boundaries, bolts, load_patterns
        By name; boundary degrees of freedom are numbered through, bolts have no elongation row and
        load patterns no forces.
    port_compliance
        Q K⁻¹ Qᵀ of the full model.
    """

    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    port_compliance: PortCompliance
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem of the full model."""
        return static_contact_of(self)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PortableModel:
    """A reduced model in generalized coordinates whose trial vectors stayed behind.

    Attributes
    ----------
    M, C, K : (n_mode, n_mode)
    contact
        With PΦ in place of P, and the residual compliance where it is kept.
    boundaries, bolts, load_patterns
        As seen by the generalized coordinates.
    """

    M: Matrix
    C: Matrix
    K: Matrix
    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("M", "C", "K"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @cached_property
    def _static_factor(self) -> Factorization:
        return factorize(self.K)

    @cached_property
    def port_compliance(self) -> PortCompliance:
        """Static compliance between the ports within the basis."""
        return reduced_ports(self, self._static_factor)

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem of the reduced model."""
        return static_contact_of(self)

    def factorize_static(self) -> Factorization:
        """Return the Cholesky factorization of K."""
        return self._static_factor

    def expand(self, states: Matrix, contact_forces: Matrix) -> Matrix:  # noqa: ARG002
        """Refuse: displacements of the full model need its trial vectors.

        Raises
        ------
        ModelError
        """
        message = (
            f"states of shape {np.shape(states)} cannot be expanded, for the model came without "
            "its trial vectors; take displacements at boundaries and gaps"
        )
        raise ModelError(message)


def reduced_ports(rom: System, factor: Factorization) -> PortCompliance:
    """Return the compliance between the ports of a reduced model from the factorization of K."""
    contact, n_mode = rom.contact, len(rom.K)
    dofs = boundary_dofs(rom.boundaries)
    loads = pattern_forces(rom.load_patterns, n_mode)
    outer = np.vstack([np.eye(n_mode)[dofs], elongations(rom.bolts, n_mode), loads])
    answers = factor.solve(outer.T)
    return PortCompliance(
        relative=relative_compliance(contact, factor),
        contact_columns=(contact.relative_operator @ answers).T,
        input_rows=symmetrized(outer @ answers),
        n_boundary=len(dofs),
        n_pattern=len(loads),
    )


def with_residual(model: PortableModel, joint: PortableJoint) -> PortableModel:
    """Return a portable model that keeps the interface compliance its basis lacks, (M5).

    R = P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ, here from the compliance of the full joint.
    """
    seen = np.asarray(model.contact.relative_operator)
    flexibility = model.factorize_static().solve(np.eye(len(model.K)))
    residual = plus(joint.port_compliance.relative, seen, -flexibility)
    return replace(model, contact=replace(model.contact, residual_compliance=residual))
