"""Models whose static contact problem is itself reduced; everything else is the model's own."""

from copy import copy
from dataclasses import dataclass
from typing import NoReturn, TypeVar

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.condensed import ContactSolver
from faying.contact.contact import Contact
from faying.contact.forces import ContactForces
from faying.contact.state import ContactState
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel

AnyModel = TypeVar("AnyModel", Model, ReducedModel)


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedContact:
    """What contact problems with forces from a reduced set have in common.

    Attributes
    ----------
    contact
        Gap operator and law of all contact points.
    flexibility : (n_point, n_point)
        H of all contact points.
    """

    contact: Contact
    flexibility: Matrix

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) for relative displacements (..., n_relative) without λ."""
        return self.contact.free_gap(relative_displacement)

    def answered(
        self, forces: Vector, free_gap: Vector, iterations: int
    ) -> tuple[ContactForces, ContactState]:
        """Return forces with the slack that they leave, which need not fit them."""
        solved = ContactForces(
            forces=forces,
            slack=self.flexibility @ forces + free_gap,
            active=forces > 0,
            iterations=iterations,
        )
        return solved, ContactState(active=solved.active)

    @property
    def frictional(self) -> NoReturn:
        """Refuse: reduced sets of normal forces know no tangential ones."""
        message = (
            "a reduced set of normal contact forces (DEIM, force bases) knows no friction; take "
            "another method"
        )
        raise ModelError(message)

    @property
    def increments(self) -> NoReturn:
        """Refuse, as :attr:`frictional`."""
        _ = self.frictional
        raise AssertionError

    @property
    def cases(self) -> None:
        """None: forces are found among the reduced set alone."""

    def gap(self, solution: ContactForces) -> Vector:
        """Gap (n_point,) of a solution, which need not fit the forces where the set is poor."""
        return np.asarray(solution.slack - self.contact.flexibility * solution.forces)


def with_static_contact(model: AnyModel, static_contact: ContactSolver) -> AnyModel:
    """Return a copy that solves static contact with forces from a reduced set.

    The model, full or reduced with residual compliance, gives the compliance; the forces of the
    reduced problem are those of all contact points.
    """
    model_copy = copy(model)
    # What a model forms on first use and keeps is given to the copy instead.
    vars(model_copy)["static_contact"] = static_contact
    return model_copy
