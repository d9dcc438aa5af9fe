"""Twenty-node brick whose stiffness takes 2 x 2 x 2 points (C3D20R).

Softer than with full integration, and without its locking in thin bodies. Alone it has six motions
without energy; two elements side by side hold them (O. C. Zienkiewicz, R. L. Taylor, J. M. Too,
"Reduced integration technique in general analysis of plates and shells", Int. J. Numer. Meth. Eng.
3 (1971) 275-290).
"""

from dataclasses import replace
from functools import partial

from faying.model.elements.hex20 import HEX20
from faying.model.elements.quadrature import hexahedron

HEX20_REDUCED = replace(
    HEX20,
    formulation="reduced",
    stiffness_quadrature=partial(hexahedron, 3),
    elsewhere=replace(HEX20.elsewhere, abaqus={"C3D20R": ""}),
)
