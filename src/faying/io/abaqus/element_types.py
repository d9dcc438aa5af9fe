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
    "T3D2": 2,
    "SPRINGA": 2,
    "SPRING1": 1,
    "SPRING2": 2,
    "MASS": 1,
    "ROTARYI": 1,
    "DCOUP3D": 1,
    "DASHPOTA": 2,
    "DASHPOT1": 1,
    "DASHPOT2": 2,
}
"""Nodes of elements that are no solids."""
