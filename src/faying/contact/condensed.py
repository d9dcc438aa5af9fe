"""Contact condensed to its points: g = g_free + S λ with S = G A⁻¹ Gᵀ for any linear operator A."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.contact.interface import Contact
from faying.contact.problem import ContactForces, ContactProblem


class ContactSolver(Protocol):
    """What a system's contact problem offers to solvers: exact, or itself reduced."""

    @property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point)."""
        ...

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) for relative displacements (..., n_relative) without λ."""
        ...

    def solve(self, relative_displacement: Vector, active: Mask | None = None) -> ContactForces:
        """Solve for the contact forces that a free relative displacement calls up."""
        ...

    def solve_gap(self, free_gap: Vector, active: Mask | None = None) -> ContactForces:
        """Solve for the contact forces that a free gap (n_point,) calls up."""
        ...

    def gap(self, solution: ContactForces) -> Vector:
        """Gap (n_point,) of a solution."""
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
    """

    contact: Contact
    compliance: Matrix

    @cached_property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point), residual compliance included; design §3."""
        residual = self.contact.residual_compliance
        total = self.compliance if residual is None else self.compliance + residual
        flexibility = self.contact.at_points(total)
        flexibility[np.diag_indices_from(flexibility)] += self.contact.flexibility
        return flexibility

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) for relative displacements (..., n_relative) without λ."""
        gap: Matrix = (self.contact.interpolation @ np.asarray(relative_displacement).T).T
        return gap + self.contact.initial_gap

    def solve(self, relative_displacement: Vector, active: Mask | None = None) -> ContactForces:
        """Solve for the contact forces that a free relative displacement calls up."""
        return self.solve_gap(self.free_gap(relative_displacement), active)

    def solve_gap(self, free_gap: Vector, active: Mask | None = None) -> ContactForces:
        """Solve for the contact forces that a free gap (n_point,) calls up."""
        return ContactProblem(H=self.flexibility, g_free=free_gap).solve(active=active)

    def gap(self, solution: ContactForces) -> Vector:
        """Gap (n_point,) of a solution; negative by the penetration where contact is elastic."""
        penetration = self.contact.flexibility * solution.forces
        gap: Vector = solution.slack - penetration
        return gap
