"""Measures of a lap joint and the meshes of its plates."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Mask, Vector
from faying.exceptions import ModelError
from faying.model.generate import Cells, brick_grid, shaped

PLATE_NAMES = {2: ("lower", "upper"), 3: ("lower", "middle", "upper")}

MOST_BRICKS = 500_000
"""Bricks of a joint: 1.6 million degrees of freedom, whose factors take tens of gigabytes."""


@dataclass(frozen=True, kw_only=True)
class LapGeometry:
    """Measures of a lap joint [length]; see :func:`lap_joint_assembly`."""

    element_size: float
    length: float
    width: float
    thickness: float
    overlap: float
    hole_radius: float
    bolt_positions: tuple[tuple[float, float], ...]
    plates: int
    curvature: float
    shape: str
    upper_element_size: float

    def __post_init__(self) -> None:
        positive = ("element_size", "upper_element_size", "length", "width", "thickness", "overlap")
        for name in positive:
            if not 0 < getattr(self, name) < np.inf:
                message = f"lap joint: {name} is {getattr(self, name):g}; it must be positive"
                raise ModelError(message)
        count = self._count()
        if count > MOST_BRICKS:
            message = (
                f"lap joint: elements of {min(self.element_size, self.upper_element_size):g} "
                f"divide it into {count:.3g} bricks, and {MOST_BRICKS} are the most; enlarge "
                "element_size or correct the measures"
            )
            raise ModelError(message)
        if not self.overlap < self.length:
            message = (
                f"lap joint: the overlap {self.overlap:g} is not shorter than the whole length "
                f"{self.length:g}, so no plate would reach past it; shorten the overlap"
            )
            raise ModelError(message)
        if not self.hole_radius >= 0:
            message = f"lap joint: hole_radius is {self.hole_radius:g}; give 0 or None for no hole"
            raise ModelError(message)
        if self.plates not in PLATE_NAMES:
            message = f"lap joint: plates is {self.plates}; it must be 2 or 3"
            raise ModelError(message)
        for x, y in self.bolt_positions:
            if abs(x) > self.overlap / 2 or abs(y) > self.width / 2:
                message = (
                    f"lap joint: the bolt at ({x:g}, {y:g}) lies outside the overlap, "
                    f"|x| <= {self.overlap / 2:g}, |y| <= {self.width / 2:g}"
                )
                raise ModelError(message)

    def _count(self) -> float:
        """Return about how many bricks there are, holes filled."""
        bricks = np.float64(0.0)
        with np.errstate(over="ignore"):
            for number in range(min(self.plates, max(PLATE_NAMES))):
                last = number == self.plates - 1
                size = np.float64(self.upper_element_size if last else self.element_size)
                half = (self.length + self.overlap) / 2
                bricks += np.prod(
                    [max(side / size, 1) for side in (half, self.width, self.thickness)]
                )
        return float(bricks)

    def heights(self) -> Vector:
        """Heights of the plates' surfaces, before bending (plates + 1,)."""
        levels = np.arange(self.plates + 1, dtype=np.float64) - self.plates / 2
        return np.asarray(self.thickness * levels)

    def rise(self, x: float | Vector) -> Vector:
        """Height added at x: the parabola -½ κ x² of an arch."""
        return np.asarray(-0.5 * self.curvature * np.square(x), dtype=np.float64)

    def plate(self, number: int) -> Cells:
        """Mesh one plate, counted from below; even ones reach to the clamp, odd ones to the tip."""
        ends = np.array([-self.length / 2, -self.overlap / 2, self.overlap / 2, self.length / 2])
        size = self.upper_element_size if number == self.plates - 1 else self.element_size
        x = _grid_lines(ends[:3] if number % 2 == 0 else ends[1:], size)
        y = _grid_lines(np.array([-self.width / 2, self.width / 2]), size)
        z = _grid_lines(self.heights()[number : number + 2], size)
        bricks = brick_grid(x, y, z)
        solid = ~self._in_hole(bricks)
        if not solid.any():
            message = f"lap joint: hole_radius {self.hole_radius:g} leaves nothing of the plates"
            raise ModelError(message)
        cells = shaped(bricks.restricted(solid), self.shape)
        # Vertical lines stay vertical, so volumes do not change and the plates still touch.
        bent = cells.nodes + np.outer(self.rise(cells.nodes[:, 0]), [0.0, 0.0, 1.0])
        return Cells(kind=cells.kind, nodes=bent, cells=cells.cells)

    def _in_hole(self, bricks: Cells) -> Mask:
        """Whether the centroid of each brick lies within the hole radius of a bolt's axis."""
        if self.hole_radius == 0 or not self.bolt_positions:
            return np.zeros(len(bricks.cells), dtype=bool)
        between = bricks.centroids()[:, None, :2] - np.asarray(self.bolt_positions)
        inside: Mask = (np.linalg.norm(between, axis=2) <= self.hole_radius).any(axis=1)
        return inside


def _grid_lines(stations: Vector, size: float) -> Vector:
    """Divide each span between stations evenly into pieces of about ``size``."""
    spans = [
        np.linspace(a, b, max(1, round((b - a) / size)) + 1)[:-1]
        for a, b in zip(stations[:-1].tolist(), stations[1:].tolist(), strict=True)
    ]
    return np.concatenate([*spans, stations[-1:]])
