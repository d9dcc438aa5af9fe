"""Joint modes without simulations: trial vector derivatives."""

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.pod import pod


def trial_vector_derivatives(
    model: Model,
    *,
    normal_modes: int = 20,
    joint_modes: int = 20,
    classic: Basis | None = None,
) -> Basis:
    """Extend the classic basis by the derivatives of its vectors through the contact.

    Differentiating the static balance K φ_i(q) = Gᵀ w p(G Φ q) by the coordinates q gives, for any
    local law p(g), K ∂φ_i/∂q_j = Gᵀ w p″ (Gφ_i)(Gφ_j): the second derivatives of the contact
    forces are products of the gaps of two trial vectors, point by point. Their amplitudes and p″
    are not known in advance, so every trial vector enters with a gap of unit root mean square. The
    static shapes of all products, with the boundary held, are compressed by a POD with W = K.

    Trial vector derivatives as joint modes are due to Witteveen & Pichler (Shock and Vibration,
    2014) and Pichler, Witteveen & Fischer (Multibody System Dynamics 40, 2017,
    doi:10.1007/s11044-016-9555-2), after the modal derivatives of Idelsohn & Cardona (Computer
    Methods in Applied Mechanics and Engineering 49, 1985). The scaling is not from these papers.

    Parameters
    ----------
    normal_modes, joint_modes
        Numbers of vectors.
    classic
        Result of :func:`craig_bampton` if it has been computed.

    Raises
    ------
    ModelError
        If no vector of the classic basis moves the two sides of an interface apart.

    Notes
    -----
    n (n + 1)/2 products of n classic vectors; the POD works in the compliance between contact
    pairs with the boundary held, so only ``joint_modes`` back-substitutions follow.
    """
    start = craig_bampton(model, normal_modes=normal_modes) if classic is None else classic
    structure, contact = model.structure, model.contact
    products = contact.weights[:, None] * _gap_products(model, start)
    at_pairs = contact.interpolation.T @ products
    patterns = pod(at_pairs, inner=structure.held_compliance, count=joint_modes).vectors
    shapes = structure.solve_held(structure.relative_operator.T @ patterns)
    joint = Basis(vectors=shapes, kinds=(ModeKind.JOINT,) * shapes.shape[1])
    return (start + joint).orthonormalized(structure.supported_stiffness)


def _gap_products(model: Model, basis: Basis) -> Matrix:
    """Return products of the gaps of all pairs of trial vectors (n_point, n_product)."""
    contact = model.contact
    gaps = contact.interpolation @ (contact.relative_operator @ basis.vectors)
    size = np.sqrt(contact.weights @ gaps**2 / contact.weights.sum())
    significant = size > 1e-9 * size.max(initial=0.0)
    if not significant.any():
        message = "no vector of the classic basis opens or closes an interface; add normal modes"
        raise ModelError(message)
    unit = gaps[:, significant] / size[significant]
    first, second = np.triu_indices(unit.shape[1])
    return np.asarray(unit[:, first] * unit[:, second])
