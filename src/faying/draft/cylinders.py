"""Cylindrical faces of solids: holes and shanks."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.display.plane import ROUND
from faying.model.mesh import Mesh
from faying.model.surface import Facets, facet_area_vectors

SMOOTH = np.cos(np.radians(40.0))
"""Least cosine between neighbouring facets of a smooth face: circles of at least nine edges."""

AXIAL_SHARE = 0.03
"""Largest squared component of a cylinder's normals along its axis: flat triangles tilt."""

STEPS = 8
"""Gauss-Newton steps from the axis that normals estimate to the axis that fits the nodes."""

FULL_CIRCLE_SUM = 0.05
"""Largest sum of unit normals over their number in a full circle; a half circle has 0.6."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinders(Frozen):
    """Full cylinders among the faces of solids; arrays have an entry for each cylinder.

    Attributes
    ----------
    bodies : (n,)
        Body of each cylinder.
    holes : (n,)
        Whether the cylinder is a hole rather than a shank.
    points, axes : (n, 3)
        A point on each axis, and its direction with the largest component positive.
    radii : (n,) [length]
    spans : (n, 2) [length]
        First and last position along the axis, measured from the point.
    """

    bodies: Indices
    holes: Mask
    points: Matrix
    axes: Matrix
    radii: Vector
    spans: Matrix

    def __len__(self) -> int:
        """Return the number of cylinders."""
        return len(self.radii)


def cylinders(mesh: Mesh) -> Cylinders:
    """Return the full cylinders among the outer faces of the solids.

    Notes
    -----
    Smooth faces are the connected parts of a graph of facets. The axis of each is first the
    direction normal to the facet normals; least squares then fit the cylinder to the corners.
    Sorting the edges takes most of the time.
    """
    facets = mesh.exterior
    vectors = facet_area_vectors(mesh.nodes, facets)
    size = np.linalg.norm(vectors, axis=1)
    facets, vectors, size = facets.taken(size > 0), vectors[size > 0], size[size > 0]
    normals = vectors / size[:, None]
    n_face, face = _smooth_faces(facets, normals)
    spread = _sums(face, n_face, size[:, None, None] * normals[:, :, None] * normals[:, None])
    area = np.bincount(face, size, n_face)
    widths, frames = np.linalg.eigh(spread / np.maximum(area, np.finfo(float).tiny)[:, None, None])
    mean = np.linalg.norm(_sums(face, n_face, vectors), axis=1)
    # The normals of a full circle point in all directions of a plane alike.
    curved = (widths[:, 0] < AXIAL_SHARE) & (widths[:, 1] > 0.3) & (mean < FULL_CIRCLE_SUM * area)
    lead = np.abs(frames[:, :, 0]).argmax(axis=1)[:, None]
    axes = frames[:, :, 0] * np.sign(np.take_along_axis(frames[:, :, 0], lead, axis=1))
    return _fit_cylinders(mesh.nodes, facets, normals, face, axes, np.flatnonzero(curved))


def _smooth_faces(facets: Facets, normals: Matrix) -> tuple[int, Indices]:
    """Return the number of smooth faces, and the face of each facet (n_facet,)."""
    corners = facets.corners
    edges = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2))
    owner = np.repeat(np.arange(len(facets)), 4)
    proper = edges[:, 0] != edges[:, 1]  # triangles repeat their last corner
    edges, owner = edges[proper], owner[proper]
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    same = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    left, right = owner[same], owner[same + 1]
    smooth = np.einsum("nd,nd->n", normals[left], normals[right]) > SMOOTH
    links = (np.ones(int(smooth.sum()), dtype=np.int8), (left[smooth], right[smooth]))
    graph = sp.coo_array(links, shape=(len(facets), len(facets)))
    count, label = connected_components(graph.tocsr(), directed=False)
    return int(count), label


def _sums(groups: Indices, count: int, values: Matrix) -> Matrix:
    """Return the sums (count, ...) of values (n, ...) by group (n,)."""
    total = np.zeros((count, *values.shape[1:]))
    np.add.at(total, groups, values)
    return total


def _across(axes: Matrix) -> Matrix:
    """Return two directions (n, 3, 2) perpendicular to each axis (n, 3), as columns."""
    aside = np.eye(3)[np.abs(axes).argmin(axis=1)]
    first = np.cross(axes, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(axes, first)], axis=2)


def _least_squares(places: Matrix, of: Indices, axes: Matrix) -> tuple[Matrix, Matrix, Vector]:
    """Return points, axes and radii of cylinders fitted to places (n_place, 3)."""
    n = len(axes)
    points = _sums(of, n, places) / np.bincount(of, minlength=n)[:, None]
    away = places - points[of]
    along = np.einsum("nd,nd->n", away, axes[of])
    radii = _means(of, n, np.linalg.norm(away - along[:, None] * axes[of], axis=1))
    for _ in range(STEPS if n else 0):
        across = _across(axes)
        away = places - points[of]
        along = np.einsum("nd,nd->n", away, axes[of])
        flat = np.einsum("nd,nda->na", away, across[of])
        distance = np.linalg.norm(flat, axis=1)
        radial = flat / np.maximum(distance, np.finfo(float).tiny)[:, None]
        # Lengths over the radius, so that shifts and tilts are of equal magnitude.
        tilt = (along / radii[of])[:, None] * radial
        slopes = np.column_stack([radial, tilt, np.ones(len(places))])
        left = _sums(of, n, slopes[:, :, None] * slopes[:, None])
        right = _sums(of, n, slopes * ((distance - radii[of]) / radii[of])[:, None])
        step = np.einsum("nij,nj->ni", np.linalg.pinv(left), right)
        points = points + radii[:, None] * np.einsum("na,nda->nd", step[:, :2], across)
        axes = axes + np.einsum("na,nda->nd", step[:, 2:4], across)
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        radii = radii * np.maximum(1 + step[:, 4], 0.1)
    return points, axes, radii


def _means(groups: Indices, count: int, values: Vector) -> Vector:
    return np.bincount(groups, values, count) / np.bincount(groups, minlength=count)


def _fit_cylinders(
    nodes: Matrix,
    facets: Facets,
    normals: Matrix,
    face: Indices,
    axes: Matrix,
    curved: Indices,
) -> Cylinders:
    """Fit cylinders to the curved faces, and return the ones that are round."""
    number = np.full(len(axes), -1, dtype=np.int64)
    number[curved] = np.arange(len(curved))
    rows = np.flatnonzero(number[face] >= 0)
    of, n = number[face[rows]], len(curved)
    corners = nodes[facets.corners[rows]].reshape(-1, 3)
    of_corner = np.repeat(of, 4)
    points, axes, radii = _least_squares(corners, of_corner, axes[curved])
    away = corners - points[of_corner]
    along = np.einsum("nd,nd->n", away, axes[of_corner])
    distance = np.linalg.norm(away - along[:, None] * axes[of_corner], axis=1)
    error, low, high = np.zeros(n), np.full(n, np.inf), np.full(n, -np.inf)
    np.maximum.at(error, of_corner, np.abs(distance - radii[of_corner]))
    np.minimum.at(low, of_corner, along)
    np.maximum.at(high, of_corner, along)
    outward = np.einsum(
        "nd,nd->n", normals[rows], nodes[facets.corners[rows]].mean(axis=1) - points[of]
    )
    body = np.zeros(n, dtype=np.int64)
    body[of] = facets.bodies[rows]
    round_ones = np.flatnonzero(error <= ROUND * radii)
    return Cylinders(
        bodies=body[round_ones],
        holes=(np.bincount(of, outward, n) < 0)[round_ones],
        points=points[round_ones],
        axes=axes[round_ones],
        radii=radii[round_ones],
        spans=np.column_stack([low, high])[round_ones],
    )
