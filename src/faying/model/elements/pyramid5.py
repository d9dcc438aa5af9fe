"""Five-node pyramid (CPYRAM with five nodes)."""

from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD4, TRI3
from faying.model.elements.pyramid import CORNERS, corner_functions, pyramid
from faying.model.elements.solid_element import SolidElement


def _shapes(points: Matrix) -> tuple[Matrix, Matrix]:
    points = np.asarray(points, dtype=float)
    base, gradients = corner_functions(points)
    apex = np.broadcast_to([[0.0], [0.0], [1.0]], (len(points), 3, 1))
    return np.hstack([base, points[:, 2:]]), np.concatenate([gradients, apex], axis=2)


PYRAMID5 = SolidElement(
    kind="pyramid5",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=5,
    shape_functions=_shapes,
    stiffness_quadrature=partial(pyramid, 2),
    mass_quadrature=partial(pyramid, 3),
    faces=(
        (QUAD4, (0, 3, 2, 1)),
        (TRI3, (0, 1, 4)),
        (TRI3, (1, 2, 4)),
        (TRI3, (2, 3, 4)),
        (TRI3, (3, 0, 4)),
    ),
    elsewhere=Elsewhere(nastran="CPYRAM", abaqus={}, meshio="pyramid", vtk=14),
    brick_cells=(),
)
