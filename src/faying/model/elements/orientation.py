"""Inverted solids: nodes in the order of the mirror image."""

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.linalg.pieces import pieces
from faying.model.elements import SOLIDS
from faying.model.elements.geometry import volume_factors
from faying.model.elements.solid_element import SolidElement, corner_gradients


def right_side_out(kind: str, nodes: Indices, places: Matrix) -> tuple[Indices, Mask]:
    """Return nodes with elements reversed whose every corner is inverted, and these elements.

    Some programs number in the other sense (MED), others accept either. Nodes are (n_cell, n_node),
    places (n, 3) [length]. Elements with only some inverted corners are not changed.
    """
    element = SOLIDS[kind]
    turned: Mask = np.zeros(len(nodes), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        for part in pieces(len(nodes), 9 * element.n_nodes):
            determinant = volume_factors(corner_gradients(element), places[nodes[part]])
            turned[part] = (determinant < 0).all(axis=0)
    if not turned.any():
        return nodes, turned
    return np.where(turned[:, None], nodes[:, _mirror_nodes(element)], nodes), turned


def _mirror_nodes(element: SolidElement) -> Indices:
    """Return the node at each node's image after exchange of the first two coordinates."""
    image = element.reference_nodes[:, [1, 0, 2]]
    distance = np.abs(element.reference_nodes[None] - image[:, None]).max(axis=2)
    return np.asarray(distance.argmin(axis=1), dtype=np.int64)
