"""Twenty-node serendipity brick, fully integrated (CHEXA with 3 x 3 x 3 points, C3D20).

Mid-side nodes in Nastran order: bottom edges 8-11, upright edges 12-15, top edges 16-19. Abaqus and
meshio number the top edges before the upright ones.
"""

from dataclasses import replace
from functools import partial

from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.hex8 import HEX8, WHOLE
from faying.model.elements.quadrature import hexahedron
from faying.model.elements.solid_element import SolidElement, mid_sided

_NODES, _FACES = mid_sided(HEX8, "01 12 23 30 04 15 26 37 45 56 67 74")

HEX20 = SolidElement(
    kind="hex20",
    reference_nodes=_NODES,
    n_corners=8,
    shape_functions="ElementHexS2",
    stiffness_quadrature=partial(hexahedron, 5),
    # Degree 2 + 2 from N Nᵀ and 2 from det J of straight edges, in each coordinate.
    mass_quadrature=partial(hexahedron, 7),
    faces=_FACES,
    elsewhere=Elsewhere(
        nastran="CHEXA",
        nastran_scheme=("THREE", "FULL"),
        nastran_lacks="reduced shear integration of CHEXA with 20 nodes (full integration is used)",
        abaqus={"C3D20": ""},
        meshio="hexahedron20",
        places=(*range(12), *range(16, 20), *range(12, 16)),
    ),
    brick_cells=WHOLE,
)

HEX20_REDUCED = replace(
    HEX20,
    formulation="reduced",
    stiffness_quadrature=partial(hexahedron, 3),
    elsewhere=replace(HEX20.elsewhere, abaqus={"C3D20R": ""}),
)
"""Twenty-node brick whose stiffness takes 2 x 2 x 2 points (C3D20R).

Softer than with full integration, and without its locking in thin bodies. A single element has six
zero-energy modes, two adjacent ones have none (O. C. Zienkiewicz, R. L. Taylor, J. M. Too,
"Reduced integration technique in general analysis of plates and shells", Int. J. Numer. Meth. Eng.
3 (1971) 275-290).
"""
