"""``*SPRING``: linear springs along one component."""

from collections.abc import Iterator

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.fields import integer, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets
from faying.model.assembly import Spring

# Ends of an axial spring off a coordinate axis by less than this fraction of its length.
_ALIGNED = 1e-6


def read_springs(
    deck: Deck, elements: Elements, sets: NamedSets, coordinates: Matrix
) -> Iterator[Spring]:
    """Read SPRING1, SPRING2 and axis-parallel SPRINGA.

    Raises
    ------
    FormatError
        Naming the line of a nonlinear or inclined spring, or one without *SPRING.
    """
    stiffness: dict[int, Keyword] = {}
    for keyword in deck.of("SPRING"):
        keyword.allow("ELSET")
        for element_id in sets.find(keyword, keyword.required("ELSET")).tolist():
            if element_id in stiffness:
                message = f"spring {element_id} has a stiffness already; remove one of them"
                raise keyword.error(message)
            stiffness[element_id] = keyword
    for block in elements.of("SPRING1", "SPRING2", "SPRINGA"):
        for i, element_id in enumerate(block.ids.tolist()):
            if element_id not in stiffness:
                message = f"spring {element_id} has no *SPRING; give its set one"
                raise block.keyword.error(message, int(block.rows[i]))
            yield _spring(block, i, stiffness[element_id], coordinates)


def _spring(block: ElementBlock, i: int, keyword: Keyword, coordinates: Matrix) -> Spring:
    rows = keyword.rows()
    if len(rows) != 2 and not (block.type == "SPRINGA" and len(rows) == 1):
        message = (
            f"found {len(rows)} data lines, expected the degrees of freedom (blank for SPRINGA) "
            "and one stiffness; nonlinear springs are not supported"
        )
        raise keyword.error(message)
    value = real(keyword, len(rows) - 1, rows[-1][0], "a stiffness")
    if any(rows[-1][1:]):
        message = "a stiffness that depends on frequency or temperature is not supported"
        raise keyword.error(message, len(rows) - 1)
    nodes = block.nodes[i].tolist()
    if block.type == "SPRINGA":
        components = [_axis(block, i, coordinates)] * 2
    else:
        expected = len(nodes)
        if len(rows[0]) != expected:
            message = f"found {len(rows[0])} degrees of freedom, {block.type} needs {expected}"
            raise keyword.error(message, 0)
        components = [_component(keyword, text) for text in rows[0]]
    ends = tuple(zip(nodes, components, strict=True))
    return Spring(id=int(block.ids[i]), ends=ends, stiffness=value)


def _component(keyword: Keyword, text: str) -> int:
    value = integer(keyword, 0, text, "a degree of freedom")
    if not 1 <= value <= 6:
        message = f"found degree of freedom {value}, expected 1 to 6"
        raise keyword.error(message, 0)
    return value - 1


def _axis(block: ElementBlock, i: int, coordinates: Matrix) -> int:
    """Component of an axial spring parallel to a coordinate axis."""
    apart = coordinates[block.nodes[i, 1]] - coordinates[block.nodes[i, 0]]
    component = int(np.abs(apart).argmax())
    others = np.delete(np.abs(apart), component)
    if not others.max() <= _ALIGNED * abs(apart[component]) or not apart.any():
        message = (
            f"SPRINGA {block.ids[i]} is not parallel to a coordinate axis; use a B31 beam, or "
            "SPRING2 along one component"
        )
        raise block.keyword.error(message, int(block.rows[i]))
    return component
