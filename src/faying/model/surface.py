"""The surface of the solids: facets that belong to one element only, and whose they are."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faying._typing import Indices, Mask, Matrix, frozen
from faying.exceptions import ModelError
from faying.model.assembly import FaceSet
from faying.model.bodies import labelled
from faying.model.elements import SOLIDS
from faying.model.mesh import CellBlock, Mesh

N_NODES = {"tri3": 3, "quad4": 4, "tri6": 6, "quad8": 8}
"""Nodes of each facet kind; the numbers differ, so they also tell the kind."""

N_CORNERS = {"tri3": 3, "quad4": 4, "tri6": 3, "quad8": 4}

FACE_KINDS = {n: kind for kind, n in N_NODES.items()}
"""Facet kind by its number of nodes."""

LINEAR = {kind: FACE_KINDS[n] for kind, n in N_CORNERS.items()}
"""Facet kind of the corners alone: relative displacements between unlike meshes live there."""

WIDTH = max(N_NODES.values())


@dataclass(frozen=True, eq=False, kw_only=True)
class Facets:
    """Facets of all kinds in one table.

    Attributes
    ----------
    nodes : (n_facet, 8)
        Node indices, corners then mid-sides, counter-clockwise seen from outside; unused columns
        hold -1.
    elements, properties, bodies : (n_facet,)
        Owning element id, its property id and its body; -1 for a facet of no solid element.
    """

    nodes: Indices
    elements: Indices
    properties: Indices
    bodies: Indices

    def __post_init__(self) -> None:
        for name in ("nodes", "elements", "properties", "bodies"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))

    def __len__(self) -> int:
        """Return the number of facets."""
        return len(self.nodes)

    @property
    def corners(self) -> Indices:
        """Corner nodes (n_facet, 4); triangles repeat their last corner."""
        corners = self.nodes[:, :4].copy()
        corners[self.triangular, 3] = corners[self.triangular, 2]
        return corners

    @property
    def corner_keys(self) -> Indices:
        """Sorted corner nodes (n_facet, 4), equal for facets on the same corners; -1 fills up."""
        corners = self.nodes[:, :4].copy()
        corners[self.triangular, 3] = -1
        return np.sort(corners, axis=1)

    @property
    def triangular(self) -> Mask:
        """Whether each facet is a triangle."""
        return np.isin(self.counts, (N_NODES["tri3"], N_NODES["tri6"]))

    @property
    def counts(self) -> Indices:
        """Number of nodes of each facet."""
        counts: Indices = (self.nodes >= 0).sum(axis=1)
        return counts

    def by_kind(self) -> dict[str, "Facets"]:
        """Split the table by facet kind; kinds without facets are left out."""
        counts = self.counts
        split = {kind: self.taken(counts == n) for kind, n in N_NODES.items()}
        return {kind: facets for kind, facets in split.items() if len(facets)}

    def taken(self, chosen: Mask | Indices) -> "Facets":
        """Return the chosen facets."""
        return Facets(
            nodes=self.nodes[chosen],
            elements=self.elements[chosen],
            properties=self.properties[chosen],
            bodies=self.bodies[chosen],
        )

    def joined(self, other: "Facets") -> "Facets":
        """Return these facets followed by the other ones."""
        return Facets(
            nodes=np.concatenate([self.nodes, other.nodes]),
            elements=np.concatenate([self.elements, other.elements]),
            properties=np.concatenate([self.properties, other.properties]),
            bodies=np.concatenate([self.bodies, other.bodies]),
        )


def padded(nodes: Indices) -> Indices:
    """Widen facets of one kind (n_facet, n_node_per_face) to the table's columns."""
    return np.pad(nodes, ((0, 0), (0, WIDTH - nodes.shape[1])), constant_values=-1)


