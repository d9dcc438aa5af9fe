"""Eight-node bricks of uniform strain with hourglass stiffness (C3D8R).

The mean strain of the cell carries the stiffness; the four patterns it does not see are held by
springs of s E V Σ |b_i|², where b_i is the mean gradient of shape function i and V the volume:
D. P. Flanagan, T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
hourglass control", Int. J. Numer. Meth. Eng. 17 (1981) 679-706.

CalculiX 2.20 has s = 5e-4. Abaqus' manual does not tell its own in these terms; s = 1e-4 gives the
frequencies that Abaqus 2023 found of the free Brake-Reuss beam without contact (Abaqus4Joints by
N. N. Balaji, docs/abqtut.org): 70.323, 151.249, 609.250 for 70.323, 151.26, 609.25 Hz; 5e-4 gives
70.572, 151.763, 610.546.
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
            "take more, Abaqus a fifth: bending of few layers differs"
        },
    ),
)

HEX8_REDUCED_ABAQUS = replace(
    HEX8_REDUCED,
    formulation="reduced-abaqus",
    hourglass_share=1e-4,
    elsewhere=replace(HEX8_REDUCED.elsewhere, abaqus={}),
)
