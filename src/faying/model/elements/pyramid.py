"""Pyramids of five and thirteen nodes (CPYRAM): shapes, which are rational, and quadrature.

Their shape functions are those of G. Bedrosian, "Shape functions and integration formulas for
three-dimensional finite element analysis", Int. J. Numer. Meth. Engng 35 (1992) 95-108: rational,
with the traces of triangles and quadrilaterals on the faces, so that pyramids join the other
solids. On the axis they are continuous up to the apex, where the limit along the axis is taken.

Mid-side nodes 5-8 lie on the sides of the base 0-1, 1-2, 2-3, 3-0, nodes 9-12 on the edges from
corners 0-3 to the apex 4.
"""

from functools import cache, partial

import numpy as np
import scipy.special

from faying._typing import Matrix, Vector, frozen
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD4, TRI3
from faying.model.elements.quadrature import Quadrature
from faying.model.elements.solid_element import SolidElement, mid_sided

CORNERS = ((-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
BASE: Matrix = np.array(CORNERS)[:4, :2]
"""Signs of the two coordinates at the corners of the base."""


@cache
def pyramid(n: int) -> Quadrature:
    """Return a rule of n³ points: Gauss on the base, Gauss-Jacobi along the axis.

    Exact to degree 2n - 1 in all for polynomials.
    """
    line, length = scipy.special.roots_legendre(n)
    axis, share = scipy.special.roots_jacobi(n, 2, 0)
    height, share = (axis + 1) / 2, share / 8
    z, y, x = (table.ravel() for table in np.meshgrid(height, line, line, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", share, length, length).ravel()
    points = np.column_stack([(1 - z) * x, (1 - z) * y, z])
    return Quadrature(frozen(points), frozen(weights))


def below_apex(z: Vector) -> Vector:
    """Return 1 - z, bounded away from zero."""
    return np.maximum(1 - z, np.finfo(float).eps)


def corner_functions(points: Matrix) -> tuple[Matrix, Matrix]:
    """Return values (n_point, 4) and gradients (n_point, 3, 4) of the base's linear functions."""
    x, y, z = (points[:, k, None] for k in range(3))
    a, b = BASE[:, 0], BASE[:, 1]
    top = below_apex(z)
    values = ((1 + a * x) * (1 + b * y) - z + a * b * x * y * z / top) / 4
    gradients = np.stack(
        [
            (a * (1 + b * y) + a * b * y * z / top) / 4,
            (b * (1 + a * x) + a * b * x * z / top) / 4,
            (-1 + a * b * (x / top) * (y / top)) / 4,
        ],
        axis=1,
    )
    return values, gradients


def _linear_shapes(points: Matrix) -> tuple[Matrix, Matrix]:
    points = np.asarray(points, dtype=float)
    base, gradients = corner_functions(points)
    apex = np.broadcast_to([[0.0], [0.0], [1.0]], (len(points), 3, 1))
    return np.hstack([base, points[:, 2:]]), np.concatenate([gradients, apex], axis=2)


PYRAMID5 = SolidElement(
    kind="pyramid5",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=5,
    shape_functions=_linear_shapes,
    stiffness_quadrature=partial(pyramid, 2),
    mass_quadrature=partial(pyramid, 3),
    faces=(
        (QUAD4, (0, 3, 2, 1)),
        (TRI3, (0, 1, 4)),
        (TRI3, (1, 2, 4)),
        (TRI3, (2, 3, 4)),
        (TRI3, (3, 0, 4)),
    ),
    elsewhere=Elsewhere(nastran="CPYRAM", abaqus={}, meshio="pyramid"),
    brick_cells=(),
)


_NODES, _FACES = mid_sided(PYRAMID5, "01 12 23 30 04 14 24 34")


def _quadratic_shapes(points: Matrix) -> tuple[Matrix, Matrix]:
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
    """Return functions of the sides of the base, by the coordinates along and across a side."""
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
    """Return functions of the edges from the corners of the base to the apex."""
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
    reference_nodes=_NODES,
    n_corners=5,
    shape_functions=_quadratic_shapes,
    stiffness_quadrature=partial(pyramid, 3),
    mass_quadrature=partial(pyramid, 4),
    faces=_FACES,
    elsewhere=Elsewhere(nastran="CPYRAM", abaqus={}, meshio="pyramid13"),
    brick_cells=(),
)
