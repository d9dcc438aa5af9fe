"""Contact condensed to its points: g = g_free + S λ with S = G A⁻¹ Gᵀ for any linear operator A."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.active_set import ActiveSetSpace
from faying.contact.augmented import AugmentedContact
from faying.contact.between_pairs import BetweenPairs, ByCompliance, BySubstitution
from faying.contact.by_shapes import ByShapes
from faying.contact.contact import Contact
from faying.contact.dense_points import DensePoints
from faying.contact.glued_pairs import factorized_whole
from faying.contact.held_pairs import NormalPairs
from faying.contact.increment import IncrementSolver, check_flexibility
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.point_springs import PointSprings
from faying.contact.pressing import PressingContact
from faying.contact.saddle_points import SaddlePoints
from faying.contact.yielding import YieldingContact
from faying.linalg.budget import pairs_fit
from faying.linalg.interface import Factorization
from faying.linalg.partial import port_compliance
from faying.linalg.sparse_compliance import SparseCompliance
from faying.linalg.sparse_stiffness import SparseStiffness
from faying.linalg.threads import threads_for


class ContactSolver(Protocol):
    """The contact problem of a system, full or itself reduced, as solvers use it."""

    @property
    def between(self) -> BetweenPairs:
        """The structure between pairs; refused where contact is itself reduced."""

    @property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point)."""

    @property
    def increments(self) -> IncrementSolver:
        """The solver of load cases, increments and time steps."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CondensedContact:
    """The contact problem of a system, condensed to the node pairs.

    Attributes
    ----------
    contact
        Gap operator and law.
    compliance : (n_relative, n_relative) [length/force]
        Relative displacement of the pairs per relative force, P A⁻¹ Pᵀ (times the factor with
        which an integrator weighs the new contact force), or a structure with this compliance.
    pulled : (n_relative,) or None [length]
        Relative displacement that equal forces of all bolts would cause without contact.
    at_rest
        Function that returns the static contact problem, where this one belongs to a time step.
    """

    contact: Contact
    compliance: Matrix | BetweenPairs
    pulled: Vector | None = None
    at_rest: "Callable[[], ContactSolver] | None" = None

    @cached_property
    def between(self) -> BetweenPairs:
        """The structure between pairs, residual compliance included."""
        residual, known = self.contact.residual_compliance, self.compliance
        structure = ByCompliance(known) if isinstance(known, np.ndarray) else known
        return structure if residual is None else structure.softened(residual)

    @property
    def total(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) with the residual compliance."""
        return self.between.compliance

    @cached_property
    def space(self) -> ActiveSetSpace:
        """The representation of H for active sets, chosen by memory alone."""
        if isinstance(known := self.between, BySubstitution):
            contact = self.contact
            return SaddlePoints(N=contact.interpolation, S=known.total, D=contact.flexibility)
        return DensePoints(H=check_flexibility(self.flexibility))

    @cached_property
    def increments(self) -> IncrementSolver:
        """The solver of increments: in stages where points are hard or nearly so."""
        # On a fixed number of threads, so that digits do not depend on the first caller.
        with threads_for(self.contact.n_points):
            return self._solver()

    def _solver(self) -> IncrementSolver:
        """Return the solver of increments."""
        if not self.contact.yields:
            return self._staged_solver()
        try:
            return YieldingContact.of(self.contact, self.between, self._clamped, self._by_stages)
        except la.LinAlgError:
            return self._staged_solver()

    def _staged_solver(self) -> IncrementSolver:
        """Return the solver for points that may be hard."""
        contact = self.contact
        if contact.unilateral:
            return PressingContact(contact=contact, between=self.between, space=self.space)
        contact.check_forgetful("joints with hard contact", "a penalty there")
        return self._by_stages

    @property
    def _by_stages(self) -> AugmentedContact:
        return AugmentedContact(contact=self.contact, between=self.between)

    def _clamped(self) -> Vector | None:
        """Return ones at the points (n_point,) that the bolts press together at rest, if known.

        Problems of few pairs, whose matrices are factorized whole, do not need it.
        """
        if self.at_rest is not None and factorized_whole(self.contact.rows):
            return None
        rest = self if self.at_rest is None else self.at_rest()
        if not isinstance(rest, CondensedContact) or rest.pulled is None:
            return None
        springs = LawsAtPoints(contact=self.contact).springs
        points = PointSprings(G=self.contact.rows, components=len(springs))
        stiffness = rest.between.stiffness
        normal = NormalPairs.of(points, stiffness)
        return normal.pressed(springs[0], (stiffness @ rest.pulled)[normal.felt])

    @property
    def order(self) -> int:
        """Order of the dense matrices of contact problems."""
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


def structure_between(
    contact: Contact, matrix: SparseMatrix | Matrix, factor: Factorization, weight: float = 1.0
) -> BetweenPairs:
    """Return the structure with the compliance P A⁻¹ Pᵀ between pairs, times a weight.

    ``factor`` is the factorization of the matrix A.

    Notes
    -----
    A dense matrix within the dense budget. Beyond it, sparse factors for a full model and the
    shapes of the basis for a reduced one.
    """
    ports = contact.relative_operator
    if isinstance(contact.residual_compliance, np.ndarray) or pairs_fit(
        ports.shape[0], contact.dense_budget
    ):
        return ByCompliance(weight * port_compliance(ports, factor))
    if isinstance(ports, np.ndarray):
        return ByShapes(ports, weight * factor.solve(np.eye(ports.shape[1])))
    stiffness = SparseStiffness(
        matrix=cast("SparseMatrix", matrix / weight),
        ports=ports,
        solve=lambda forces: weight * factor.solve(forces),
    )
    return BySubstitution(SparseCompliance.of(stiffness))
