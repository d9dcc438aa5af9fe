"""What pyramids have in common: reference corners, quadrature, and where shapes are rational.

Their shape functions are those of G. Bedrosian, "Shape functions and integration formulas for
three-dimensional finite element analysis", Int. J. Numer. Meth. Engng 35 (1992) 95-108: rational,
with the traces of triangles and quadrilaterals on the faces, so that pyramids join the other
solids. On the axis they are continuous up to the apex, where the limit along the axis is taken.
"""

from functools import cache

import numpy as np
import scipy.special

from faying._typing import Matrix, Vector, frozen
from faying.model.elements.quadrature import Quadrature

CORNERS = ((-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
BASE: Matrix = np.array(CORNERS)[:4, :2]
"""Signs of the two coordinates at the corners of the base."""

_LEAST = 1e-14


@cache
def pyramid(n: int) -> Quadrature:
    """Rule of n³ points: Gauss on the base, Gauss-Jacobi along the axis, where the base shrinks.

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
    """Return 1 - z, kept from zero."""
    return np.maximum(1 - z, _LEAST)


def corner_functions(points: Matrix) -> tuple[Matrix, Matrix]:
    """Values (n_point, 4) and gradients (n_point, 3, 4) of the linear functions of the base."""
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
