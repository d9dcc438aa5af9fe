"""Four-node tetrahedron of constant strain (CTETRA with four nodes, C3D4)."""

from functools import partial

from faying.model.elements.quadrature import tetrahedron
from faying.model.elements.solid_element import SolidElement

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

TET4 = SolidElement(
    kind="tet4",
    reference_nodes=CORNERS,  # type: ignore[arg-type]  # frozen into an array
    n_corners=4,
    shape_functions="ElementTetP1",
    stiffness_quadrature=partial(tetrahedron, 1),
    mass_quadrature=partial(tetrahedron, 2),
    faces=(
        ("tri3", (0, 2, 1)),
        ("tri3", (0, 1, 3)),
        ("tri3", (1, 2, 3)),
        ("tri3", (2, 0, 3)),
    ),
)
