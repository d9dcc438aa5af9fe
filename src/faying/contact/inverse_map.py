"""Reference coordinates of points that are given in the plane of a facet."""

import numpy as np

from faying._typing import Matrix
from faying.contact.facets import shape_functions, shape_gradients
from faying.exceptions import ModelError
from faying.model.surface import N_CORNERS

_LIMIT = 25
"""Newton steps; a parallelogram takes one, a distorted facet four or five."""

_CLOSE = 1e-13
"""Step in reference coordinates that ends the iteration."""


def reference_coordinates(kind: str, nodes: Matrix, points: Matrix) -> Matrix:
    """Find where on facets points are, seen along one direction.

    Parameters
    ----------
    kind
        ``"tri3"``, ``"tri6"``, ``"quad4"`` or ``"quad8"``.
    nodes : (n, n_node_per_face, 2) [length]
        Nodes projected onto a plane.
    points : (n, n_q, 2) [length]
        Points in that plane.

    Returns
    -------
    ndarray (n, n_q, 2)
        Near a curved side they may lie a little outside of the reference facet.

    Raises
    ------
    ModelError
        If the facet folds over itself seen along that direction.

    Notes
    -----
    Newton's method on all points at once, from the affine map of three corners.
    """
    corner = 2 if N_CORNERS[kind] == 3 else 3
    affine = np.stack([nodes[:, 1] - nodes[:, 0], nodes[:, corner] - nodes[:, 0]], axis=-1)
    place: Matrix = np.einsum("nij,nqj->nqi", np.linalg.inv(affine), points - nodes[:, None, 0])
    if kind == "tri3":
        return place
    for _ in range(_LIMIT):
        flat = place.reshape(-1, 2)
        shape = shape_functions(kind, flat).reshape(*place.shape[:2], -1)
        gradients = shape_gradients(kind, flat).reshape(*place.shape[:2], -1, 2)
        missing = points - np.einsum("nqa,nad->nqd", shape, nodes)
        tangents = np.einsum("nqaj,nad->nqdj", gradients, nodes)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = _solved(tangents, missing)
        place = place + step
        if not np.isfinite(place).all():
            break
        if np.abs(step).max(initial=0.0) < _CLOSE:
            return place
    largest = 1e3 * _CLOSE
    if np.isfinite(place).all() and np.abs(step).max() < largest:
        return place
    row = int(np.nan_to_num(np.abs(step), nan=np.inf).max(axis=(1, 2)).argmax())
    message = (
        f"a {kind} facet of {np.ptp(nodes[row], axis=0).max():g} in size folds over itself where "
        "the other side lies on it; repair the mesh there"
    )
    raise ModelError(message)


def _solved(tangents: Matrix, right: Matrix) -> Matrix:
    """Solve 2 × 2 systems (n, n_q, 2, 2) by Cramer's rule."""
    (a, b), (c, d) = np.moveaxis(tangents, (-2, -1), (0, 1))
    x, y = np.moveaxis(right, -1, 0)
    solution: Matrix = (
        np.stack([d * x - b * y, a * y - c * x], axis=-1) / (a * d - b * c)[..., None]
    )
    return solution
