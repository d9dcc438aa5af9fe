"""A pressure field averaged to the nodes and read again at the contact points.

What that changes is what the mesh does not resolve: on a field that is linear over a few facets
next to nothing, where the field bends, ends or has an edge about as much as the mesh is off.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.interface.averaging import averaging_operator, facet_columns
from faying.interface.facets import gauss_rule, shape_functions, surface
from faying.interface.interface import Interface


@dataclass(frozen=True, eq=False, kw_only=True)
class Smoothing:
    """Averaging to the pairs, reading at the points, and which points are neighbours.

    Attributes
    ----------
    average : (n_pair, n_point)
    read : (n_point, n_pair)
    facets : (n_face, n_pair)
        One where a pair is a node of a facet.
    """

    average: SparseMatrix
    read: SparseMatrix
    facets: SparseMatrix

    @classmethod
    def of(cls, interface: Interface, nodes: Matrix) -> "Smoothing":
        """Return the smoothing of an interface.

        Parameters
        ----------
        nodes : (n_node, 3) [length]
            Coordinates of all nodes.
        """
        faces = [(f.kind, facet_columns(interface.pairs, f.minus, f.plus)) for f in interface.faces]
        average = interface.averaging
        if interface.quadrature == "nodal":
            # A node's average is then its own value, so the field is read at Gauss points first.
            shape, weights = _at_gauss_points(interface, faces, nodes)
            average = averaging_operator(shape, weights, faces) @ shape @ average
        return cls(
            average=sp.csr_array(average),
            read=sp.csr_array(interface.point_shape),
            facets=_incidence(faces, len(interface.pairs)),
        )

    def smoothed(self, pressure: Vector) -> Vector:
        """Return a pressure (n_point,) after averaging and reading; none is negative."""
        smooth: Vector = np.maximum(self.read @ (self.average @ pressure), 0.0)
        return smooth

    def around(self, point: int) -> Mask:
        """Return which points (n_point,) lie on the facets that touch the facets of one of them."""
        seen = sp.csr_array((self.read != 0).astype(float))
        own = np.asarray(seen[[point]].toarray()).ravel()
        pairs = self.facets.T @ (self.facets @ own > 0).astype(float) > 0
        near: Mask = seen @ (~pairs).astype(float) == 0
        return near


def _at_gauss_points(
    interface: Interface, faces: list[tuple[str, Indices]], nodes: Matrix
) -> tuple[SparseMatrix, Vector]:
    """Return shape functions (n, n_pair) and areas (n,) at the Gauss points of all facets."""
    shapes, areas = [], []
    for found, (kind, pairs) in zip(interface.faces, faces, strict=True):
        rule = gauss_rule(kind)
        values = shape_functions(kind, rule.points)
        n_face, (n_q, n_node) = len(pairs), values.shape
        rows = np.repeat(np.arange(n_face * n_q), n_node)
        columns = np.repeat(pairs[:, None, :], n_q, axis=1).ravel()
        entries = np.tile(values.ravel(), n_face)
        size = (n_face * n_q, len(interface.pairs))
        shapes.append(sp.csr_array((entries, (rows, columns)), shape=size))
        areas.append(surface(kind, nodes[found.minus], rule).areas.ravel())
    return sp.csr_array(sp.vstack(shapes)), np.concatenate(areas)


def _incidence(faces: list[tuple[str, Indices]], n_pair: int) -> SparseMatrix:
    rows = [
        sp.csr_array(
            (
                np.ones(pairs.size),
                pairs.ravel(),
                np.arange(0, pairs.size + 1, pairs.shape[1]),
            ),
            shape=(len(pairs), n_pair),
        )
        for _, pairs in faces
    ]
    return sp.csr_array(sp.vstack(rows))
