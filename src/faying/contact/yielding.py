"""Displacement-based contact solver of one structure, for points with compliance."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.between_pairs import BetweenPairs, ByCompliance, Pressed
from faying.contact.between_solver import BetweenSolver
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import (
    ForcedContact,
    Increment,
    IncrementSolver,
    check_gaps,
    displaced,
)
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_descent import solve_yielding
from faying.contact.sparse_pairs import SparsePairs
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError

STIFFEST = 1e4
"""Largest stiffness of contact at a pair, over the structure's, for forces from displacements.

At 10 E/h it is about ten; at 1e8 gaps had errors of a quarter.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class Across:
    """A structure without some springs across its pairs, whose forces are prescribed.

    With z = Σ c and M = 1/k − ι + cᵀ Σ c, (T1a) is

        Σ (y − y₀) + z N₀ = Gᵀ λ,   zᵀ (y − y₀) + M N₀ = T/k − e₀,                           (T1)

    so that Σ becomes Σ − z M⁻¹ zᵀ: a change of rank one for each spring.

    Attributes
    ----------
    pairs
        Pairs with this stiffness.
    columns, shapes : (n_spring, n_unknown)
        c and z.
    yields : (n_spring, n_spring) [length/force]
        M.
    """

    pairs: GluedPairs | SparsePairs
    columns: Matrix
    shapes: Matrix
    yields: Matrix

    def taken(self, elongations: Vector) -> Vector:
        """Return initial forces M⁻¹ e (n_spring,) for elongations e."""
        return np.asarray(np.linalg.solve(self.yields, elongations), dtype=float)


