"""Joint modes of a toy method: answers to one even pressure on each interface."""

import numpy as np

from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind


def even_pressures(model: Model, *, joint_modes: int, classic: Basis) -> Basis:
    """Extend the classic basis by the answer to unit pressure on each of the first interfaces."""
    contact = model.contact
    pressures = np.zeros((contact.n_points, len(model.interfaces)))
    for column, name in enumerate(model.interfaces):
        pressures[contact.slices[name], column] = 1.0
    at_pairs = contact.interpolation.T @ (contact.weights[:, None] * pressures[:, :joint_modes])
    shapes = model.structure.solve_held(contact.relative_operator.T @ at_pairs)
    joint = Basis(vectors=shapes, kinds=(ModeKind.JOINT,) * shapes.shape[1])
    return (classic + joint).orthonormalized(model.K)
