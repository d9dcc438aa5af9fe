"""Quadrature rules on the reference cells of scikit-fem ([0, 1]³, unit tetrahedron, unit wedge).

scikit-fem is imported at first use, because that takes longer than for the rest of faying.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix, Vector, frozen


class Quadrature(NamedTuple):
    """Points (n_quad, 3) and weights (n_quad,) on a reference cell; their sum is its volume."""

    points: Matrix
    weights: Vector


@cache
def hexahedron(order: int) -> Quadrature:
    """Return the Gauss product rule on [0, 1]³ exact to ``order`` in each coordinate."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefHex

    return _rule(*get_quadrature(RefHex, order))


@cache
def tetrahedron(order: int) -> Quadrature:
    """Return a rule on the unit tetrahedron exact to total degree ``order``."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTet

    return _rule(*get_quadrature(RefTet, order))


@cache
def wedge(triangle_order: int, line_order: int) -> Quadrature:
    """Return the product of a triangle rule and a Gauss rule on the unit wedge.

    Notes
    -----
    Not scikit-fem 12's wedge rule, because its weights sum to 1/4 while the unit wedge has volume
    1/2, and because a product rule needs fewer points.
    """
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefLine, RefTri

    plane, area = get_quadrature(RefTri, triangle_order)
    line, length = get_quadrature(RefLine, line_order)
    points = np.vstack([np.repeat(plane, line.shape[1], axis=1), np.tile(line, plane.shape[1])])
    return _rule(points, np.outer(area, length).ravel())


def _rule(points: Matrix, weights: Vector) -> Quadrature:
    return Quadrature(frozen(np.asarray(points).T), frozen(weights))
