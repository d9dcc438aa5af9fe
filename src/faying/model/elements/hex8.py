"""Eight-node brick, fully integrated (CHEXA with 2 x 2 x 2 points, C3D8)."""

from functools import partial

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
        vtk=12,
    ),
    brick_cells=WHOLE,
)
