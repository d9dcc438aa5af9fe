"""Finite elements: solids as values in a registry, beams, and the kernels that integrate them."""

from collections.abc import Mapping
from types import MappingProxyType

from faying.exceptions import ModelError
from faying.model.elements.hex8 import HEX8
from faying.model.elements.hex8_incompatible import HEX8_INCOMPATIBLE
from faying.model.elements.hex20 import HEX20
from faying.model.elements.solid_element import SolidElement
from faying.model.elements.tet4 import TET4
from faying.model.elements.tet10 import TET10
from faying.model.elements.wedge6 import WEDGE6
from faying.model.elements.wedge15 import WEDGE15

SOLIDS: Mapping[str, SolidElement] = MappingProxyType(
    {element.kind: element for element in (HEX8, HEX20, WEDGE6, WEDGE15, TET4, TET10)}
)
"""Mesh cell kind to its standard element."""

HEX8_FORMULATIONS: Mapping[str, SolidElement] = MappingProxyType(
    {element.formulation: element for element in (HEX8, HEX8_INCOMPATIBLE)}
)
"""Values of ``Assembly.element`` and the eight-node brick each stands for."""

ALL_SOLIDS = (*SOLIDS.values(), HEX8_INCOMPATIBLE)
"""Every element in every formulation."""


def solid_element(kind: str, formulation: str) -> SolidElement:
    """Return the element of a mesh cell kind; ``formulation`` decides between the two hex8.

    Raises
    ------
    ModelError
        If the kind or the formulation is not known.
    """
    if formulation not in HEX8_FORMULATIONS:
        known = " or ".join(f"'{name}'" for name in HEX8_FORMULATIONS)
        message = f"the hex8 formulation is '{formulation}'; it must be {known}"
        raise ModelError(message)
    if kind not in SOLIDS:
        message = f"there is no solid element '{kind}'; known kinds are {', '.join(SOLIDS)}"
        raise ModelError(message)
    return HEX8_FORMULATIONS[formulation] if kind == "hex8" else SOLIDS[kind]


__all__ = ["ALL_SOLIDS", "HEX8_FORMULATIONS", "SOLIDS", "SolidElement", "solid_element"]
