"""Element types of both programs and what they are here."""

from collections.abc import Mapping

from faying.model.elements import ALL_SOLIDS, SolidElement

SOLID_TYPES: Mapping[str, SolidElement] = {
    name: element for element in ALL_SOLIDS for name in element.elsewhere.abaqus
}

LINE_TYPES: Mapping[str, int] = {
    "B31": 2,
    "B31R": 2,
    "B33": 2,
    "B32": 3,
    "B32R": 3,
    "SPRINGA": 2,
    "SPRING1": 1,
    "SPRING2": 2,
    "MASS": 1,
    "ROTARYI": 1,
    "DCOUP3D": 1,
}
"""Nodes of elements that are no solids."""

REMEDIES: Mapping[str, str] = {
    "T3D2": "use B31 or SPRING2",
    "T3D3": "use B31 or SPRING2",
    "C3D20I": "use C3D20",
    "C3D8H": "use C3D8 or C3D8I; hybrid elements are not supported",
    "C3D10H": "use C3D10; hybrid elements are not supported",
    "CONN3D2": "use *COUPLING, *MPC or *EQUATION",
    "GAPUNI": "use *CONTACT PAIR",
    "DASHPOTA": "remove it and give damping in the study",
    "C3D5": "mesh with hexahedra, wedges or tetrahedra",
}
