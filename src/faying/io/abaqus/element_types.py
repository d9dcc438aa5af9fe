"""Element types of both programs and what they are here."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class SolidType:
    """A solid element type.

    Attributes
    ----------
    kind
        Kind of the mesh cell.
    order
        Position in the Abaqus record of each node in our (Nastran) order.
    formulation
        Of eight-node bricks, else empty.
    note
        What differs from the element of the deck; empty if nothing does.
    """

    kind: str
    order: tuple[int, ...]
    formulation: str = ""
    note: str = ""


# Abaqus numbers mid-side nodes bottom, top, upright; Nastran bottom, upright, top.
_HEX20 = (*range(12), *range(16, 20), *range(12, 16))
_WEDGE15 = (*range(9), *range(12, 15), *range(9, 12))
_FULL = "taken with full integration"

SOLID_TYPES: Mapping[str, SolidType] = {
    "C3D4": SolidType(kind="tet4", order=tuple(range(4))),
    "C3D6": SolidType(
        kind="wedge6",
        order=tuple(range(6)),
        note="integrated with 3 x 2 points (both programs take 1 x 2, which is softer)",
    ),
    "C3D8": SolidType(kind="hex8", order=tuple(range(8)), formulation="standard"),
    "C3D8I": SolidType(kind="hex8", order=tuple(range(8)), formulation="incompatible"),
    "C3D8R": SolidType(
        kind="hex8",
        order=tuple(range(8)),
        formulation="incompatible",
        note="reduced integration with hourglass control is taken as incompatible modes",
    ),
    "C3D10": SolidType(kind="tet10", order=tuple(range(10))),
    "C3D10M": SolidType(
        kind="tet10", order=tuple(range(10)), note="taken as the plain ten-node tetrahedron"
    ),
    "C3D15": SolidType(kind="wedge15", order=_WEDGE15),
    "C3D20": SolidType(kind="hex20", order=_HEX20),
    "C3D20R": SolidType(kind="hex20", order=_HEX20, note=_FULL),
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
