"""Eight-node brick of uniform strain with hourglass stiffness (C3D8R as CalculiX 2.20 has it).

The mean strain of the cell carries the stiffness; the four patterns it does not see are held by
springs of 0.0005 E V Σ |b_i|², where b_i is the mean gradient of shape function i and V the volume:
D. P. Flanagan, T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
hourglass control", Int. J. Numer. Meth. Eng. 17 (1981) 679-706.
"""

from dataclasses import replace

import numpy as np

from faying.model.elements.hex8 import CORNERS, HEX8

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
            "and Abaqus take more: bending of few layers differs"
        },
    ),
)
