"""Models whose static contact problem is itself reduced; everything else is the model's own."""

from copy import copy
from typing import TypeVar

from faying.contact.condensed import ContactSolver
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel

AnyModel = TypeVar("AnyModel", Model, ReducedModel)


def with_static_contact(model: AnyModel, static_contact: ContactSolver) -> AnyModel:
    """Return a copy that solves static contact with forces from a reduced set.

    Parameters
    ----------
    model
        Gives the compliance: the full model, or a reduced one with residual compliance.
    static_contact
        The reduced contact problem; its forces are those of all contact points.
    """
    made = copy(model)
    # What a model forms on first use and keeps is given to the copy instead.
    vars(made)["static_contact"] = static_contact
    return made
