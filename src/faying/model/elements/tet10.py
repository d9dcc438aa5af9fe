"""Ten-node tetrahedron (CTETRA with ten nodes, C3D10).

Mid-side nodes 4-9 lie on the edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3.
"""

from functools import partial

from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.quadrature import tetrahedron
from faying.model.elements.solid_element import SolidElement, mid_sided
from faying.model.elements.tet4 import SIXTHS, TET4

_NODES, _FACES = mid_sided(TET4, "01 12 20 03 13 23")

TET10 = SolidElement(
    kind="tet10",
    reference_nodes=_NODES,
    n_corners=4,
    shape_functions="ElementTetP2",
    stiffness_quadrature=partial(tetrahedron, 2),
    # Order 4 suffices for straight edges, but that rule has a negative weight, and the mass of a
    # curved element must stay positive definite.
    mass_quadrature=partial(tetrahedron, 5),
    faces=_FACES,
    elsewhere=Elsewhere(
        nastran="CTETRA",
        abaqus={"C3D10": "", "C3D10M": "taken as the plain ten-node tetrahedron"},
        meshio="tetra10",
    ),
    brick_cells=SIXTHS,
)
