"""Jacobians of isoparametric elements, in batches, and the check that elements are not inverted."""

from functools import reduce

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import refuse_model
from faying.model.elements.solid_element import (
    SolidElement,
    corner_gradients,
    mass_tables,
    stiffness_gradients,
)

CORNER = "a corner"


def jacobians(gradients: Matrix, coordinates: Matrix) -> Matrix:
    """Return J[e, q, k, c] = ∂x_c/∂ξ_k (n_cell, n_quad, 3, 3).

    Reference gradients of the shape functions are (n_quad, 3, n_node), coordinates (n_cell, n_node,
    3).
    """
    n_quad, _, n_node = gradients.shape
    flat = gradients.reshape(3 * n_quad, n_node) @ coordinates
    return np.asarray(flat.reshape(len(coordinates), n_quad, 3, 3))


def cofactors(jacobian: Matrix) -> Matrix:
    """Return det(J) J⁻ᵀ of matrices (..., 3, 3); rows are cross products of the rows of J."""
    first, second, third = jacobian[..., 0, :], jacobian[..., 1, :], jacobian[..., 2, :]
    rows = (np.cross(second, third), np.cross(third, first), np.cross(first, second))
    return np.stack(rows, axis=-2)


def determinants(jacobian: Matrix, cofactor: Matrix) -> Matrix:
    """Return det(J) of matrices (..., 3, 3), given their cofactors."""
    return np.asarray(np.einsum("...c,...c->...", jacobian[..., 0, :], cofactor[..., 0, :]))


def volume_factors(gradients: Matrix, coordinates: Matrix) -> Matrix:
    """Return det(J) (n_quad, n_cell) alone, a third of the work of :func:`cofactors`."""
    n_quad, _, n_node = gradients.shape
    flat = gradients.reshape(3 * n_quad, n_node)
    x, y, z = (
        np.moveaxis((flat @ coordinates[:, :, axis].T).reshape(n_quad, 3, -1), 1, 0)
        for axis in range(3)
    )
    result: Matrix = x[0] * (y[1] * z[2] - z[1] * y[2])
    result += y[0] * (z[1] * x[2] - x[1] * z[2])
    result += z[0] * (x[1] * y[2] - y[1] * x[2])
    return result


def check_shapes(element: SolidElement, coordinates: Matrix, ids: Indices) -> None:
    """Refuse elements whose mapping is singular or inverted.

    Checked are the quadrature points of stiffness and mass, and collapsed corners. Corners may be
    inverted away from quadrature points: matrices exist, and :func:`inverted_corners` finds these.
    Coordinates are (n_cell, n_node, 3) [length]; ids (n_cell,) are for the message.

    Raises
    ------
    ModelError
        With the first offending element, the determinant found and the remedy.
    """
    places = {
        CORNER: corner_gradients(element),
        "a stiffness quadrature point": stiffness_gradients(element),
        "a mass quadrature point": mass_tables(element)[1],
    }
    by_node = coordinates.transpose(1, 0, 2)
    extent = (reduce(np.maximum, by_node) - reduce(np.minimum, by_node)).max(axis=1)
    seen: list[Matrix] = []
    for location, gradients in places.items():
        if any(np.array_equal(gradients, earlier) for earlier in seen):
            continue
        seen.append(gradients)
        determinant = volume_factors(gradients, coordinates)
        # Collapsed corners are measured by the largest determinant, of which a usable one has far
        # more than a millionth; flat elements by the cube of their extent.
        threshold = np.maximum(SOLVED * np.abs(determinant).max(axis=0), ROUND_OFF * extent**3)
        if location == CORNER:
            determinant[determinant < -threshold] = np.inf
        _check_above(threshold, determinant.min(axis=0), element, ids, location)


def inverted_corners(element: SolidElement, coordinates: Matrix) -> Mask:
    """Return whether elements at coordinates (n_cell, n_node, 3) have an inverted corner."""
    determinant = volume_factors(corner_gradients(element), coordinates)
    return np.asarray(determinant.min(axis=0) < -SOLVED * np.abs(determinant).max(axis=0))


def _check_above(
    threshold: Vector, smallest: Vector, element: SolidElement, ids: Indices, location: str
) -> None:
    bad = ~(smallest > threshold)  # also true for coordinates that are not numbers
    if not bad.any():
        return
    first = int(np.argmax(bad))
    others = f" (and {bad.sum() - 1} more elements)" if bad.sum() > 1 else ""
    inverted = smallest[first] < -threshold[first]
    distorted = (
        "it is inside out or too distorted: correct the order of its nodes, or remesh (curved ones "
        "of gmsh with Mesh.HighOrderOptimize = 2)"
    )
    what, remedy = (
        ("negative", distorted)
        if inverted
        else ("no", "it is flat or collapsed: use a wedge or tetrahedron, or merge its nodes away")
    )
    refuse_model(
        f"element {ids[first]} ({element.kind}){others} has {what} volume at {location} (Jacobian "
        f"determinant {smallest[first]:.3g}); {remedy}"
    )