def exterior_facets(mesh: Mesh) -> Facets:
    """Find the facets that belong to one element only, and whose they are.

    Facets that touch another body count as exterior: bodies share no nodes.

    Parameters
    ----------
    mesh
        Solids of any kind, also mixed; a linear and a quadratic facet on the same corners count
        as one inner facet.

    Returns
    -------
    Facets
        Block by block, in the order of the elements' faces.

    Raises
    ------
    ModelError
        If the mesh holds an unknown kind of element.

    Notes
    -----
    One sort of all facets of the mesh, once for meshes of the same cells.
    """
    return _exterior(mesh.blocks, len(mesh.nodes))


@lru_cache(maxsize=1)
def _exterior(blocks: tuple[CellBlock, ...], n_node: int) -> Facets:
    keys, kinds = [np.empty((0, 4), dtype=np.int64)], []
    for block in blocks:
        if block.kind not in SOLIDS:
            message = f"there is no solid element '{block.kind}'; known: {', '.join(SOLIDS)}"
            raise ModelError(message)
        for _, local in SOLIDS[block.kind].faces:
            corners = list(local[: 4 if len(local) in (4, 8) else 3])
            key = np.full((len(block.ids), 4), -1, dtype=np.int64)
            key[:, : len(corners)] = block.nodes[:, corners]
            key.sort(axis=1)
            keys.append(key)
            kinds.append((block, list(local)))
    _, inverse, counts = unique_rows(np.concatenate(keys))
    alone = np.split(counts[inverse] == 1, np.cumsum([len(key) for key in keys])[1:-1])
    tables, elements, properties = [np.empty((0, WIDTH), dtype=np.int64)], [], []
    for (block, columns), chosen in zip(kinds, alone, strict=True) if kinds else ():
        tables.append(padded(block.nodes[chosen][:, columns]))
        elements.append(block.ids[chosen])
        properties.append(block.properties[chosen])
    nodes = np.concatenate(tables)
    nothing = np.empty(0, dtype=np.int64)
    return Facets(
        nodes=nodes,
        elements=np.concatenate([nothing, *elements]),
        properties=np.concatenate([nothing, *properties]),
        bodies=labelled(blocks, n_node)[nodes[:, 0]],
    )


def exterior_faces(mesh: Mesh) -> tuple[FaceSet, ...]:
    """Return the facets of :func:`exterior_facets`, one face set per kind present."""
    return tuple(
        FaceSet(kind=kind, nodes=facets.nodes[:, : N_NODES[kind]])
        for kind, facets in exterior_facets(mesh).by_kind().items()
    )


def unique_rows(rows: Indices) -> tuple[Indices, Indices, Indices]:
    """Return the first position of each distinct row, each row's group, and the group sizes.

    Groups are in the order of their rows, the first column first.
    """
    keys = _packed(rows)
    order = np.lexsort(keys[::-1])
    new = np.ones(len(rows), dtype=bool)
    new[1:] = np.any([np.diff(key[order]) != 0 for key in keys], axis=0)
    inverse = np.empty(len(rows), dtype=np.int64)
    inverse[order] = np.cumsum(new) - 1
    start = np.flatnonzero(new)
    return order[start], inverse, np.diff(start, append=len(rows))


def _packed(rows: Indices) -> list[Indices]:
    """Return as few whole numbers for each row as order the rows as their columns do."""
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
    centres: Matrix = np.einsum("fc,fcd->fd", weights, nodes[facets.corners])
    return centres


def facet_area_vectors(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the area vectors (n_facet, 3) [length²] spanned by the corners of facets."""
    corners = nodes[facets.corners]
    # Half the cross product of the diagonals; with the last corner repeated it is the triangle's.
    vectors: Matrix = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return vectors


def facet_normals(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the unit outward normals (n_facet, 3) of facets, taken from their corners."""
    vectors = facet_area_vectors(nodes, facets)
    normals: Matrix = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return normals


def facet_frames(nodes: Matrix, facets: Facets) -> Matrix:
    """Two tangents, the first along the longest edge, and the normal of each facet (n, 3, 3)."""
    corners, normals = nodes[facets.corners], facet_normals(nodes, facets)
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(edges, axis=2).argmax(axis=1)
    first = edges[np.arange(len(edges)), longest]
    first = first - np.einsum("nd,nd->n", first, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first), normals], axis=1)
