"""Contact of points that yield: the solver of one structure, for displacements."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import BetweenPairs, ByCompliance, Pressed
from faying.contact.contact import Contact
from faying.contact.frictional import FrictionalContact
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import Increment, displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_descent import solve_yielding
from faying.contact.sparse_pairs import SparsePairs
from faying.exceptions import ConvergenceError, ModelError

STIFFEST = 1e4
"""Stiffness of contact at a pair over the structure's up to which displacements tell forces.

At 10 E/h it is about ten; at 1e8 gaps were off by a quarter of themselves.
"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class YieldingContact:
    """Solver of contact problems of one structure whose contact points all yield.

    Attributes
    ----------
    contact
        Gaps, tangential displacements and laws.
    between
        Structure between pairs.
    pairs
        The linear systems of Newton steps.
    shapes : (n_relative, rank) or None
        Y of a singular S = Y Yᵀ: the unknowns are then q of y = y_f + Y q, whose Σ is one and G
        is G Y.
    """

    contact: Contact
    between: BetweenPairs
    pairs: GluedPairs | SparsePairs
    shapes: Matrix | None = None

    @classmethod
    def of(
        cls,
        contact: Contact,
        between: BetweenPairs,
        pressed: Pressed = None,
    ) -> "YieldingContact":
        """Return the solver of a structure; what is pressed is as of :meth:`.GluedPairs.of`.

        Raises
        ------
        LinAlgError
            If points are so stiff that displacements have too few digits to tell forces.
        """
        springs = LawsAtPoints(contact=contact).springs
        try:
            pairs = between.on_springs(contact.rows, springs, pressed)
        except LinAlgError:
            return cls._of_singular(contact, springs, between)
        _check_stiffness(pairs.points.of_diagonal(springs).diagonal(), pairs.own_stiffness)
        return cls(contact=contact, between=between, pairs=pairs)

    @classmethod
    def _of_singular(
        cls, contact: Contact, springs: Matrix, between: BetweenPairs
    ) -> "YieldingContact":
        """Return the solver of rigid bodies, or of a basis of fewer modes than pairs."""
        shapes = between.spanned()
        G = np.asarray(contact.rows @ shapes)
        _check_stiffness(springs.ravel() * (G * G).sum(axis=1), 1.0)
        pairs = GluedPairs.of(G, springs, ByCompliance(np.eye(shapes.shape[1])))
        return cls(contact=contact, between=between, pairs=pairs, shapes=shapes)

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        return self.between.compliance

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        return self.between.moved_by(forces)

    @cached_property
    def laws(self) -> LawsAtPoints:
        """What the contact points answer."""
        return LawsAtPoints(contact=self.contact)

    def about(self, state: Increment) -> "YieldingContact":
        """Return the solver for many increments about a state, whose closed points stick.

        Notes
        -----
        n³ multiplications for n relative displacements; increments of a flange took 0.6 of the
        time.
        """
        closed = state.forces[0] > 0
        if not closed.any():
            return self
        return replace(self, pairs=self.pairs.about(self.laws.springs * closed))

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one problem; see :meth:`.IncrementSolver.solve`.

        Notes
        -----
        For displacements, and for forces where Newton's method goes astray there: a body that
        slides far as a whole turns tangential forces more than a step can tell, and points far
        stiffer than the structure leave displacements too few digits.
        """
        if not np.isfinite(free).all():
            message = "the gap without contact forces holds NaN or infinity; check loads and model"
            raise ModelError(message)
        try:
            increment = self._solved(free, offset, start)
        except ConvergenceError as error:
            if self.contact.remembers:
                raise
            try:
                S = self.S
            except ModelError:  # there is no room for it
                raise error from None
            return FrictionalContact(contact=self.contact, S=S).solve(free, offset, start)
        return replace(increment, moved=displaced(self, free, increment.forces))

    def _solved(self, free: Vector, offset: Matrix, start: Increment | None) -> Increment:
        if self.shapes is None:
            return solve_yielding(
                self.laws, self.pairs, free, offset, start, moved_by=self.moved_by
            )
        moved = offset.copy()
        moved[: self.laws.components] += (self.contact.rows @ free).reshape(-1, offset.shape[1])
        if start is not None:
            pressed = self.contact.at_pairs(start.forces[0], start.forces[1:])
            start = replace(start, moved=self.shapes.T @ pressed)
        nothing = np.zeros(self.shapes.shape[1])
        return solve_yielding(
            self.laws, self.pairs, nothing, moved, start, moved_by=self.pairs.resisted
        )


def _check_stiffness(contact: Vector, structure: Vector | float) -> None:
    """Refuse contact that is far stiffer than the structure."""
    if (contact > STIFFEST * structure).any():
        message = "contact is far stiffer than the structure"
        raise LinAlgError(message)
