"""Models whose static contact problem is itself reduced; everything else is the model's own."""

from abc import abstractmethod
from copy import copy
from dataclasses import dataclass
from typing import NoReturn, Self, TypeVar

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.contact.condensed import CondensedContact, ContactSolver
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import Increment, IncrementSolver, displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel

AnyModel = TypeVar("AnyModel", Model, ReducedModel)


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedContact:
    """What contact problems with forces from a reduced set have in common.

    Attributes
    ----------
    whole
        The contact problem of all contact points.
    """

    whole: CondensedContact

    @property
    def contact(self) -> Contact:
        """Gap operator and law of all contact points."""
        return self.whole.contact

    @property
    def flexibility(self) -> Matrix:
        """H (n_point, n_point) of all contact points."""
        return self.whole.flexibility

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        return self.whole.increments.S

    @property
    def laws(self) -> LawsAtPoints:
        """What the contact points answer."""
        return self.whole.increments.laws

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        return self.whole.between.moved_by(forces)

    def about(self, state: Increment) -> Self:  # noqa: ARG002
        """Return itself."""
        return self

    @property
    def increments(self) -> IncrementSolver:
        """Itself: forces are found among the reduced set alone."""
        return self

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one case; gaps need not fit the forces where the set is poor."""
        free_gap = self.contact.interpolation @ free + offset[0]
        active = None if start is None else start.forces[0] > 0
        forces, slack = np.zeros(offset.shape), np.zeros(offset.shape)
        forces[0], iterations = self.pressed(free_gap, active)
        slack[0] = self.flexibility @ forces[0] + free_gap
        return Increment(
            forces=forces,
            slack=slack,
            moved=displaced(self, free, forces),
            iterations=iterations,
            residual=0.0,
        )

    @abstractmethod
    def pressed(self, free_gap: Vector, active: Mask | None) -> tuple[Vector, int]:
        """Return the contact forces (n_point,) that a free gap calls up, and linear systems solved.

        Active points are those in contact of a similar case.
        """

    def loosened(self, springs: ForcedSprings) -> NoReturn:  # noqa: ARG002
        """Refuse: bolts are tightened in the whole model."""
        message = (
            "a reduced set of contact forces (DEIM, force bases) does not tell the initial forces "
            "of bolts; tighten the model that it was made of"
        )
        raise ModelError(message)

    @property
    def between(self) -> NoReturn:
        """Refuse: forces of a reduced set do not solve the contact between pairs."""
        message = (
            "contact forces of a reduced set (DEIM, force bases) do not solve the contact between "
            "pairs, which is asked for here; take another method"
        )
        raise ModelError(message)


def with_static_contact(model: AnyModel, static_contact: ContactSolver) -> AnyModel:
    """Return a copy that solves static contact with forces from a reduced set.

    The model, full or reduced with residual compliance, gives the compliance; the forces of the
    reduced problem are those of all contact points.
    """
    model_copy = copy(model)
    # What a model forms on first use and keeps is given to the copy instead.
    vars(model_copy)["static_contact"] = static_contact
    return model_copy
