"""Eight-node brick with incompatible modes (QM6), close to C3D8I.

Three internal modes 1 - ξ², 1 - η², 1 - ζ² per displacement component remove the parasitic shear
of the plain brick in bending: E. L. Wilson et al., "Incompatible displacement models", 1973. Their
gradients are taken with the Jacobian of the centre, scaled by det J₀ / det J, so that they vanish
in the mean and distorted bricks pass the patch test: R. L. Taylor, P. J. Beresford, E. L. Wilson,
"A non-conforming element for stress analysis", Int. J. Numer. Meth. Eng. 10 (1976) 1211-1219.
"""

from dataclasses import replace

import numpy as np

from faying._typing import Matrix
from faying.model.elements.hex8 import HEX8


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
