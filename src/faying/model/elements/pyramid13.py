"""Thirteen-node pyramid (CPYRAM with thirteen nodes).

Mid-side nodes 5-8 lie on the sides of the base 0-1, 1-2, 2-3, 3-0, nodes 9-12 on the edges from
corners 0-3 to the apex 4.
"""

from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD8, TRI6
from faying.model.elements.pyramid import BASE, CORNERS, below_apex, corner_functions, pyramid
from faying.model.elements.solid_element import SolidElement

MIDSIDES = (
    (0.0, -1.0, 0.0),
    (1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (-1.0, 0.0, 0.0),
    (-0.5, -0.5, 0.5),
    (0.5, -0.5, 0.5),
    (0.5, 0.5, 0.5),
    (-0.5, 0.5, 0.5),
)


def _shapes(points: Matrix) -> tuple[Matrix, Matrix]:
    points = np.asarray(points, dtype=float)
    parts = (_corners(points), _apex(points), _sides(points), _edges(points))
    return np.hstack([p[0] for p in parts]), np.concatenate([p[1] for p in parts], axis=2)


def _corners(points: Matrix) -> tuple[Matrix, Matrix]:
    linear, slopes = corner_functions(points)
    factor = points[:, :2] @ BASE.T - 1
    of_factor = np.vstack([BASE.T, np.zeros(4)])
    return linear * factor, slopes * factor[:, None] + linear[:, None] * of_factor


def _apex(points: Matrix) -> tuple[Matrix, Matrix]:
    z = points[:, 2:]
    slope = np.zeros((len(points), 3, 1))
    slope[:, 2] = 4 * z - 1
    return z * (2 * z - 1), slope


def _sides(points: Matrix) -> tuple[Matrix, Matrix]:
    """Of the base, from the coordinate along a side and the other one times its sign there."""
    values, slopes = [], []
    for along, sign in ((0, -1.0), (1, 1.0), (0, 1.0), (1, -1.0)):
        t, s, z = points[:, along], sign * points[:, 1 - along], points[:, 2]
        top = below_apex(z)
        # (top² - t²)(top + s) / (2 top), whose ratios are bounded inside.
        t_top, s_top = t / top, s / top
        bubble = 1 - t_top**2
        slope = np.zeros((len(points), 3))
        slope[:, along] = -t * (1 + s_top)
        slope[:, 1 - along] = sign * top * bubble / 2
        slope[:, 2] = -(2 * top + s + t_top**2 * s) / 2
        values.append(top**2 * bubble * (1 + s_top) / 2)
        slopes.append(slope)
    return np.stack(values, axis=1), np.stack(slopes, axis=2)


def _edges(points: Matrix) -> tuple[Matrix, Matrix]:
    """From the corners of the base to the apex."""
    x, y, z = (points[:, k, None] for k in range(3))
    a, b = BASE[:, 0], BASE[:, 1]
    top = below_apex(z)
    along_x, along_y = 1 + a * x / top, 1 + b * y / top
    slopes = np.stack(
        [
            z * a * along_y,
            z * b * along_x,
            top * along_x * along_y - z * (1 - a * b * (x / top) * (y / top)),
        ],
        axis=1,
    )
    return z * top * along_x * along_y, slopes


PYRAMID13 = SolidElement(
    kind="pyramid13",
    reference_nodes=CORNERS + MIDSIDES,  # type: ignore[arg-type]  # frozen into an array
    n_corners=5,
    shape_functions=_shapes,
    stiffness_quadrature=partial(pyramid, 3),
    mass_quadrature=partial(pyramid, 4),
    faces=(
        (QUAD8, (0, 3, 2, 1, 8, 7, 6, 5)),
        (TRI6, (0, 1, 4, 5, 10, 9)),
        (TRI6, (1, 2, 4, 6, 11, 10)),
        (TRI6, (2, 3, 4, 7, 12, 11)),
        (TRI6, (3, 0, 4, 8, 9, 12)),
    ),
    elsewhere=Elsewhere(nastran="CPYRAM", abaqus={}, meshio="pyramid13", vtk=27),
    brick_cells=(),
)
