"""Quadrature points of segments on the facets of either side."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix
from faying.interface.facets import Rule, shape_functions, shape_gradients
from faying.interface.inverse_map import reference_coordinates
from faying.interface.segments import Segments
from faying.model.elements import FACES


@dataclass(frozen=True, eq=False, kw_only=True)
class FacetPoints:
    """Points on facets of one kind.

    Attributes
    ----------
    kind
    places : (n, n_q, 2)
        Reference coordinates.
    local : (n, n_node_per_face, 3) [length]
        Nodes of the facet in the frame of the minus facet.
    shape : (n, n_q, n_node_per_face)
        Shape functions.
    """

    kind: str
    places: Matrix
    local: Matrix
    shape: Matrix

    @property
    def linear(self) -> Matrix:
        """Shape functions of the corners alone (n, n_q, 3 or 4)."""
        return (
            self.shape
            if FACES[self.kind].linear == self.kind
            else _shapes_at(FACES[self.kind].linear, self.places)
        )

    @property
    def heights(self) -> Matrix:
        """Height over the plane of the minus facet (n, n_q) [length]."""
        return np.asarray(np.einsum("nqa,na->nq", self.shape, self.local[..., 2]))

    @property
    def area_vectors(self) -> Matrix:
        """Area vectors per area in the plane (n, n_q, 3), in the frame of the minus facet."""
        flat = self.places.reshape(-1, 2)
        gradients = shape_gradients(self.kind, flat).reshape(*self.shape.shape, 2)
        tangents = np.einsum("nqaj,nad->jnqd", gradients, self.local)
        vectors = np.cross(tangents[0], tangents[1])
        return vectors / vectors[..., 2:]


def on_side(
    side: str, kind: str, nodes: Matrix, segments: Segments, rows: Indices, rule: Rule
) -> FacetPoints:
    """Return the quadrature points of triangles ``rows`` on the facets of one side.

    The side is ``"minus"`` or ``"plus"``, the kind that of its facets under these triangles, the
    rule one of triangles; nodes are (n_node, 3) [length].

    Raises
    ------
    ModelError
        If a facet folds over itself.
    """
    minus_rows = segments.minus_of[rows]
    facets, rows_on_side = {
        "minus": (segments.minus, minus_rows),
        "plus": (segments.plus, segments.plus_of[rows]),
    }[side]
    corners = shape_functions("tri3", rule.points)
    points = np.einsum("qi,nid->nqd", corners, segments.triangles[rows])
    away = (
        nodes[facets.nodes[rows_on_side, : FACES[kind].n_nodes]]
        - segments.origins[minus_rows][:, None]
    )
    local = np.einsum("nkd,nad->nka", away, segments.frames[minus_rows])
    places = reference_coordinates(kind, local[..., :2], points)
    return FacetPoints(kind=kind, places=places, local=local, shape=_shapes_at(kind, places))


def _shapes_at(kind: str, places: Matrix) -> Matrix:
    return shape_functions(kind, places.reshape(-1, 2)).reshape(*places.shape[:2], -1)
