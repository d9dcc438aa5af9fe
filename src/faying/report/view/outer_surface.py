"""The outer surface of the solids, its sharp edges, and the exploded view of bodies."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix
from faying.interface.surface import ContactSurface
from faying.model.elements import FACES
from faying.model.mesh import Mesh

SHARP = np.cos(np.radians(30.0))
"""Cosine of the angle between facets below which their common edge is drawn."""


@dataclass(frozen=True, eq=False, kw_only=True)
class OuterSurface:
    """The outer surface of the solids.

    Attributes
    ----------
    nodes : (n,)
        Nodes of the mesh on the surface, in the order of their first triangle.
    triangles : (n_triangle, 3)
        Indices of ``nodes``, counter-clockwise seen from outside.
    edges : (n_edge, 2)
        Indices of ``nodes``: edges at the boundary, or between triangles at an angle.
    """

    nodes: Indices
    triangles: Indices
    edges: Indices

    def outline(self, more: Indices) -> "OuterSurface":
        """Return only the edges, with their nodes and more nodes of the mesh."""
        outline_nodes, inverse = np.unique(
            np.concatenate([self.nodes[self.edges].ravel(), np.ravel(more)]), return_inverse=True
        )
        return OuterSurface(
            nodes=outline_nodes,
            triangles=np.empty((0, 3), dtype=np.int64),
            edges=inverse.ravel()[: self.edges.size].reshape(-1, 2),
        )


def outer_surface(mesh: Mesh, more: Indices) -> OuterSurface:
    """Return the outer surface of the solids of a mesh, with more nodes of the mesh."""
    faces = mesh.exterior.by_kind()
    parts = [triangles_of(kind, nodes) for kind, nodes in faces.items()]
    triangles = np.concatenate([*parts, np.empty((0, 3), dtype=np.int64)])
    nodes, first, inverse = np.unique(
        np.concatenate([triangles.ravel(), np.ravel(more)]), return_index=True, return_inverse=True
    )
    order = np.argsort(first)
    position = np.empty(len(order), dtype=np.int64)
    position[order] = np.arange(len(order))
    corners = position[inverse.ravel()[: triangles.size]].reshape(-1, 3)
    return OuterSurface(
        nodes=nodes[order], triangles=corners, edges=sharp_edges(mesh.nodes[nodes[order]], corners)
    )


def triangles_of(kind: str, facets: Indices) -> Indices:
    """Return triangles (n, 3) of facets of a kind (n_facet, at least n_node_per_face)."""
    return np.asarray(facets)[:, np.array(FACES[kind].triangles)].reshape(-1, 3)


def sharp_edges(points: Matrix, triangles: Indices) -> Indices:
    """Return the edges (n_edge, 2) at the boundary of a surface, or with a turn above 30°."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0, length, 1.0)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort(edges.T[::-1])
    edges, owner = edges[order], owner[order]
    fresh = np.ones(len(edges), dtype=bool)
    fresh[1:] = (edges[1:] != edges[:-1]).any(axis=1)
    starts = np.flatnonzero(fresh)
    counts = np.diff(np.append(starts, len(edges)))
    smooth = np.zeros(len(starts), dtype=bool)
    two = counts == 2
    pair = starts[two]
    turn = np.einsum("ij,ij->i", normals[owner[pair]], normals[owner[pair + 1]])
    smooth[two] = turn > SHARP
    return edges[starts[~smooth]]


def explosion(interfaces: Mapping[str, ContactSurface], body: Indices) -> Matrix:
    """Return a displacement (n_body, 3) of each body, so that every interface opens by one.

    Least squares over the interfaces, with zero mean of the bodies. An interface whose normals
    cancel, or that has one body only, is ignored. ``body`` (n_node,) is the number of each node's
    body, -1 without a body.
    """
    n_body = int(body.max(initial=-1)) + 1
    rows, directions = [], []
    for record in interfaces.values():
        total = float(record.weights.sum())
        if not len(record.pairs) or total <= 0:
            continue
        normal = record.weights @ record.normals / total
        minus, plus = (int(np.bincount(body[side] + 1).argmax()) - 1 for side in record.pairs.T)
        # Normals cancel where an interface is closed, like a pin in its hole.
        if minus == plus or min(minus, plus) < 0 or np.linalg.norm(normal) < 0.1:
            continue
        row = np.zeros(n_body)
        row[[minus, plus]] = -1.0, 1.0
        rows.append(row)
        directions.append(normal / np.linalg.norm(normal))
    if not rows:
        return np.zeros((n_body, 3))
    # The shortest solution keeps the mean place of every connected group of bodies.
    return np.asarray(np.linalg.lstsq(np.array(rows), np.array(directions), rcond=None)[0])
