"""The plane a surface is drawn in."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector

FLAT = 1e-3
"""Points this far out of the best plane, over the extent, still make a flat surface."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Plane:
    """The plane a map is drawn in.

    Attributes
    ----------
    axes : (2, 3)
        Directions of the map's axes.
    labels
        Names of the map's axes.
    flat
        Whether the surface lies in it; otherwise the map is a projection.
    """

    axes: Matrix
    labels: tuple[str, str]
    flat: bool

    def project(self, points: Matrix) -> Matrix:
        """Return map coordinates (n, 2) of points (n, 3)."""
        coordinates: Matrix = points @ self.axes.T
        return coordinates

    def directions(self, _points: Matrix, vectors: Matrix) -> Matrix:
        """Return the components (n, 2) along the map of vectors (n, 3), the same at all points."""
        return self.project(vectors)

    def whole(self, polygons: Matrix) -> Matrix:
        """Return polygons (n, n_corner, 2) of the map as they are: it is cut nowhere."""
        return polygons


def plane_of(points: Matrix, normals: Matrix, weights: Vector) -> Plane:
    """Return the plane of a flat surface, or the best one of a curved surface.

    Parameters
    ----------
    points : (n, 3)
        On it.
    normals, weights : (n_point, 3), (n_point,)
        Of its contact points.

    Notes
    -----
    Its axes follow the two basic axes that lie best in it, so that a map reads like a drawing.
    """
    normal = _normal(points, normals, weights)
    keep = np.delete(np.arange(3), np.abs(normal).argmax())
    first = _unit(np.eye(3)[keep[0]] - normal[keep[0]] * normal)
    second = np.eye(3)[keep[1]] - normal[keep[1]] * normal
    second = _unit(second - (second @ first) * first)
    aligned = np.abs(normal).max() > 1 - 1e-9
    names = ["xyz"[axis] + ("" if aligned else "′") for axis in keep]
    height = (points - points.mean(axis=0)) @ normal if len(points) else np.zeros(1)
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    return Plane(
        axes=np.stack([first, second]),
        labels=(names[0], names[1]),
        flat=bool(np.abs(height).max() <= FLAT * extent),
    )


def _normal(points: Matrix, normals: Matrix, weights: Vector) -> Vector:
    """Mean normal, or the direction of least extent where normals cancel (a sleeve)."""
    mean: Vector = weights @ normals
    total = float(weights.sum())
    if total > 0 and np.linalg.norm(mean) > 0.1 * total:
        return _unit(mean)
    if len(points) < 3:
        return np.array([0.0, 0.0, 1.0])
    centred = points - points.mean(axis=0)
    least: Vector = np.linalg.svd(centred, full_matrices=False)[2][-1]
    return least


def _unit(vector: Vector) -> Vector:
    unit: Vector = vector / np.linalg.norm(vector)
    return unit