@dataclass(frozen=True, eq=False, kw_only=True)
class YieldingContact(BetweenSolver):
    """Solver of contact problems of one structure whose contact points all yield.

    Attributes
    ----------
    pairs
        The linear systems of Newton steps.
    shapes : (n_relative, rank) or None
        Y of a singular S = Y Yᵀ: the unknowns are then q of y = y_f + Y q, with the identity for
        Σ and G Y for G.
    otherwise
        Solver used where Newton's method does not converge.
    """

    pairs: GluedPairs | SparsePairs
    shapes: Matrix | None = None
    otherwise: IncrementSolver | None = None

    @classmethod
    def of(
        cls,
        contact: Contact,
        between: BetweenPairs,
        pressed: Pressed = None,
        otherwise: IncrementSolver | None = None,
    ) -> "YieldingContact":
        """Return the solver of a structure; ``pressed`` is as in :meth:`.GluedPairs.of`.

        Raises
        ------
        LinAlgError
            If points are so stiff that displacements have too few digits for their forces.
        """
        springs = LawsAtPoints(contact=contact).springs
        solver = cls.on_springs(contact, between, springs, pressed)
        if solver.shapes is None:
            stiffness = solver.pairs.points.of_diagonal(springs).diagonal()
            stiff = stiffness > STIFFEST * solver.pairs.own_stiffness
        else:
            stiff = springs.ravel() * solver._moved_singly > STIFFEST
        if stiff.any():
            message = "contact is far stiffer than the structure"
            raise LinAlgError(message)
        return replace(solver, otherwise=otherwise)

    @classmethod
    def on_springs(
        cls, contact: Contact, between: BetweenPairs, springs: Matrix, pressed: Pressed = None
    ) -> "YieldingContact":
        """Return the solver for points on springs (components, n_point) of any stiffness."""
        try:
            pairs = between.on_springs(contact.rows, springs, pressed)
        except LinAlgError:
            # Rigid bodies, or a basis of fewer modes than pairs.
            shapes = between.spanned()
            G = np.asarray(contact.rows @ shapes)
            few = GluedPairs.of(G, springs, ByCompliance(np.eye(shapes.shape[1])))
            return cls(contact=contact, between=between, pairs=few, shapes=shapes)
        return cls(contact=contact, between=between, pairs=pairs)

    def about(self, state: Increment) -> "YieldingContact":
        """Return a solver for many increments about a state, whose closed points stick.

        Notes
        -----
        n³ multiplications for n relative displacements. It reduced the time of increments of a
        flange to 0.6.
        """
        closed = state.forces[0] > 0
        if not closed.any():
            return self
        return replace(self, pairs=self.pairs.about(self.laws.springs * closed))

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one problem; see :meth:`.IncrementSolver.solve`.

        Notes
        -----
        Solved in stages where Newton's method does not converge: if a body slides far as a whole,
        tangential forces turn by more than a step can follow.
        """
        check_gaps(free)
        try:
            increment = self._solve_on(self.pairs, free, offset, start)
            moved = displaced(self, free, increment.forces)
            if self._differ(increment, moved):
                increment = self._about(increment, moved, offset, start)
                moved = displaced(self, free, increment.forces)
        except ConvergenceError:
            if self.otherwise is None or self.contact.remembers:
                raise
            return self.otherwise.solve(free, offset, start)
        return replace(increment, moved=moved)

    def loosened(self, springs: ForcedSprings) -> "LoosenedContact":
        """Return the solver with springs of prescribed force."""
        return LoosenedContact(solver=self, springs=springs)

    def coordinates(self, moved: Matrix) -> Matrix:
        """Return the unknowns for displacements of the pairs (n_relative,) or (n_relative, k)."""
        if self.shapes is None:
            return moved
        return np.asarray(np.linalg.lstsq(self.shapes, moved)[0], dtype=float)

    def across(self, springs: ForcedSprings) -> Across:
        """Return the pairs without the springs of prescribed force."""
        columns = self.coordinates(springs.columns.T).T
        shapes = np.array([self.pairs.resisted(column) for column in columns])
        shapes = shapes.reshape(columns.shape)
        yields = springs.yields + columns @ shapes.T
        pairs = self.pairs.loosened(shapes, yields) if len(columns) else self.pairs
        return Across(pairs=pairs, columns=columns, shapes=shapes, yields=yields)

    def _differ(self, increment: Increment, moved: Vector) -> bool:
        """Return whether displacements (n_relative,) are others than those of an increment.

        By more at a point than a force would move it that is what may remain of an increment.
        """
        apart = np.abs(self.contact.rows @ (increment.moved - moved))
        largest = np.abs(increment.forces).max(initial=0.0)
        return bool((apart > SOLVED * largest * self._moved_singly).any())

    @cached_property
    def _moved_singly(self) -> Vector:
        """Compliance of each row (n_row,) [length/force] if each pair moved alone."""
        if self.shapes is None:
            return moved_singly(self.contact.rows, self.between)
        return np.asarray(np.square(self.contact.rows @ self.shapes).sum(axis=1))

    def _about(
        self, increment: Increment, moved: Vector, offset: Matrix, start: Increment | None
    ) -> Increment:
        """Return the solution about the forces of an increment, which move the pairs by ``moved``.

        Σ y then has the digits of what is left: with ill-conditioned S it lacks some of the whole.
        """
        p = self.contact.at_pairs(increment.forces[0], increment.forces[1:])
        pull = p if self.shapes is None else self.shapes.T @ p
        nothing = np.zeros(len(pull))
        about = replace(increment, moved=nothing, deepest=None if start is None else start.deepest)
        offset = offset + self.contact.moved(moved)
        further = solve_yielding(self.laws, self.pairs, nothing, offset, about, pull=pull)
        return replace(further, iterations=increment.iterations + further.iterations)

    def _solve_on(
        self,
        pairs: GluedPairs | SparsePairs,
        free: Vector,
        offset: Matrix,
        start: Increment | None,
        pull: Vector | None = None,
    ) -> Increment:
        """Return the solution for some pairs under a pull, all in their unknowns."""
        laws, shapes = self.laws, self.shapes
        inverse = self.moved_by if shapes is None else pairs.resisted  # Σ of q is one
        moved_by = inverse if pull is None else None
        if shapes is None:
            return solve_yielding(laws, pairs, free, offset, start, pull=pull, moved_by=moved_by)
        at_first = offset.copy()
        at_first[: laws.components] += (self.contact.rows @ free).reshape(-1, offset.shape[1])
        if start is not None and pull is None:
            pressed = self.contact.at_pairs(start.forces[0], start.forces[1:])
            start = replace(start, moved=shapes.T @ pressed)
        elif start is not None:
            # Spring forces displace the pairs too, and support parts that nothing else holds.
            start = replace(start, moved=self.coordinates(start.moved - free))
        nothing = np.zeros(shapes.shape[1])
        found = solve_yielding(laws, pairs, nothing, at_first, start, pull=pull, moved_by=moved_by)
        return replace(found, moved=free + shapes @ found.moved)


@dataclass(frozen=True, eq=False, kw_only=True)
class LoosenedContact:
    """Compliant contact with springs of prescribed force (T1)."""

    solver: YieldingContact
    springs: ForcedSprings

    @cached_property
    def _across(self) -> Across:
        return self.solver.across(self.springs)

    @cached_property
    def _otherwise(self) -> ForcedContact | None:
        solver = self.solver.otherwise
        return None if solver is None else solver.loosened(self.springs)

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Solve one increment; see :meth:`.ForcedContact.solve`."""
        check_gaps(free)
        across = self._across
        pull = across.shapes.T @ across.taken(elongations)
        try:
            increment = self.solver._solve_on(across.pairs, free, offset, start, pull)
        except ConvergenceError:
            if self._otherwise is None or self.solver.contact.remembers:
                raise
            return self._otherwise.solve(free, offset, elongations, about, start)
        moved = self.solver.coordinates(increment.moved - free)
        return increment, across.taken(elongations - across.shapes @ moved)


def moved_singly(rows: SparseMatrix, between: BetweenPairs) -> Vector:
    """Return the compliance of each row (n_row,) [length/force] if each pair moved alone."""
    try:
        own = between.own_stiffness
    except LinAlgError:
        return np.asarray(np.square(rows @ between.spanned()).sum(axis=1))
    return np.asarray(rows.multiply(rows) @ (1.0 / own))
