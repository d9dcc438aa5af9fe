"""``*SPRING``: linear springs along one component."""

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.fields import integer, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets
from faying.model.assembly import Bush, Spring

# Ends of an axial spring off a coordinate axis by less than this fraction of its length.
_ALIGNED = 1e-6


def read_springs(
    deck: Deck, elements: Elements, sets: NamedSets, coordinates: Matrix
) -> tuple[tuple[Spring, ...], tuple[Bush, ...]]:
    """Read SPRING1, SPRING2 and SPRINGA; those off the coordinate axes are bushes."""
    stiffness: dict[int, Keyword] = {}
    for keyword in deck.of("SPRING"):
        keyword.allow("ELSET")
        for element_id in sets.find(keyword, keyword.required("ELSET")).tolist():
            if element_id in stiffness:
                keyword.refuse(f"spring {element_id} has a stiffness already; remove one of them")
            stiffness[element_id] = keyword
    springs: list[Spring] = []
    bushes: list[Bush] = []
    for block in elements.of("SPRING1", "SPRING2", "SPRINGA"):
        for i, element_id in enumerate(block.ids.tolist()):
            if element_id not in stiffness:
                block.keyword.refuse(
                    f"spring {element_id} has no *SPRING; give its set one", int(block.rows[i])
                )
            spring = _spring(block, i, stiffness[element_id], coordinates)
            if isinstance(spring, Bush):
                bushes.append(spring)
            else:
                springs.append(spring)
    return tuple(springs), tuple(bushes)


def _spring(block: ElementBlock, i: int, keyword: Keyword, coordinates: Matrix) -> Spring | Bush:
    rows = keyword.rows()
    if len(rows) != 2 and not (block.type == "SPRINGA" and len(rows) == 1):
        keyword.refuse(
            f"found {len(rows)} data lines, expected the degrees of freedom (blank for SPRINGA) "
            "and one stiffness; nonlinear springs are not supported"
        )
    value = real(keyword, len(rows) - 1, rows[-1][0], "a stiffness")
    if any(rows[-1][1:]):
        keyword.refuse(
            "a stiffness that depends on frequency or temperature is not supported", len(rows) - 1
        )
    nodes = block.nodes[i].tolist()
    if block.type == "SPRINGA":
        axis = _axis(block, i, coordinates)
        if axis is None:
            return _inclined(block, i, value, coordinates)
        components = [axis] * 2
    else:
        expected = len(nodes)
        if len(rows[0]) != expected:
            keyword.refuse(
                f"found {len(rows[0])} degrees of freedom, {block.type} needs {expected}", 0
            )
        components = [_component(keyword, text) for text in rows[0]]
    ends = tuple(zip(nodes, components, strict=True))
    return Spring(id=int(block.ids[i]), ends=ends, stiffness=value)


def _component(keyword: Keyword, text: str) -> int:
    value = integer(keyword, 0, text, "a degree of freedom")
    if not 1 <= value <= 6:
        keyword.refuse(f"found degree of freedom {value}, expected 1 to 6", 0)
    return value - 1


def _axis(block: ElementBlock, i: int, coordinates: Matrix) -> int | None:
    """Component of an axial spring parallel to a coordinate axis; None for any other."""
    apart = coordinates[block.nodes[i, 1]] - coordinates[block.nodes[i, 0]]
    if not apart.any():
        block.keyword.refuse(
            f"SPRINGA {block.ids[i]} has no direction, for its nodes coincide; use SPRING2",
            int(block.rows[i]),
        )
    component = int(np.abs(apart).argmax())
    others = np.delete(np.abs(apart), component)
    return component if others.max() <= _ALIGNED * abs(apart[component]) else None


def _inclined(block: ElementBlock, i: int, stiffness: float, coordinates: Matrix) -> Bush:
    """Return an axial spring along the line between its nodes."""
    start, end = block.nodes[i].tolist()
    along = (coordinates[end] - coordinates[start]) / np.linalg.norm(
        coordinates[end] - coordinates[start]
    )
    side = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
    side /= np.linalg.norm(side)
    first, second, third = (
        (float(row[0]), float(row[1]), float(row[2]))
        for row in (along, side, np.cross(along, side))
    )
    x, y, z = coordinates[start].tolist()
    return Bush(
        id=int(block.ids[i]),
        nodes=(start, end),
        stiffness=(stiffness, 0.0, 0.0, 0.0, 0.0, 0.0),
        axes=(first, second, third),
        place=(x, y, z),
    )
