"""Contact condensed to its points: g = g_free + S λ with S = G A⁻¹ Gᵀ for any linear operator A."""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.between_pairs import (
    BetweenPairs,
    ByCompliance,
    ByStiffness,
    BySubstitution,
)
from faying.contact.compressed_space import CompressedSpace
from faying.contact.contact import Contact
from faying.contact.dense_points import DensePoints
from faying.contact.frictional import FrictionalContact
from faying.contact.glued_pairs import factorized_whole
from faying.contact.held_pairs import NormalPairs
from faying.contact.increment import IncrementSolver
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.point_springs import PointSprings
from faying.contact.pressing import PressingContact, dense_compliance
from faying.contact.yielding import YieldingContact
from faying.exceptions import ModelError
from faying.linalg.budget import pairs_fit
from faying.linalg.compressed import Compliance, CompressedCompliance, smooth_compliance
from faying.linalg.factorization import Factorization
from faying.linalg.partial import compressed_port_compliance, port_compliance
from faying.linalg.sparse_stiffness import SparseStiffness

_log = logging.getLogger("faying")


class ContactSolver(Protocol):
    """What a system's contact problem offers to solvers: exact, or itself reduced."""

    @property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point)."""
        ...

    @property
    def frictional(self) -> FrictionalContact:
        """Increments as problems of forces; refused where contact is itself reduced."""
        ...

    @property
    def increments(self) -> IncrementSolver:
        """The solver of cases, increments and steps."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class CondensedContact:
    """The contact of a system whose response to contact forces is known.

    Attributes
    ----------
    contact
        Gap operator and law.
    compliance : (n_relative, n_relative) [length/force]
        Relative displacement of the pairs per relative force, P A⁻¹ Pᵀ (times the factor with
        which an integrator weighs the new contact force).
    pulled : (n_relative,) or None [length]
        Relative displacement that equal forces of all bolts would cause without contact.
    at_rest
        Returns the static contact of the same joint where this is that of a step.
    """

    contact: Contact
    compliance: Compliance | BetweenPairs
    pulled: Vector | None = None
    at_rest: "Callable[[], ContactSolver] | None" = None

    @cached_property
    def between(self) -> BetweenPairs:
        """The structure between pairs, residual compliance included."""
        residual, known = self.contact.residual_compliance, self.compliance
        if isinstance(known, ByStiffness | BySubstitution) and residual is None:
            return known
        compliance = known.compliance if isinstance(known, BetweenPairs) else known
        if isinstance(residual, CompressedCompliance):
            # Only reduced models have residuals, and their own compliance is smooth.
            return ByCompliance(residual.added(cast("CompressedCompliance", compliance)))
        if residual is None:
            return ByCompliance(compliance)
        return ByCompliance(np.asarray(cast("Matrix", compliance) + residual))

    @property
    def total(self) -> Compliance:
        """Compliance between pairs with the residual compliance, dense or compressed."""
        return self.between.compliance

    @cached_property
    def space(self) -> DensePoints | CompressedSpace:
        """The form in which active sets are solved, chosen by memory alone."""
        total, contact = self.total, self.contact
        if isinstance(total, CompressedCompliance):
            _log.info(announcement(total, contact))
            return CompressedSpace(N=contact.interpolation, S=total, D=contact.flexibility)
        return DensePoints(H=_finite(self.flexibility))

    @cached_property
    def frictional(self) -> FrictionalContact:
        """Increments as problems of forces (F1)."""
        S = dense_compliance(self.contact, self.between)
        return FrictionalContact(contact=self.contact, S=_finite(S))

    @cached_property
    def increments(self) -> IncrementSolver:
        """The solver of increments: for displacements, or for forces.

        For forces where some point is hard, or far stiffer than the structure, and where the
        compliance between pairs is compressed.

        Raises
        ------
        ModelError
            If that is compressed, and contact has friction or curves.
        """
        if not self.contact.yields or isinstance(self._known, CompressedCompliance):
            return self._for_forces("joints with hard contact", "a penalty there")
        if isinstance(between := self.between, BySubstitution):
            _log.info(
                "%d contact points on %d relative displacements: dense matrices exceed the dense "
                "budget of %.2g bytes, so every increment is solved with sparse factors",
                self.contact.n_points,
                self.contact.relative_operator.shape[0],
                self.contact.dense_budget,
            )
        else:
            _ = _finite(cast("Matrix", self._known))
        try:
            return YieldingContact.of(self.contact, between, self._pressed)
        except la.LinAlgError:
            return self._for_forces(
                "solutions for forces, as where the compliance between pairs is singular,",
                "the full model or compliance=True",
            )

    @property
    def _known(self) -> Compliance | SparseStiffness:
        """Σ where it is known, else S."""
        between = self.between
        return between.compliance if isinstance(between, ByCompliance) else between.stiffness

    def _pressed(self) -> Vector | None:
        """Return ones at points (n_point,) that the bolts press on at rest, where they tell it.

        Steps of few pairs, which are factorized whole, need not know.
        """
        if self.at_rest is not None and factorized_whole(self.contact.rows):
            return None
        rest = self if self.at_rest is None else self.at_rest()
        if not isinstance(rest, CondensedContact) or rest.pulled is None:
            return None
        between = rest.between
        if isinstance(between, BySubstitution):
            return None
        springs = LawsAtPoints(contact=self.contact).springs
        points = PointSprings(G=self.contact.rows, components=len(springs))
        normal = NormalPairs.of(points, between.stiffness)
        return normal.pressed(springs[0], (between.stiffness @ rest.pulled)[normal.felt])

    def _for_forces(self, what: str, instead: str) -> IncrementSolver:
        """Return the solver of problems of forces, which refuses laws that remember."""
        contact = self.contact
        if contact.forgets and contact.proportional:
            return PressingContact(contact=contact, between=self.between, space=self.space)
        forces = self.frictional
        contact.check_forgetful(what, instead)
        return forces

    @property
    def order(self) -> int:
        """Order of the dense matrices that contact problems are solved with."""
        return min(self.contact.n_points, int(self.contact.relative_operator.shape[0]))

    @cached_property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point), residual compliance included, (M2).

        Raises
        ------
        ModelError
            If dense matrices of that size exceed the dense budget.
        """
        self.contact.check_frictionless()
        flexibility = self.contact.at_points(self.total)
        flexibility[np.diag_indices_from(flexibility)] += self.contact.flexibility
        return flexibility


def relative_compliance(contact: Contact, factor: Factorization, weight: float = 1.0) -> Compliance:
    """Return the compliance P A⁻¹ Pᵀ between pairs, times a weight, for a factorized A.

    Notes
    -----
    Dense within the dense budget; beyond it compressed for a full model, and in factored form for
    a reduced one.
    """
    ports = contact.relative_operator
    if contact.places is None or pairs_fit(ports.shape[0], contact.dense_budget):
        return weight * port_compliance(ports, factor)
    if isinstance(ports, np.ndarray):
        core = weight * factor.solve(np.eye(ports.shape[1]))
        return smooth_compliance(ports, core, contact.places)
    sparse = cast("SparseMatrix", ports)
    return compressed_port_compliance(sparse, factor, contact.places).scaled(weight)


def announcement(compliance: CompressedCompliance, contact: Contact) -> str:
    """Say that a compliance is compressed, what that saves and what error it makes."""
    n = compliance.shape[0]
    space = CompressedSpace(N=contact.interpolation, S=compliance, D=contact.flexibility)
    return (
        f"{contact.n_points} contact points on {n} relative displacements: dense matrices exceed "
        f"the dense budget of {contact.dense_budget:.2g} bytes, so the compliance is compressed to "
        f"{compliance.n_bytes / (8 * n**2):.1%} of its size; pressures change by less than "
        f"{space.truncation:.1e} (relative, root mean square)"
    )


def _finite(matrix: Matrix) -> Matrix:
    if not np.isfinite(matrix).all():
        message = "the contact flexibility holds NaN or infinity; check the model's matrices"
        raise ModelError(message)
    return matrix
