"""Smoothing of a pressure field: averaged to the nodes and interpolated to the contact points.

The change shows what the mesh does not resolve. It is negligible where the field is linear over a
few facets; where the field bends, ends or has an edge it is about as large as the mesh error.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.interface.averaging import averaging_operator, facet_columns
from faying.interface.contact_points import joined, on_facets
from faying.interface.facets import gauss_rule
from faying.interface.interface import Interface


@dataclass(frozen=True, eq=False, kw_only=True)
class Smoothing:
    """Averaging to the pairs, and interpolation to the points.

    Attributes
    ----------
    average : (n_pair, n_point)
    read : (n_point, n_pair)
    """

    average: SparseMatrix
    read: SparseMatrix

    @classmethod
    def of(cls, interface: Interface, nodes: Matrix) -> "Smoothing":
        """Return the smoothing of an interface, with the coordinates of all nodes (n_node, 3)."""
        faces = [(f.kind, facet_columns(interface.pairs, f.minus, f.plus)) for f in interface.faces]
        average = interface.averaging
        if interface.quadrature == "nodal":
            # With nodal points an average is the value itself, so Gauss points come in between.
            shape, weights = _at_gauss_points(interface, faces, nodes)
            average = averaging_operator(shape, weights, faces) @ shape @ average
        return cls(
            average=sp.csr_array(average),
            read=sp.csr_array(interface.point_shape),
        )

    def smoothed(self, pressure: Vector) -> Vector:
        """Return a pressure (n_point,) after averaging and interpolation, never negative."""
        return np.asarray(np.maximum(self.read @ (self.average @ pressure), 0.0))


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
