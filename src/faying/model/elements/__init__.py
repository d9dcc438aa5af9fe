"""Finite elements: solids in a registry, beams, shells, and their integration."""

from collections.abc import Mapping
from types import MappingProxyType

from faying.exceptions import check_known, refuse_model
from faying.model.cells import CellBlock
from faying.model.elements.face_kind import FaceKind
from faying.model.elements.hex8 import HEX8, HEX8_INCOMPATIBLE, HEX8_REDUCED, HEX8_REDUCED_ABAQUS
from faying.model.elements.hex20 import HEX20, HEX20_REDUCED
from faying.model.elements.pyramid import PYRAMID5, PYRAMID13
from faying.model.elements.solid_element import SolidElement
from faying.model.elements.tet4 import TET4
from faying.model.elements.tet10 import TET10
from faying.model.elements.wedge6 import WEDGE6
from faying.model.elements.wedge15 import WEDGE15

SOLIDS: Mapping[str, SolidElement] = MappingProxyType(
    {
        element.kind: element
        for element in (HEX8, HEX20, WEDGE6, WEDGE15, PYRAMID5, PYRAMID13, TET4, TET10)
    }
)
"""Mesh cell kind to its standard element."""

FACES: Mapping[str, FaceKind] = MappingProxyType(
    {
        face.name: face
        for face in sorted(
            {face for element in SOLIDS.values() for face, _ in element.faces},
            key=lambda face: face.n_nodes,
        )
    }
)
"""Kinds of faces of the solids by name, those of fewest nodes first."""

HEX8_FORMULATIONS: Mapping[str, SolidElement] = MappingProxyType(
    {
        element.formulation: element
        for element in (HEX8, HEX8_INCOMPATIBLE, HEX8_REDUCED, HEX8_REDUCED_ABAQUS)
    }
)
"""Values of ``Assembly.element``, and the eight-node brick of each."""

ALL_SOLIDS = (
    *SOLIDS.values(),
    *(HEX8_INCOMPATIBLE, HEX8_REDUCED, HEX8_REDUCED_ABAQUS, HEX20_REDUCED),
)
"""Every element in every formulation."""

_VARIANTS = {(element.kind, element.formulation): element for element in ALL_SOLIDS}


def solid_element(kind: str, formulation: str) -> SolidElement:
    """Return the element of a mesh cell kind in a formulation; most kinds have one formulation.

    Raises
    ------
    ModelError
        If the kind or the formulation is not known.
    """
    if formulation not in HEX8_FORMULATIONS:
        choices = " or ".join(f"'{name}'" for name in HEX8_FORMULATIONS)
        refuse_model(f"the hex8 formulation is '{formulation}'; it must be {choices}")
    check_known(kind, SOLIDS, "solid element")
    return _VARIANTS.get((kind, formulation), SOLIDS[kind])


def block_element(block: CellBlock, formulation: str) -> SolidElement:
    """Return the element of a block, in its formulation, or else in that of the assembly."""
    if not block.formulation:
        return solid_element(block.kind, formulation)
    if (block.kind, block.formulation) not in _VARIANTS:
        refuse_model(f"there is no '{block.formulation}' formulation of {block.kind}")
    return _VARIANTS[block.kind, block.formulation]


__all__ = [
    "ALL_SOLIDS",
    "FACES",
    "HEX8_FORMULATIONS",
    "SOLIDS",
    "SolidElement",
    "block_element",
    "solid_element",
]
