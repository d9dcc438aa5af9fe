"""Eight-node brick, fully integrated (CHEXA with 2 x 2 x 2 points, C3D8)."""

from dataclasses import replace
from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD4
from faying.model.elements.quadrature import hexahedron
from faying.model.elements.solid_element import SolidElement

CORNERS = (
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0),
    (1.0, 1.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 1.0),
    (1.0, 1.0, 1.0),
    (0.0, 1.0, 1.0),
)
FACES = (
    (QUAD4, (0, 3, 2, 1)),
    (QUAD4, (4, 5, 6, 7)),
    (QUAD4, (0, 1, 5, 4)),
    (QUAD4, (1, 2, 6, 5)),
    (QUAD4, (2, 3, 7, 6)),
    (QUAD4, (3, 0, 4, 7)),
)
WHOLE = (tuple(range(8)),)

HEX8 = SolidElement(
    kind="hex8",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=8,
    shape_functions="ElementHex1",
    stiffness_quadrature=partial(hexahedron, 3),
    # N Nᵀ det J is of degree 4 in each coordinate of a trilinearly distorted brick.
    mass_quadrature=partial(hexahedron, 5),
    faces=FACES,
    elsewhere=Elsewhere(
        nastran="CHEXA",
        nastran_scheme=("TWO", "FULL"),
        abaqus={"C3D8": ""},
        meshio="hexahedron",
    ),
    brick_cells=WHOLE,
)


def incompatible_gradients(points: Matrix) -> Matrix:
    """Gradients of 1 - (2x - 1)² etc. on [0, 1]³: (n_quad, 3) to (n_quad, 3, 3)."""
    return (4.0 - 8.0 * points)[:, :, None] * np.eye(3)


HEX8_INCOMPATIBLE = replace(
    HEX8,
    formulation="incompatible",
    internal_gradients=incompatible_gradients,
    elsewhere=replace(
        HEX8.elsewhere,
        nastran_scheme=(None, None),
        abaqus={"C3D8I": ""},
    ),
)
"""Eight-node brick with incompatible modes (QM6), close to C3D8I.

Three internal modes 1 - ξ², 1 - η², 1 - ζ² per displacement component remove the parasitic shear
of the plain brick in bending: E. L. Wilson et al., "Incompatible displacement models", 1973. Their
gradients are taken with the Jacobian of the centre, scaled by det J₀ / det J, so that they vanish
in the mean and distorted bricks pass the patch test: R. L. Taylor, P. J. Beresford, E. L. Wilson,
"A non-conforming element for stress analysis", Int. J. Numer. Meth. Eng. 10 (1976) 1211-1219.
"""

_SIGNS = 2 * np.array(CORNERS) - 1

HEX8_REDUCED = replace(
    HEX8,
    formulation="reduced",
    hourglass_patterns=np.column_stack(
        [
            _SIGNS[:, 1] * _SIGNS[:, 2],
            _SIGNS[:, 2] * _SIGNS[:, 0],
            _SIGNS[:, 0] * _SIGNS[:, 1],
            _SIGNS.prod(axis=1),
        ]
    ),
    elsewhere=replace(
        HEX8.elsewhere,
        abaqus={
            "C3D8R": "uniform strain with the hourglass stiffness of CalculiX 2.20; later versions "
            "take more, Abaqus a fifth: bending of few layers differs"
        },
    ),
)

HEX8_REDUCED_ABAQUS = replace(
    HEX8_REDUCED,
    formulation="reduced-abaqus",
    hourglass_share=1e-4,
    elsewhere=replace(HEX8_REDUCED.elsewhere, abaqus={}),
)
"""Eight-node bricks of uniform strain with hourglass stiffness (C3D8R).

The stiffness is that of the mean strain of the cell; the four hourglass patterns are resisted by
springs of s E V Σ |b_i|², where b_i is the mean gradient of shape function i and V the volume:
D. P. Flanagan, T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
hourglass control", Int. J. Numer. Meth. Eng. 17 (1981) 679-706.

CalculiX 2.20 has s = 5e-4. Abaqus' manual does not state its value of s; s = 1e-4 gives the
frequencies of Abaqus 2023 for the free Brake-Reuss beam without contact (Abaqus4Joints by
N. N. Balaji, docs/abqtut.org): 70.323, 151.249, 609.250 for 70.323, 151.26, 609.25 Hz; 5e-4 gives
70.572, 151.763, 610.546.
"""
