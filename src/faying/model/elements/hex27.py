"""Toy: twenty-seven-node brick."""

from functools import partial

from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import FaceKind
from faying.model.elements.hex8 import CORNERS
from faying.model.elements.hex20 import HEX20, MIDSIDES
from faying.model.elements.quadrature import hexahedron
from faying.model.elements.solid_element import SolidElement

QUAD9 = FaceKind(
    name="quad9",
    n_nodes=9,
    n_corners=4,
    shape_functions="ElementQuad2",
    degree=2,
    total_degree=4,
    nodal_weights=(1 / 36,) * 4 + (4 / 36,) * 4 + (16 / 36,),
    cells=((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
    meshio="quad9",
    vtk=28,
)
CENTRES = (
    (0.5, 0.5, 0.0),
    (0.5, 0.5, 1.0),
    (0.5, 0.0, 0.5),
    (1.0, 0.5, 0.5),
    (0.5, 1.0, 0.5),
    (0.0, 0.5, 0.5),
    (0.5, 0.5, 0.5),
)

HEX27 = SolidElement(
    kind="hex27",
    reference_nodes=CORNERS + MIDSIDES + CENTRES,
    n_corners=8,
    shape_functions="ElementHex2",
    stiffness_quadrature=partial(hexahedron, 5),
    mass_quadrature=partial(hexahedron, 7),
    faces=tuple((QUAD9, (*local, 20 + k)) for k, (_, local) in enumerate(HEX20.faces)),
    elsewhere=Elsewhere(
        nastran="",
        abaqus={"C3D27": ""},
        meshio="hexahedron27",
        vtk=29,
        places=(*range(12), *range(16, 20), *range(12, 16), 24, 25, 22, 21, 23, 20, 26),
    ),
    brick_cells=(),
)
