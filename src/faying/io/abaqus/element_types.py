"""Element types of both programs and what they are here."""

from collections.abc import Mapping

from faying.model.elements import ALL_SOLIDS, SOLIDS, SolidElement

SOLID_TYPES: Mapping[str, SolidElement] = {
    **{name: element for element in ALL_SOLIDS for name in element.elsewhere.abaqus},
    "C3D5": SOLIDS["pyramid5"],
    "C3D13": SOLIDS["pyramid13"],
}
"""Pyramids are read only: CalculiX has none."""

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
"""Nodes of elements that are neither solids nor shells."""

SHELL_TYPES: Mapping[str, tuple[str, int]] = {
    **dict.fromkeys(("S3", "S3R", "STRI3"), ("tri3", 3)),
    **dict.fromkeys(("S4", "S4R"), ("quad4", 4)),
    **dict.fromkeys(("S6", "STRI65"), ("tri6", 6)),
    **dict.fromkeys(("S8", "S8R"), ("quad8", 8)),
}
"""Kind of shells, and how many nodes they have."""
