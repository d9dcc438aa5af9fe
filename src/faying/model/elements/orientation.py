"""Solids that are inside out: the same nodes in the order of the mirror image."""

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.linalg.pieces import pieces
from faying.model.elements import SOLIDS
from faying.model.elements.geometry import volume_factors
from faying.model.elements.solid_element import SolidElement, corner_gradients


def right_side_out(kind: str, nodes: Indices, places: Matrix) -> tuple[Indices, Mask]:
    """Turn elements whose every corner is inside out.

    Some programs number the other way round (MED), others accept either. With the nodes (n_cell,
    n_node), at places (n, 3) [length], comes which elements (n_cell,) were inside out. Those that
    are at some corners only are left as they are.
    """
    element = SOLIDS[kind]
    turned: Mask = np.zeros(len(nodes), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        for part in pieces(len(nodes), 9 * element.n_nodes):
            determinant = volume_factors(corner_gradients(element), places[nodes[part]])
            turned[part] = (determinant < 0).all(axis=0)
    if not turned.any():
        return nodes, turned
    return np.where(turned[:, None], nodes[:, _mirrored(element)], nodes), turned


def _mirrored(element: SolidElement) -> Indices:
    """Place of each node's image where the first two reference coordinates change places."""
    image = element.reference_nodes[:, [1, 0, 2]]
    distance = np.abs(element.reference_nodes[None] - image[:, None]).max(axis=2)
    return np.asarray(distance.argmin(axis=1), dtype=np.int64)
