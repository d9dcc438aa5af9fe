"""Search distances of declared contact surfaces, and the visibility of their facets."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.exceptions import refuse_model
from faying.interface.cells import Cells
from faying.interface.clipping import areas
from faying.interface.mismatch import LARGEST_COSINE
from faying.interface.selection import DEFAULT_TOLERANCE
from faying.linalg.pieces import PIECE_NUMBERS
from faying.model.elements import SOLIDS
from faying.model.mesh import Mesh
from faying.model.surface import Facets, facet_centres, facet_normals

_MOST_PLACES = 100_000_000
"""Most places on all rays: ten thousand facets facing ten thousand layers of others."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reach(Frozen):
    """Largest gap and penetration along the normal of a minus facet at which two facets are paired.

    Attributes
    ----------
    gap : [length]
        Largest gap of all facets; ``inf`` where a deck's contact has no search distance.
    minus, plus : (n_facet,) [length]
        Largest penetration of each facet of the two sides: the depth of the element behind it.
        Deeper facets are no overlap but the far side of a part.
    """

    gap: float
    minus: Vector
    plus: Vector


def facet_depths(mesh: Mesh, facets: Facets) -> Vector:
    """Return the depth of the element behind each facet (n_facet,), along the facet's normal.

    Facets without element, in given matrices, have the length of their longest edge.
    """
    centres, normals = facet_centres(mesh.nodes, facets), facet_normals(mesh.nodes, facets)
    corners = mesh.nodes[facets.corners]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    depths: Vector = edges.max(axis=1, initial=0.0)
    for block in mesh.blocks:
        order = np.argsort(block.ids)
        position = np.searchsorted(block.ids, facets.elements, sorter=order)
        row = order[np.minimum(position, len(order) - 1)]
        members = np.flatnonzero(block.ids[row] == facets.elements)
        corners = mesh.nodes[block.nodes[row[members], : SOLIDS[block.kind].n_corners]]
        away = centres[members][:, None] - corners
        depths[members] = np.einsum("fnd,fd->fn", away, normals[members]).max(axis=1, initial=0.0)
    return depths


def facing_cells(below: Cells, above: Cells, reach: Reach) -> tuple[Indices, Indices]:
    """Return the pairs of cells that may face each other along the normals of the lower ones.

    Notes
    -----
    Rays from the centres of the lower cells are followed through a k-d tree of the upper ones, as
    far as the upper side extends. Time grows with the number of cells times the length of the rays
    over the size of the upper cells.

    Raises
    ------
    ModelError
        If the rays are too long for the size of the cells.
    """
    if not below.corners.size or not above.corners.size:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    chunks = [np.empty((0, 2), dtype=np.int64)]
    for first, second in _along_rays(below, above, reach):
        normals = below.normals[first]
        facing = np.einsum("nd,nd->n", normals, above.normals[second]) < LARGEST_COSINE
        first, second, normals = first[facing], second[facing], normals[facing]
        away = above.centres[second] - below.centres[first]
        aside = away - np.einsum("nd,nd->n", away, normals)[:, None] * normals
        facing = np.linalg.norm(aside, axis=1) <= _radii(below)[first] + _radii(above)[second]
        chunks.append(np.column_stack([first[facing], second[facing]]))
    pairs = np.unique(np.concatenate(chunks), axis=0)
    return pairs[:, 0], pairs[:, 1]


