"""``*SPRING``: linear springs along one component."""

import numpy as np

from faying._typing import Matrix
from faying.digits import DECK_DIGITS
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import component
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.fields import check_count, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets, assign
from faying.model.assembly import Bush, Spring
from faying.model.axes import any_across, axes_along


def read_springs(
    deck: Deck, elements: Elements, sets: NamedSets, coordinates: Matrix
) -> tuple[tuple[Spring, ...], tuple[Bush, ...]]:
    """Read SPRING1, SPRING2 and SPRINGA; those off the coordinate axes are bushes."""
    stiffness: dict[int, Keyword] = {}
    for keyword in deck.of("SPRING"):
        keyword.check()
        assign(stiffness, keyword, sets, keyword)
    springs: list[Spring] = []
    bushes: list[Bush] = []
    for block in elements.of("SPRING1", "SPRING2", "SPRINGA"):
        for i in range(len(block.ids)):
            spring = _spring(block, i, block.section(i, stiffness, "SPRING"), coordinates)
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
        check_count(keyword, 0, rows[0], (len(nodes),), f"{len(nodes)} degrees of freedom")
        components = [component(keyword, 0, text) for text in rows[0]]
    ends = tuple(zip(nodes, components, strict=True))
    return Spring(id=int(block.ids[i]), ends=ends, stiffness=value)


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
    return component if others.max() <= DECK_DIGITS * abs(apart[component]) else None


def _inclined(block: ElementBlock, i: int, stiffness: float, coordinates: Matrix) -> Bush:
    """Return an axial spring along the line between its nodes."""
    start, end = block.nodes[i].tolist()
    along = coordinates[end] - coordinates[start]
    side = np.cross(along, any_across(along))
    first, second, third = (
        (float(row[0]), float(row[1]), float(row[2])) for row in np.asarray(axes_along(along, side))
    )
    x, y, z = coordinates[start].tolist()
    return Bush(
        id=int(block.ids[i]),
        nodes=(start, end),
        stiffness=(stiffness, 0.0, 0.0, 0.0, 0.0, 0.0),
        axes=(first, second, third),
        place=(x, y, z),
    )
