"""Five-node pyramid, a toy: the collapsed brick (CPYRAM with five nodes, C3D5)."""

import numpy as np

from faying._typing import Matrix
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.quadrature import Quadrature, hexahedron
from faying.model.elements.solid_element import SolidElement

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

APEX = 1e-12
"""Distance from the apex, where gradients have no limit, at which they are taken instead."""


def rational_pyramid(points: Matrix) -> tuple[Matrix, Matrix]:
    """Return values (n_point, 5) and gradients (n_point, 3, 5): a b / c on the base, z above."""
    x, y, z = np.asarray(points, dtype=float).T
    level = np.maximum(1 - z, APEX)
    one, zero = np.ones_like(x), np.zeros_like(x)
    along = ((level - x, -one), (x, one), (x, one), (level - x, -one))
    across = ((level - y, -one), (level - y, -one), (y, one), (y, one))
    values, gradients = [], []
    for (a, da), (b, db) in zip(along, across, strict=True):
        falling_a, falling_b = np.where(da < 0, -1.0, 0.0), np.where(db < 0, -1.0, 0.0)
        values.append(a * b / level)
        upward = (falling_a * b + falling_b * a) / level + a * b / level**2
        gradients.append([da * b / level, a * db / level, upward])
    values.append(z)
    gradients.append([zero, zero, one])
    return np.stack(values, axis=-1), np.array(gradients).transpose(2, 1, 0)


def collapsed(order: int) -> Quadrature:
    """Return a brick's rule with its top drawn together."""
    points, weights = hexahedron(order)
    level = 1 - points[:, 2]
    base = points[:, :2] * level[:, None]
    return Quadrature(np.column_stack([base, points[:, 2]]), weights * level**2)


def _stiffness() -> Quadrature:
    return collapsed(3)


def _mass() -> Quadrature:
    return collapsed(7)


PYRAMID5 = SolidElement(
    kind="pyramid5",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=5,
    shape_functions=rational_pyramid,
    stiffness_quadrature=_stiffness,
    mass_quadrature=_mass,
    faces=(
        ("quad4", (0, 3, 2, 1)),
        ("tri3", (0, 1, 4)),
        ("tri3", (1, 2, 4)),
        ("tri3", (2, 3, 4)),
        ("tri3", (3, 0, 4)),
    ),
    elsewhere=Elsewhere(nastran="CPYRAM", abaqus={"C3D5": ""}, meshio="pyramid", vtk=14),
    brick_cells=(),
)