def _along_rays(below: Cells, above: Cells, reach: Reach) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of cells, the upper one near the ray of the lower one; pairs may repeat."""
    centres, normals, radii = below.centres, below.normals, _radii(below)
    low, high = above.corners.min(axis=(0, 1)), above.corners.max(axis=(0, 1))
    # Corners of the box of the upper side that are nearest and farthest along each normal.
    first = np.einsum("nd,nd->n", np.where(normals > 0, low, high) - centres, normals)
    last = np.einsum("nd,nd->n", np.where(normals > 0, high, low) - centres, normals)
    slack = below.arcs + above.arcs.max(initial=0.0) + radii * DEFAULT_TOLERANCE
    first = np.maximum(first, -reach.minus[below.parents]) - slack
    last = np.minimum(last, reach.gap) + slack
    for members, largest in _by_size(_radii(above)):
        tree = cKDTree(above.centres[members])
        steps = np.ceil(np.maximum(last - first, 0.0) / (2 * largest))
        if not steps.sum() <= _MOST_PLACES:
            refuse_model(
                f"surfaces declared to be in contact have facets of {largest:.3g} and lie up to "
                f"{np.max(last - first):.3g} apart, too far for their size to look for those that "
                "see each other; correct the coordinates, or give a search distance"
            )
        count = steps.astype(np.int64)
        for rows in np.array_split(np.arange(len(count)), 1 + int(count.sum()) // PIECE_NUMBERS):
            ray_rows, number = np.repeat(rows, count[rows]), _count_through(count[rows])
            step = (last[ray_rows] - first[ray_rows]) / count[ray_rows]
            places = (
                centres[ray_rows]
                + (first[ray_rows] + (number + 0.5) * step)[:, None] * normals[ray_rows]
            )
            neighbours = tree.query_ball_point(places, radii[ray_rows] + largest + step / 2)
            sizes = np.fromiter(map(len, neighbours), np.int64, len(neighbours))
            if sizes.any():
                others = np.concatenate([np.asarray(part, dtype=np.int64) for part in neighbours])
                yield np.repeat(ray_rows, sizes), members[others]


def _count_through(counts: Indices) -> Indices:
    """Return numbers from 0 through each of several stretches of given lengths."""
    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)


def _by_size(radii: Vector) -> Iterator[tuple[Indices, float]]:
    """Yield cells of similar size, by powers of two, with the radius of the largest."""
    size = np.floor(np.log2(np.maximum(radii, np.finfo(float).tiny))).astype(int)
    for one_size in np.unique(size):
        members = np.flatnonzero(size == one_size)
        yield members, float(radii[members].max())


def _radii(cells: Cells) -> Vector:
    """Return the distance of the farthest corner of each cell from its centre (n_cell,)."""
    away = cells.corners - cells.centres[:, None]
    return np.asarray(np.linalg.norm(away, axis=2).max(axis=1, initial=0.0))


def hidden(
    polygons: Matrix, counts: Indices, owners: Indices, distances: Vector, sizes: Vector
) -> Mask:
    """Return the polygons (n,) whose middle lies behind a nearer polygon on the same facet.

    Polygons (n, n_corner, 2) [length] are convex, in the plane of the facet from which they are
    seen (their owner), and have numbers of corners (n,). Distances from that facet, and sizes of
    it, are (n,) [length].
    """
    behind = np.zeros(len(owners), dtype=bool)
    _, group, members = np.unique(owners, return_inverse=True, return_counts=True)
    nearest = np.full(len(members), np.inf)
    np.minimum.at(nearest, group, distances)
    # Polygons closer to the nearest one than the tolerance of contact are not hidden by it.
    layer = DEFAULT_TOLERANCE * sizes
    farther = np.flatnonzero(distances > nearest[group] + layer)
    order = np.argsort(group, kind="stable")
    starts = np.cumsum(members) - members
    middle = polygons.sum(axis=1) / np.maximum(counts, 1)[:, None]
    n_pair = int(members[group[farther]].sum())
    for part in np.array_split(farther, 1 + n_pair // PIECE_NUMBERS):
        n_neighbours = members[group[part]]
        polygon = np.repeat(part, n_neighbours)
        neighbour = order[starts[group[polygon]] + _count_through(n_neighbours)]
        nearer = distances[neighbour] < distances[polygon] - layer[polygon]
        polygon, neighbour = polygon[nearer], neighbour[nearer]
        behind[polygon[_inside(middle[polygon], polygons[neighbour], counts[neighbour])]] = True
    return behind


def _inside(points: Matrix, polygons: Matrix, counts: Indices) -> Mask:
    """Return whether points (n, 2) lie in convex polygons (n, n_corner, 2) of either sense."""
    corner = np.arange(polygons.shape[1])
    following = np.where(corner + 1 < counts[:, None], corner + 1, 0)
    away = polygons - points[:, None]
    ahead = np.take_along_axis(away, following[..., None], axis=1)
    turn = away[..., 0] * ahead[..., 1] - away[..., 1] * ahead[..., 0]
    turn = turn * np.sign(areas(polygons, counts))[:, None]
    # Middles on the edge between two polygons, as in symmetric meshes, belong to both.
    on_edge = -1e-9 * np.abs(areas(polygons, counts))[:, None]
    return np.asarray(((turn >= on_edge) | (corner >= counts[:, None])).all(axis=1))
