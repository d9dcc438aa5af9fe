"""Contact condensed to its points: g = g_free + S λ with S = G A⁻¹ Gᵀ for any linear operator A."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.active_set import ActiveSetSpace, solve_complementarity
from faying.contact.between_pairs import BetweenPairs, ByCompliance, ByStiffness
from faying.contact.compressed_space import CompressedSpace
from faying.contact.contact import Contact
from faying.contact.dense_points import DensePoints
from faying.contact.forces import ContactForces
from faying.contact.frictional import FrictionalContact
from faying.contact.increment_solver import IncrementSolver
from faying.contact.state import ContactState
from faying.contact.yielding import YieldingContact
from faying.exceptions import ConvergenceError, ModelError
from faying.linalg.budget import pairs_fit
from faying.linalg.compressed import Compliance, CompressedCompliance, smooth_compliance
from faying.linalg.factorization import Factorization
from faying.linalg.partial import compressed_port_compliance, port_compliance

_log = logging.getLogger("faying")


class ContactProblemSolver(Protocol):
    """Solves s = H λ + g_free ≥ 0, λ ≥ 0, λᵀ s = 0 for one H."""

    def solve(
        self, g_free: Vector, state: ContactState | None = None
    ) -> tuple[ContactForces, ContactState]:
        """Return the contact forces, and the state from which a similar problem starts."""
        ...


class ContactSolver(Protocol):
    """What a system's contact problem offers to solvers: exact, or itself reduced."""

    @property
    def flexibility(self) -> Matrix:
        """H = S + D (n_point, n_point)."""
        ...

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) for relative displacements (..., n_relative) without λ."""
        ...

    def solve(
        self, free_gap: Vector, state: ContactState | None = None
    ) -> tuple[ContactForces, ContactState]:
        """Solve for the contact forces that a free gap (n_point,) calls up.

        The state is where a similar problem ended; without one the points with free_gap < 0 are
        tried.
        """
        ...

    @property
    def frictional(self) -> FrictionalContact:
        """Increments as problems of forces; refused where contact is itself reduced."""
        ...

    @property
    def increments(self) -> IncrementSolver:
        """The solver of increments; refused where contact is itself reduced."""
        ...

    @property
    def cases(self) -> IncrementSolver | None:
        """What solves single cases for displacements; None where :meth:`solve` is for them."""
        ...

    def gap(self, solution: ContactForces) -> Vector:
        """Gap (n_point,) of a solution."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class ActiveSetContact:
    """Solver that treats every problem anew, from the points in contact that it is told.

    Attributes
    ----------
    space
        The flexibility, in the form in which its active blocks are solved.
    """

    space: ActiveSetSpace

    def solve(
        self, g_free: Vector, state: ContactState | None = None
    ) -> tuple[ContactForces, ContactState]:
        """Solve by :func:`~.active_set.solve_complementarity`."""
        forces = solve_complementarity(self.space, g_free, None if state is None else state.active)
        return forces, ContactState(active=forces.active)


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
    """

    contact: Contact
    compliance: Compliance | BetweenPairs
    pulled: Vector | None = None

    @cached_property
    def between(self) -> BetweenPairs:
        """The structure between pairs, residual compliance included."""
        residual, known = self.contact.residual_compliance, self.compliance
        if isinstance(known, ByStiffness) and residual is None:
            return known
        compliance = known.compliance if isinstance(known, ByCompliance | ByStiffness) else known
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

    @property
    def _compressed(self) -> bool:
        known = isinstance(self.between, ByStiffness)
        return not known and isinstance(self.total, CompressedCompliance)

    @cached_property
    def space(self) -> ActiveSetSpace:
        """The form in which active sets are solved, chosen by memory alone."""
        total, contact = self.total, self.contact
        if isinstance(total, CompressedCompliance):
            _log.info(announcement(total, contact))
            return CompressedSpace(N=contact.interpolation, S=total, D=contact.flexibility)
        return DensePoints(H=_finite(self.flexibility))

    @cached_property
    def solver(self) -> ContactProblemSolver:
        """The solver of problems of forces, without friction."""
        self.contact.check_frictionless()
        self.contact.check_proportional()
        space = self.space
        return space if isinstance(space, CompressedSpace) else ActiveSetContact(space=space)

    @cached_property
    def frictional(self) -> FrictionalContact:
        """Increments as problems of forces (F1)."""
        total = self.total
        if isinstance(total, CompressedCompliance):
            message = (
                f"friction and curves at {self.contact.n_points} points need a dense compliance "
                "between pairs; raise the budget with model.with_dense_budget, or take a coarser "
                "interface"
            )
            raise ModelError(message)
        return FrictionalContact(contact=self.contact, S=_finite(total))

    @cached_property
    def increments(self) -> IncrementSolver:
        """The solver of increments: for displacements, or for forces.

        For forces where some point is hard, or far stiffer than the structure.

        Raises
        ------
        ModelError
            If the compliance between pairs is compressed.
        """
        if self._compressed or not self.contact.yields:
            forces = self.frictional
            self.contact.check_forgetful("joints with hard contact", "a penalty there")
            return forces
        between = self.between
        _ = _finite(
            between.stiffness
            if isinstance(between, ByStiffness)
            else cast("Matrix", between.compliance)
        )
        try:
            return YieldingContact.of(self.contact, self.between, self.pulled)
        except la.LinAlgError:
            self.contact.check_forgetful(
                "solutions for forces, as where the compliance between pairs is singular,",
                "the full model or compliance=True",
            )
            return self.frictional

    @property
    def cases(self) -> IncrementSolver | None:
        """Increments for displacements; with friction or curves also for forces."""
        of_pressures = self.contact.forgets and self.contact.proportional
        if of_pressures and (self._compressed or not isinstance(self.increments, YieldingContact)):
            return None
        return self.increments

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

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) for relative displacements (..., n_relative) without λ."""
        return self.contact.free_gap(relative_displacement)

    def solve(
        self, free_gap: Vector, state: ContactState | None = None
    ) -> tuple[ContactForces, ContactState]:
        """Solve for the contact forces that a free gap (n_point,) calls up.

        Raises
        ------
        ModelError
            If the gap holds NaN or infinity.
        ConvergenceError
            If there are none: the compliance is not positive semidefinite, or contact is hard at
            more points than the basis of a reduced model has modes, which the message says.
        """
        if not np.isfinite(free_gap).all():
            message = "the gap without contact forces holds NaN or infinity; check loads and model"
            raise ModelError(message)
        with _naming_few_modes(self.contact):
            return self.solver.solve(free_gap, state)

    def gap(self, solution: ContactForces) -> Vector:
        """Gap (n_point,) of a solution; negative by the penetration where contact is elastic."""
        penetration = self.contact.flexibility * solution.forces
        gap: Vector = solution.slack - penetration
        return gap


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


@contextmanager
def _naming_few_modes(contact: Contact) -> Iterator[None]:
    """Say of contact that finds no forces whether the model has fewer modes than hard points."""
    try:
        yield
    except ConvergenceError as error:
        hard = int(np.isinf(contact.penalty).sum())
        modes = int(contact.relative_operator.shape[1])
        if contact.residual_compliance is not None or hard <= modes:
            raise
        message = (
            f"contact is hard at {hard} points, but the model has {modes} degrees of freedom: its "
            "gaps depend on each other, and no contact forces close all that are pressed; keep the "
            "residual compliance (method 'compliance', reduce(..., compliance=True)), take a "
            "penalty, or a basis of more modes than contact points"
        )
        raise ConvergenceError(message) from error


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
