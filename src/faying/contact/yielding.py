"""Contact of points that yield: the solver of one structure, for displacements."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast, final

import numpy as np
from scipy.linalg import LinAlgError, lapack

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import BetweenPairs, ByCompliance, BySubstitution
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
        pressed: Callable[[], Vector | None] | None = None,
    ) -> "YieldingContact":
        """Return the solver of a structure; what is pressed is as of :meth:`.GluedPairs.of`.

        Raises
        ------
        LinAlgError
            If points are so stiff that displacements have too few digits to tell forces.
        """
        springs = LawsAtPoints(contact=contact).springs
        if isinstance(between, BySubstitution):
            many = SparsePairs.of(contact.rows, springs, between.stiffness)
            glue = many.points.of_diagonal(springs).diagonal()
            _check_stiffness(glue, between.stiffness.diagonal)
            return cls(contact=contact, between=between, pairs=many)
        try:
            pairs = GluedPairs.of(contact.rows, springs, between, pressed)
        except LinAlgError:
            return cls._of_singular(contact, springs, between)
        _check_stiffness(pairs.glued.glue.diagonal(), np.diag(pairs.structure))
        return cls(contact=contact, between=between, pairs=pairs)

    @classmethod
    def _of_singular(
        cls, contact: Contact, springs: Matrix, between: BetweenPairs
    ) -> "YieldingContact":
        """Return the solver of rigid bodies, or of a basis of fewer modes than pairs."""
        shapes = _shapes(cast("Matrix", between.compliance))
        G = np.asarray(contact.rows @ shapes)
        _check_stiffness(springs.ravel() * (G * G).sum(axis=1), 1.0)
        pairs = GluedPairs.of(G, springs, ByCompliance(np.eye(shapes.shape[1])))
        return cls(contact=contact, between=between, pairs=pairs, shapes=shapes)

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        return cast("Matrix", self.between.compliance)

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
        except ConvergenceError:
            if self.contact.remembers or isinstance(self.pairs, SparsePairs):
                raise
            return FrictionalContact(contact=self.contact, S=self.S).solve(free, offset, start)
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
        identity = ByCompliance(cast("GluedPairs", self.pairs).structure)
        nothing = np.zeros(self.shapes.shape[1])
        return solve_yielding(
            self.laws, self.pairs, nothing, moved, start, moved_by=identity.moved_by
        )


def _check_stiffness(contact: Vector, structure: Vector | float) -> None:
    """Refuse contact that is far stiffer than the structure."""
    if (contact > STIFFEST * structure).any():
        message = "contact is far stiffer than the structure"
        raise LinAlgError(message)


def _shapes(S: Matrix) -> Matrix:
    """Return Y (n_relative, rank) with S = Y Yᵀ, by Cholesky with pivots."""
    factor, order, rank, _ = lapack.dpstrf(S, lower=1)
    shapes = np.zeros_like(factor)
    shapes[order - 1] = np.tril(factor)
    return np.ascontiguousarray(shapes[:, :rank])
