"""Maps of surfaces: a plane, or an unrolled cylinder with its arc across and its axis up."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import SHORT_DIGITS, SOLVED


@dataclass(frozen=True, eq=False, kw_only=True)
class Plane:
    """A plane onto which a surface is projected to draw it.

    Attributes
    ----------
    axes : (2, 3)
        Directions of the map's axes.
    labels
        Names of the map's axes.
    flat
        Whether the surface lies in the plane; otherwise the map is a projection.
    """

    axes: Matrix
    labels: tuple[str, str]
    flat: bool

    def project(self, points: Matrix) -> Matrix:
        """Return map coordinates (n, 2) of points (n, 3)."""
        return points @ self.axes.T

    def directions(self, _points: Matrix, vectors: Matrix) -> Matrix:
        """Return the components (n, 2) of vectors (n, 3) along the axes of the map."""
        return self.project(vectors)

    def whole(self, polygons: Matrix) -> Matrix:
        """Return polygons (n, n_corner, 2) of the map unchanged: a plane has no cut."""
        return polygons


def plane_of(points: Matrix, normals: Matrix, weights: Vector) -> Plane:
    """Return the plane of a flat surface, or the best-fitting plane of a curved one.

    The surface has points (n, 3), and contact points with normals (n_point, 3) and weights.

    Notes
    -----
    The map's axes are the two basic axes closest to the plane, as in a drawing.
    """
    normal = _normal(points, normals, weights)
    keep = np.delete(np.arange(3), np.abs(normal).argmax())
    first = _unit(np.eye(3)[keep[0]] - normal[keep[0]] * normal)
    second = np.eye(3)[keep[1]] - normal[keep[1]] * normal
    second = _unit(second - (second @ first) * first)
    aligned = np.abs(normal).max() > 1 - SOLVED
    names = ["xyz"[axis] + ("" if aligned else "′") for axis in keep]
    height = (points - points.mean(axis=0)) @ normal if len(points) else np.zeros(1)
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    return Plane(
        axes=np.stack([first, second]),
        labels=(names[0], names[1]),
        flat=bool(np.abs(height).max() <= SHORT_DIGITS * extent),
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
    return np.asarray(np.linalg.svd(centred, full_matrices=False)[2][-1])


def _unit(vector: Vector) -> Vector:
    return vector / np.linalg.norm(vector)


ROUND = 0.02
"""Distance of points from a circle, over its radius, up to which a surface is a cylinder, and
difference of equal diameters: chords, and rounded nodes. Holes of standard sizes differ by
5 %."""

ACROSS = 0.05
"""Largest root mean square of the normals' component along the axis of a cylinder."""

BENT = 0.5
"""Least share of the normals in each direction across the axis: a quarter circle has 0.8."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Unrolled:
    """The map of a cylinder, cut open at its widest gap between points.

    Attributes
    ----------
    axes : (3, 3)
        Two directions across the axis, and the axis.
    centre : (2,) [length]
        Centre of the circle, along the first two directions.
    radius : [length]
    cut : [rad]
        Angle where the map begins.
    labels
        Names of the map's axes.
    flat
        Whether the surface lies in a plane: always False.
    """

    axes: Matrix
    centre: Vector
    radius: float
    cut: float
    labels: tuple[str, str]
    flat: bool = False

    @property
    def period(self) -> float:
        """Length of the circumference [length]."""
        return float(2 * np.pi * self.radius)

    def project(self, points: Matrix) -> Matrix:
        """Return map coordinates (n, 2) of points (n, 3)."""
        arc = np.mod(self._angles(points) - self.cut, 2 * np.pi) * self.radius
        return np.stack([arc, points @ self.axes[2]], axis=-1)

    def directions(self, points: Matrix, vectors: Matrix) -> Matrix:
        """Return the components (n, 2) along the map of vectors (n, 3) at points."""
        angles = self._angles(points)
        around = np.outer(-np.sin(angles), self.axes[0]) + np.outer(np.cos(angles), self.axes[1])
        return np.stack([(vectors * around).sum(axis=-1), vectors @ self.axes[2]], axis=-1)

    def _angles(self, points: Matrix) -> Vector:
        x, y = np.moveaxis(points @ self.axes[:2].T - self.centre, -1, 0)
        return np.asarray(np.arctan2(y, x))

    def whole(self, polygons: Matrix) -> Matrix:
        """Return polygons (n, n_corner, 2) of the map, with those across the cut at its end."""
        arcs = polygons[..., :1]
        over = np.ptp(arcs, axis=1, keepdims=True) > self.period / 2
        moved = np.where(over & (arcs < self.period / 2), self.period, 0.0)
        return np.asarray(polygons + np.concatenate([moved, np.zeros_like(moved)], axis=-1))


def unrolled(points: Matrix, normals: Matrix) -> Unrolled | None:
    """Return the map of points (n, 3) on a cylinder; None where no cylinder fits them.

    The circle is fitted by least squares (Kåsa 1976).
    """
    if len(points) < 4 or len(normals) < 4:
        return None
    spread, directions = np.linalg.eigh(normals.T @ normals / len(normals))
    if spread[0] > ACROSS**2 or spread[1] < BENT / 3:
        return None
    axis = directions[:, 0] * np.sign(directions[np.abs(directions[:, 0]).argmax(), 0])
    first = directions[:, 2]
    axes = np.stack([first, np.cross(axis, first), axis])
    across = points @ axes[:2].T
    system = np.column_stack([2 * across, np.ones(len(across))])
    solution = np.linalg.lstsq(system, (across**2).sum(axis=1), rcond=None)[0]
    centre = solution[:2]
    radius = float(np.sqrt(max(solution[2] + centre @ centre, 0.0)))
    away = np.linalg.norm(across - centre, axis=1)
    if not radius > 0 or np.abs(away - radius).max() > ROUND * radius:
        return None
    angles = np.sort(np.arctan2(*(across - centre).T[::-1]))
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    widest = int(gaps.argmax())
    aligned = np.abs(axis).max() > 1 - 1e-6
    along = "xyz"[int(np.abs(axis).argmax())] if aligned else "along the axis"
    return Unrolled(
        axes=axes,
        centre=centre,
        radius=radius,
        cut=float(angles[widest] + gaps[widest] / 2),
        labels=("arc", along),
    )
