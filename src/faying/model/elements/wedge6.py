"""Six-node wedge (CPENTA with six nodes, C3D6), integrated with 3 x 2 points."""

from functools import partial

from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD4, TRI3
from faying.model.elements.quadrature import wedge
from faying.model.elements.solid_element import SolidElement

CORNERS = (
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 1.0),
    (0.0, 1.0, 1.0),
)
HALVES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))
"""Halves of a brick, along the diagonal of its bottom."""

WEDGE6 = SolidElement(
    kind="wedge6",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=6,
    shape_functions="ElementWedge1",
    stiffness_quadrature=partial(wedge, 2, 3),
    # Degree 3 in the triangle and 4 along the axis; the triangle rule of order 3 has a negative
    # weight, that of order 4 has none.
    mass_quadrature=partial(wedge, 4, 5),
    faces=(
        (TRI3, (0, 2, 1)),
        (TRI3, (3, 4, 5)),
        (QUAD4, (0, 1, 4, 3)),
        (QUAD4, (1, 2, 5, 4)),
        (QUAD4, (2, 0, 3, 5)),
    ),
    elsewhere=Elsewhere(
        nastran="CPENTA",
        nastran_scheme=("TWO", "FULL"),
        nastran_lacks=(
            "bubble functions of CPENTA: the standard six-node wedge is stiffer in bending, one "
            "layer of them deflects a third to a half as far; use several, or CHEXA"
        ),
        abaqus={"C3D6": "integrated with 3 x 2 points (both programs take 1 x 2, which is softer)"},
        meshio="wedge",
    ),
    brick_cells=HALVES,
)
