"""Convex polygons clipped against each other and cut into triangles, thousands at a time.

Sutherland & Hodgman, Reentrant polygon clipping, Commun. ACM 17 (1974) 32-42.
"""

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.digits import ROUND_OFF


def clip(subject: Matrix, window: Matrix) -> tuple[Matrix, Indices]:
    """Return intersections of convex polygons (n, 4, 2), pairwise; corners are counter-clockwise.

    A triangle repeats its last corner. Intersections (n, most, 2) have numbers of corners (n,), 0
    for an empty one; columns beyond are zero.

    Notes
    -----
    Four passes over all pairs; each edge of the window adds at most one corner.
    """
    polygons = np.array(subject, dtype=float)
    counts = np.full(len(polygons), polygons.shape[1])
    for edge in range(window.shape[1]):
        start = window[:, edge]
        along = window[:, (edge + 1) % window.shape[1]] - start
        polygons, counts = _half_plane(polygons, counts, start, along)
    return polygons, counts


def _half_plane(
    polygons: Matrix, counts: Indices, start: Matrix, along: Matrix
) -> tuple[Matrix, Indices]:
    """Return the part of each polygon to the left of a line (n, 2); lines of no length keep all."""
    n, width = polygons.shape[:2]
    corner = np.arange(width)
    used = corner < counts[:, None]
    following = np.where(corner + 1 < counts[:, None], corner + 1, 0)
    away = polygons - start[:, None]
    left = along[:, None, 0] * away[..., 1] - along[:, None, 1] * away[..., 0]
    # Corners on the line belong to both its sides; otherwise a side along the line could cross it
    # several times by round-off.
    reach = np.abs(np.where(used[..., None], away, 0.0)).max(axis=(1, 2))
    rounding = ROUND_OFF * np.linalg.norm(along, axis=1) * reach
    left = np.where(np.abs(left) <= rounding[:, None], 0.0, left)
    next_left = np.take_along_axis(left, following, axis=1)
    next_corner = np.take_along_axis(polygons, following[..., None], axis=1)
    inside = used & (left >= 0)
    crossing = used & ((left >= 0) != (next_left >= 0))
    share = left / np.where(crossing, left - next_left, 1.0)
    cut = polygons + share[..., None] * (next_corner - polygons)
    # A corner is followed by the point where its edge leaves or enters.
    every = np.stack([polygons, cut], axis=2).reshape(n, 2 * width, 2)
    used_corners = np.stack([inside, crossing], axis=2).reshape(n, 2 * width)
    counts = used_corners.sum(axis=1)
    width_after = max(int(counts.max(initial=0)), 3)
    first = np.argsort(~used_corners, axis=1, kind="stable")[:, :width_after]
    left_over = np.take_along_axis(every, first[..., None], axis=1)
    left_over[np.arange(width_after) >= counts[:, None]] = 0.0
    return left_over, counts


def areas(polygons: Matrix, counts: Indices) -> Vector:
    """Return the areas (n,) of polygons (n, n_corner, 2), counter-clockwise ones positive."""
    corner = np.arange(polygons.shape[1])
    following = np.where(corner + 1 < counts[:, None], corner + 1, 0)
    # Relative to the first corner, so that distant polygons lose no digits.
    away = polygons - polygons[:, :1]
    ahead = np.take_along_axis(away, following[..., None], axis=1)
    doubled = away[..., 0] * ahead[..., 1] - away[..., 1] * ahead[..., 0]
    return np.asarray(0.5 * np.where(corner < counts[:, None], doubled, 0.0).sum(axis=1))


def fans(polygons: Matrix, counts: Indices) -> tuple[Matrix, Indices]:
    """Divide convex polygons (n, n_corner, 2) into triangles that share their first corner.

    Triangles (n_triangle, 3, 2) are counter-clockwise, those of zero area included. Their polygons
    (n_triangle,) are returned too.
    """
    second = np.arange(1, polygons.shape[1] - 1)
    owners, corner_number = np.nonzero(second < counts[:, None] - 1)
    corners = np.stack([np.zeros_like(corner_number), corner_number + 1, corner_number + 2], axis=1)
    return polygons[owners[:, None], corners], owners
