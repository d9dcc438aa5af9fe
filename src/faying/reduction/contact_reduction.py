"""Models whose static contact forces are reduced; everything else is as in the whole model."""

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
    """Base class of contact problems with forces from a reduced set.

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
        """Contact laws at the points."""
        return self.whole.increments.laws

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] for forces p between the pairs."""
        return self.whole.between.moved_by(forces)

    def about(self, state: Increment) -> Self:  # noqa: ARG002
        """Return the solver itself."""
        return self

    @property
    def increments(self) -> IncrementSolver:
        """The solver itself, which seeks forces in the reduced set alone."""
        return self

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one case; forces and gaps contradict each other where the set is poor."""
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
        """Return contact forces (n_point,) for a free gap, and the number of linear systems solved.

        ``active`` are the points in contact in a similar case.
        """

    def loosened(self, springs: ForcedSprings) -> NoReturn:  # noqa: ARG002
        """Refuse: bolts are tightened in the whole model."""
        message = (
            "a reduced set of contact forces (DEIM, force bases) does not give the initial forces "
            "of bolts; tighten the whole model"
        )
        raise ModelError(message)

    @property
    def between(self) -> NoReturn:
        """Refuse: forces of a reduced set do not solve the contact between pairs."""
        message = (
            "contact forces of a reduced set (DEIM, force bases) do not solve the contact between "
            "pairs, which is needed here; take another method"
        )
        raise ModelError(message)


def with_static_contact(model: AnyModel, static_contact: ContactSolver) -> AnyModel:
    """Return a copy of a model whose static contact forces are of a reduced set.

    The model is full, or reduced with residual compliance, and gives the compliance; the solution
    has forces at all contact points.
    """
    model_copy = copy(model)
    # Replaces the contact problem that a model forms at first use.
    vars(model_copy)["static_contact"] = static_contact
    return model_copy
