"""Fifteen-node serendipity wedge (CPENTA with fifteen nodes, C3D15), integrated with 3 x 3 points.

Mid-side nodes in Nastran order: bottom edges 6-8, upright edges 9-11, top edges 12-14. Abaqus and
meshio number the top edges before the upright ones.
"""

from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.quadrature import wedge
from faying.model.elements.solid_element import SolidElement, mid_sided
from faying.model.elements.wedge6 import HALVES, WEDGE6

_NODES, _FACES = mid_sided(WEDGE6, "01 12 20 03 14 25 34 45 53")

_BARYCENTRIC_GRADIENTS = np.array([[-1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
_NEXT = np.array([1, 2, 0])


def serendipity_wedge(points: Matrix) -> tuple[Matrix, Matrix]:
    """Return values (n_point, 15) and gradients (n_point, 3, 15) of the fifteen-node wedge.

    With barycentric coordinates L of the triangle, height z in [0, 1] and m = 1 - z at the bottom
    (m = z at the top): corners L m (2L - 1) - 2 L z (1 - z), mid-sides of the triangles 4 L_i L_j
    m, upright mid-sides 4 L z (1 - z). Zienkiewicz, Taylor, Zhu, The Finite Element Method, vol. 1,
    quadratic prism of the serendipity family.
    """
    x, y, z = np.asarray(points, dtype=float).T[:, :, None]
    plane, slope = np.hstack([1 - x - y, x, y]), _BARYCENTRIC_GRADIENTS.T
    upright = np.array([0.0, 0.0, 1.0])[:, None]
    following, following_slope = plane[:, _NEXT], slope[:, _NEXT]
    bulge, bulge_slope = 4 * z * (1 - z), 4 * (1 - 2 * z)
    values, gradients = {}, {}
    middle_value = plane * bulge
    middle = bulge[:, None] * slope + (plane * bulge_slope)[:, None] * upright
    for level, (share, rate) in {"bottom": (1 - z, -1.0), "top": (z, 1.0)}.items():
        values[level] = plane * (2 * plane - 1) * share - middle_value / 2
        gradients[level] = (
            ((4 * plane - 1) * share)[:, None] * slope
            + (plane * (2 * plane - 1) * rate)[:, None] * upright
            - middle / 2
        )
        values[f"{level} edges"] = 4 * plane * following * share
        gradients[f"{level} edges"] = (
            4 * share[:, None] * (slope * following[:, None] + plane[:, None] * following_slope)
            + (4 * plane * following * rate)[:, None] * upright
        )
    values["upright edges"], gradients["upright edges"] = middle_value, middle
    order = ("bottom", "top", "bottom edges", "upright edges", "top edges")
    return (
        np.concatenate([values[part] for part in order], axis=-1),
        np.concatenate([gradients[part] for part in order], axis=-1),
    )


WEDGE15 = SolidElement(
    kind="wedge15",
    reference_nodes=_NODES,
    n_corners=6,
    shape_functions=serendipity_wedge,
    # The nine points of C3D15: exact for constant strain and free of spurious modes.
    stiffness_quadrature=partial(wedge, 2, 5),
    # Degree 2 + 2 from N Nᵀ and 2 from det J of straight edges, in the triangle and along the axis.
    mass_quadrature=partial(wedge, 6, 7),
    faces=_FACES,
    elsewhere=Elsewhere(
        nastran="CPENTA",
        nastran_scheme=("THREE", "FULL"),
        nastran_lacks="reduced shear integration of CPENTA with 15 nodes (3 x 3 points are used)",
        abaqus={"C3D15": ""},
        meshio="wedge15",
        places=(*range(9), *range(12, 15), *range(9, 12)),
    ),
    brick_cells=HALVES,
)
