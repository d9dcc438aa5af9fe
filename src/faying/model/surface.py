"""The surface of the solids: facets that belong to one element only, with their elements."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Indices, Mask, Matrix
from faying.model.elements import FACES

WIDTH = max(face.n_nodes for face in FACES.values())
"""Columns of a table of facets of all kinds."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Facets(Frozen):
    """Facets of all kinds in one table.

    Attributes
    ----------
    nodes : (n_facet, width)
        Node indices in the order of :class:`~faying.model.elements.face_kind.FaceKind`, as many
        columns as the largest kind needs; unused ones hold -1.
    elements, properties, bodies : (n_facet,)
        Id, property id and body of the element; -1 for a facet of no solid element.
    """

    nodes: Indices
    elements: Indices
    properties: Indices
    bodies: Indices

    def __len__(self) -> int:
        """Return the number of facets."""
        return len(self.nodes)

    @property
    def corners(self) -> Indices:
        """Corner nodes (n_facet, 4); triangles repeat their last corner."""
        return corner_nodes(self.nodes)

    @property
    def corner_keys(self) -> Indices:
        """Sorted corner nodes (n_facet, 4), equal for facets on the same corners."""
        return corner_keys(self.nodes)

    @property
    def triangular(self) -> Mask:
        """Whether each facet is a triangle."""
        return triangular(self.nodes)

    def by_kind(self) -> dict[str, Indices]:
        """Return the nodes (n, n_node_per_face) of the facets of each kind."""
        return nodes_by_kind(self.nodes)

    def taken(self, chosen: Mask | Indices) -> "Facets":
        """Return the chosen facets."""
        return Facets(
            nodes=self.nodes[chosen],
            elements=self.elements[chosen],
            properties=self.properties[chosen],
            bodies=self.bodies[chosen],
        )

    def positions(self, nodes: Indices) -> Indices:
        """Return the number of the facet with the corners of each row (n, width); -1 for none."""
        first, group, _ = unique_rows(np.concatenate([self.corner_keys, corner_keys(nodes)]))
        position: Indices = first[group[len(self) :]]
        return np.where(position < len(self), position, -1)

    def within(self, nodes: Indices) -> "Facets":
        """Return the facets with all nodes among the given indices."""
        inside = np.zeros(max(part.max(initial=-1) for part in (nodes, self.nodes)) + 2, dtype=bool)
        # The last entry is for unused columns (-1).
        inside[nodes] = inside[-1] = True
        return self.taken(np.asarray(inside[self.nodes].all(axis=1)))

    def joined(self, following: "Facets") -> "Facets":
        """Return these facets followed by others."""
        return Facets(
            nodes=np.concatenate([self.nodes, following.nodes]),
            elements=np.concatenate([self.elements, following.elements]),
            properties=np.concatenate([self.properties, following.properties]),
            bodies=np.concatenate([self.bodies, following.bodies]),
        )


def padded(nodes: Indices) -> Indices:
    """Return facets of one kind (n_facet, n_node_per_face) with all columns of a table."""
    return np.pad(nodes, ((0, 0), (0, WIDTH - nodes.shape[1])), constant_values=-1)


def rows_by_kind(nodes: Indices) -> dict[str, Indices]:
    """Return the rows of each kind of faces in a table of facets (n_facet, width).

    Kinds differ in their numbers of nodes; -1 fills unused columns.
    """
    counts = (nodes >= 0).sum(axis=1)
    rows = {kind: np.flatnonzero(counts == face.n_nodes) for kind, face in FACES.items()}
    return {kind: chosen for kind, chosen in rows.items() if len(chosen)}


def nodes_by_kind(nodes: Indices) -> dict[str, Indices]:
    """Return the facets (n, n_node_per_face) of each kind in a table (n_facet, width)."""
    rows = rows_by_kind(nodes)
    return {kind: nodes[chosen, : FACES[kind].n_nodes] for kind, chosen in rows.items()}


def triangular(nodes: Indices) -> Mask:
    """Return which facets of a table (n_facet, width) are triangles."""
    mask = np.zeros(len(nodes), dtype=bool)
    for kind, rows in rows_by_kind(nodes).items():
        mask[rows] = FACES[kind].n_corners == 3
    return mask


def corner_nodes(nodes: Indices) -> Indices:
    """Return the corners (n_facet, 4) of a table of facets; triangles repeat their last one."""
    triangles = triangular(nodes)[:, None]
    return np.where(triangles, nodes[:, [0, 1, 2, 2]], nodes[:, :4])


def corner_keys(nodes: Indices) -> Indices:
    """Return the sorted corners (n_facet, 4) of a table of facets; -1 fills up triangles."""
    corners = nodes[:, :4].copy()
    corners[triangular(nodes), 3] = -1
    return np.sort(corners, axis=1)


def unique_rows(rows: Indices) -> tuple[Indices, Indices, Indices]:
    """Return the first position of each distinct row, each row's group, and the group sizes.

    Groups are in the order of their rows, the first column first.
    """
    keys = _pack_rows(rows)
    order = np.lexsort(keys[::-1])
    new = np.ones(len(rows), dtype=bool)
    new[1:] = np.any([np.diff(key[order]) != 0 for key in keys], axis=0)
    inverse = np.empty(len(rows), dtype=np.int64)
    inverse[order] = np.cumsum(new) - 1
    start = np.flatnonzero(new)
    return order[start], inverse, np.diff(start, append=len(rows))


def _pack_rows(rows: Indices) -> list[Indices]:
    """Return the fewest integers for each row that sort rows as their columns do."""
    if not rows.size:
        return [np.zeros(len(rows), dtype=np.int64)]
    keys: list[Indices] = []
    room = 0
    for column in rows.T:
        low, high = int(column.min()), int(column.max())
        span = high - low + 1
        if span <= room:
            keys[-1] = keys[-1] * span + (column - low)
            room //= span
        else:
            keys.append(column - low)
            room = np.iinfo(np.int64).max // span
    return keys


def facet_centres(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the mean (n_facet, 3) of the corners of facets; ``nodes`` are coordinates."""
    # A triangle repeats its last corner, which must not count twice.
    triangle, square = np.array([1, 1, 1, 0]) / 3, np.full(4, 1 / 4)
    weights = np.where(facets.triangular[:, None], triangle, square)
    return np.asarray(np.einsum("fc,fcd->fd", weights, nodes[facets.corners]))


def facet_area_vectors(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the area vectors (n_facet, 3) [length²] spanned by the corners of facets."""
    corners = nodes[facets.corners]
    # Half the cross product of the diagonals, also for triangles, whose last corner is repeated.
    return 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])


def facet_normals(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the unit outward normals (n_facet, 3) of facets, taken from their corners."""
    vectors = facet_area_vectors(nodes, facets)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def facet_frames(nodes: Matrix, facets: Facets) -> Matrix:
    """Return two tangents, the first along the longest edge, and the normal (n, 3, 3)."""
    corners, normals = nodes[facets.corners], facet_normals(nodes, facets)
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(edges, axis=2).argmax(axis=1)
    first = edges[np.arange(len(edges)), longest]
    first = first - np.einsum("nd,nd->n", first, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first), normals], axis=1)
