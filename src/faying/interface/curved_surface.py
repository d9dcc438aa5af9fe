"""Distance of the true surface from the facets that approximate it."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, Vector
from faying.model.surface import Facets, facet_normals

SHARP = np.radians(15.0)
"""Largest turn of normals towards a corner on an arc; larger ones are edges or chamfers."""


def arc_heights(corners: Matrix, facets: Facets, normals: Matrix) -> Vector:
    """Return estimated distances of the true surface from facets: h θ / 4, θ the turn at nodes.

    θ is the largest angle between the facet's normal (n_facet, 3) and the mean normal at its
    corners (n_facet, 4, 3) [length] away from edges: zero on a flat surface, h / 2R on a cylinder.
    h is the longest side of the facet.
    """
    index = facets.corners
    mean = np.zeros((int(index.max(initial=-1)) + 1, 3))
    np.add.at(mean, index, np.repeat(normals[:, None], index.shape[1], axis=1))
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    mean /= np.where(length > 0, length, 1.0)
    # The chord between unit normals is exactly zero for equal ones, unlike arccos.
    turn = np.linalg.norm(mean[index] - normals[:, None], axis=2)
    turn = np.where(turn < SHARP, turn, 0.0).max(axis=1)
    edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return np.asarray(edge * turn / 4)


def corner_normals(nodes: Matrix, facets: Facets) -> Matrix:
    """Return the unit normals (n_facet, 4, 3) of the smooth surface through corners of facets.

    At each corner of linear facets the height of the neighbours' neighbours over the tangent plane
    is fitted by a quadratic, whose slope at the corner turns the mean normal of the facets. At a
    rim, where that mean is one-sided, this makes the normal second-order accurate. Facets that
    meet at an edge sharper than 15° do not affect each other. Quadratic facets have the normals
    of their shape functions, since they follow the surface.
    """
    facet_normal = facet_normals(nodes, facets)
    normals = np.repeat(facet_normal[:, None], 4, axis=1)
    linear = (facets.nodes[:, 4:] < 0).all(axis=1)
    if not linear.any():
        return normals
    used, local = np.unique(facets.corners[linear], return_inverse=True)
    local = local.reshape(-1, 4)
    mean = np.zeros((len(used), 3))
    every = np.repeat(facet_normal[linear][:, None], 4, axis=1)
    every[facets.triangular[linear], 3] = 0.0  # the repeated corner
    np.add.at(mean, local, every)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    fitted = _turn_normals(nodes[used], mean, _neighbours(local, mean))
    smooth_normals = fitted[local]
    smooth = np.linalg.norm(smooth_normals - facet_normal[linear][:, None], axis=2) < SHARP
    normals[linear] = np.where(smooth[..., None], smooth_normals, normals[linear])
    return normals


def _neighbours(corners: Indices, normals: Matrix) -> Indices:
    """Return the nodes within two facets of each node (n_node, most); -1 fills up."""
    n = len(normals)
    rows = np.repeat(np.arange(len(corners)), corners.shape[1])
    belongs = sp.csr_array((np.ones(len(rows)), (rows, corners.ravel())), shape=(len(corners), n))
    once = (belongs.T @ belongs).tocoo()
    seen = np.einsum("kd,kd->k", normals[once.row], normals[once.col]) > np.cos(SHARP)
    once = sp.csr_array((np.ones(seen.sum()), (once.row[seen], once.col[seen])), shape=(n, n))
    twice = (once @ once).tocsr()
    count = np.diff(twice.indptr)
    column = np.arange(twice.nnz) - np.repeat(twice.indptr[:-1], count)
    table = np.full((n, int(count.max())), -1, dtype=np.int64)
    table[np.repeat(np.arange(n), count), column] = twice.indices
    return table


def _turn_normals(points: Matrix, normals: Matrix, neighbours: Indices) -> Matrix:
    """Return normals (n, 3) turned by the slope of the quadratic through neighbours (n, most)."""
    first = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first -= np.einsum("nd,nd->n", first, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    away = np.where(neighbours[..., None] >= 0, points[neighbours] - points[:, None], 0.0)
    # A node between facets at sharp angles has no neighbours, and no slope.
    reach = np.maximum(np.linalg.norm(away, axis=2).max(axis=1), np.finfo(float).tiny)
    x, y, z = (
        np.einsum("nkd,nd->nk", away, axis) / reach[:, None] for axis in (first, second, normals)
    )
    # Rows of zeros replace missing neighbours; the node itself fixes the constant.
    terms = np.stack([x, y, x * x, x * y, y * y], axis=-1)
    # Too few neighbours leave terms undetermined; the smallest solution is then taken.
    fit = np.einsum("nik,nk->ni", np.linalg.pinv(terms, rcond=1e-6), z)
    turned = normals - fit[:, :1] * first - fit[:, 1:2] * second
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))


def standing_off(shape: Matrix, corners: Matrix, normals: Matrix) -> Matrix:
    """Return the height of the smooth surface over linear facets, ½ Σ N_i (x_i − x)·n_i.

    With exact normals it is second-order accurate in κh: a tangent plane lies as far beyond the
    surface as the mean of the chords, weighted by N, lies short of it; the error for a circle is
    (κh)²/16. Shape functions of the corners are (n, n_q, 4), with zero in the last column for
    triangles; corners and normals are (n, 4, 3). Heights (n, n_q) [length] are positive where the
    surface lies outside the facet, along the normals.
    """
    points = np.einsum("nqi,nid->nqd", shape, corners)
    at_corner = np.einsum("nid,nid->ni", corners, normals)
    beyond = np.einsum("nqi,ni->nq", shape, at_corner)
    return np.asarray(0.5 * (beyond - np.einsum("nqi,nqd,nid->nq", shape, points, normals)))
