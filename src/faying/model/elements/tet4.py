"""Four-node tetrahedron of constant strain (CTETRA with four nodes, C3D4)."""

from functools import partial

from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import TRI3
from faying.model.elements.quadrature import tetrahedron
from faying.model.elements.solid_element import SolidElement

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SIXTHS = ((0, 1, 2, 6), (0, 5, 1, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 4, 5, 6), (0, 7, 4, 6))
"""Kuhn's simplicial division of a brick (H. W. Kuhn, IBM J. Res. Dev. 4 (1960) 518-524).

One tetrahedron for each path from corner 0 to corner 6 along edges; opposite faces are divided
along parallel diagonals, so that neighbours and touching bodies match.
"""

TET4 = SolidElement(
    kind="tet4",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=4,
    shape_functions="ElementTetP1",
    stiffness_quadrature=partial(tetrahedron, 1),
    mass_quadrature=partial(tetrahedron, 2),
    faces=(
        (TRI3, (0, 2, 1)),
        (TRI3, (0, 1, 3)),
        (TRI3, (1, 2, 3)),
        (TRI3, (2, 0, 3)),
    ),
    elsewhere=Elsewhere(nastran="CTETRA", abaqus={"C3D4": ""}, meshio="tetra"),
    brick_cells=SIXTHS,
)
