"""Smoothing of a pressure field: averaged to the nodes and interpolated to the contact points.

The change shows what the mesh does not resolve. It is negligible where the field is linear over a
few facets; where the field bends, ends or has an edge it is about as large as the mesh error.
"""

import numpy as np

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.interface.averaging import averaging_operator, facet_columns
from faying.interface.contact_points import joined, on_facets
from faying.interface.facets import gauss_rule
from faying.interface.interface import Interface


def smoothing(interface: Interface, nodes: Matrix) -> SparseMatrix:
    """Return the matrix (n_point, n_point) that averages a pressure to the pairs and interpolates.

    It takes the coordinates of all nodes (n_node, 3).
    """
    faces = [(f.kind, facet_columns(interface.pairs, f.minus, f.plus)) for f in interface.faces]
    average = interface.averaging
    if interface.quadrature == "nodal":
        # With nodal points an average would be the value itself: Gauss points are averaged instead.
        shape, weights = _at_gauss_points(interface, faces, nodes)
        average = averaging_operator(shape, weights, faces) @ shape @ average
    return (interface.point_shape @ average).tocsr()


def _at_gauss_points(
    interface: Interface, faces: list[tuple[str, Indices]], nodes: Matrix
) -> tuple[SparseMatrix, Vector]:
    """Return shape functions (n, n_pair) and areas (n,) at the Gauss points of all facets."""
    parts = [
        on_facets(
            kind,
            nodes[faces_of_kind.minus],
            gauss_rule(kind),
            np.arange(len(pairs)),
            kind,
            pairs,
            len(interface.pairs),
        )
        for faces_of_kind, (kind, pairs) in zip(interface.faces, faces, strict=True)
    ]
    points = joined(parts)
    return points.shape, points.weights
