"""Galerkin projection, Eq. (15.16): a reduced model is a system like the full one."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from faying._typing import Matrix, frozen
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.joint.load_pattern import LoadPattern
from faying.joint.model import Model
from faying.joint.system import PortCompliance, static_contact_of
from faying.linalg.compressed import Compliance, plus
from faying.linalg.factorization import Factorization, factorize
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.portable import reduced_ports

VANISHING = (ModeKind.NORMAL, ModeKind.BOLT, ModeKind.LOAD, ModeKind.JOINT)
"""Kinds of trial vectors that vanish on the boundary, Φ_f."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedModel:
    """A model in generalized coordinates q of u ≈ Φ q, Eq. (15.15).

    Attributes
    ----------
    M, C, K : (n_mode, n_mode)
    contact
        With PΦ in place of P, and the residual compliance where it is kept.
    boundaries, bolts, load_patterns
        As seen by the generalized coordinates.
    basis
        Φ.
    model
        The full model.
    """

    M: Matrix
    C: Matrix
    K: Matrix
    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    basis: Basis
    model: Model
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

    def expand(self, states: Matrix, contact_forces: Matrix) -> Matrix:
        """Return u = Φ q (..., n_dof of the full model) for states (..., n_mode).

        A residual compliance adds what the contact forces (..., n_point) do beyond the basis.
        """
        displacement: Matrix = states @ self.basis.vectors.T
        if self.contact.residual_compliance is None:
            return displacement
        between_pairs = contact_forces @ self.contact.interpolation
        return displacement + residual_displacement(self.model, self.basis, between_pairs)

    def with_bolt_forces(self, initial_forces: Mapping[str, float]) -> "ReducedModel":
        """Return a copy with bolts locked at other initial forces N₀."""
        locked = {name: self.bolts[name].locked(force) for name, force in initial_forces.items()}
        return replace(self, bolts={**self.bolts, **locked})


def reduce(model: Model, basis: Basis, *, compliance: bool = False) -> ReducedModel:
    """Project a model onto a basis.

    Parameters
    ----------
    basis
        Trial vectors; boundary rows [I 0] where it has constraint modes.
    compliance
        Keep the compliance between contact points that the basis lacks, as a massless spring
        between contact forces and gaps, (M5): static solutions are then exact.

    Returns
    -------
    ReducedModel
        Solved by the same functions as the full model.

    Notes
    -----
    Three projections; with ``compliance`` one back-substitution per contact pair, made once for
    all bases of a structure.
    """
    phi = basis.vectors
    contact = replace(
        model.contact,
        relative_operator=frozen(model.contact.relative_operator @ phi),
        residual_compliance=residual_compliance(model, basis) if compliance else None,
    )
    return ReducedModel(
        M=_projected(model.M @ phi, phi),
        C=_projected(model.C @ phi, phi),
        K=_projected(model.K @ phi, phi),
        contact=contact,
        boundaries=_boundaries(model, basis),
        bolts={name: bolt.projected(phi) for name, bolt in model.bolts.items()},
        basis=basis,
        model=model,
        load_patterns={name: one.projected(phi) for name, one in model.load_patterns.items()},
    )


def residual_compliance(model: Model, basis: Basis) -> Compliance:
    """Compliance R (n_relative, n_relative) between contact pairs that a basis cannot express.

    R = P K_ii⁻¹ Pᵀ − PΦ_f (Φ_fᵀ K Φ_f)⁻¹ (PΦ_f)ᵀ, (M6), with Φ_f the shapes that vanish on the
    boundary.
    Constraint modes are exact and K-orthogonal to Φ_f, so this equals (M5),
    P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ, where the structure is held, and exists where it is not. Positive
    semidefinite: it is the compliance of the structure with its boundary and Φ_f held.
    """
    fixed = basis.of_kind(*VANISHING)
    seen = model.structure.relative_operator @ fixed
    stiffness = fixed.T @ (model.K @ fixed)
    return plus(model.structure.held_compliance, seen, -np.linalg.inv(stiffness))


def residual_displacement(model: Model, basis: Basis, forces: Matrix) -> Matrix:
    """Displacements (..., n_dof) behind R: those of pair forces (..., n_relative) beyond a basis.

    K_ii⁻¹ Pᵀ f − Φ_f (Φ_fᵀ K Φ_f)⁻¹ Φ_fᵀ Pᵀ f, which P takes to R f.

    Notes
    -----
    One back-substitution for each f.
    """
    fixed = basis.of_kind(*VANISHING)
    at_dofs = (np.atleast_2d(forces) @ model.structure.relative_operator).T
    held = model.structure.solve_held(at_dofs)
    shares = np.linalg.solve(fixed.T @ (model.K @ fixed), fixed.T @ at_dofs)
    beyond: Matrix = (held - fixed @ shares).T
    return beyond.reshape(*np.shape(forces)[:-1], -1)


def _projected(image: Matrix, phi: Matrix) -> Matrix:
    product: Matrix = phi.T @ image
    return (product + product.T) / 2


def _boundaries(model: Model, basis: Basis) -> dict[str, Boundary]:
    """Constraint modes come in the order of the structure's boundary."""
    constraint = np.array([kind is ModeKind.CONSTRAINT for kind in basis.kinds])
    column = dict(
        zip(model.structure.boundary.tolist(), np.flatnonzero(constraint).tolist(), strict=True)
    )
    return {
        name: boundary.with_dofs(np.array([column[dof] for dof in boundary.dofs.tolist()]))
        for name, boundary in model.boundaries.items()
    }
