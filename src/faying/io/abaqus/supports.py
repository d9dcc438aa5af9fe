"""``*BOUNDARY``: degrees of freedom held at zero."""

from collections.abc import Iterator

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs, component
from faying.io.abaqus.fields import optional_real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.loads import operation
from faying.model.assembly import Support

TYPES = {
    "XSYMM": (0, 4, 5),
    "YSYMM": (1, 3, 5),
    "ZSYMM": (2, 3, 4),
    "XASYMM": (1, 2, 3),
    "YASYMM": (0, 2, 4),
    "ZASYMM": (0, 1, 5),
    "PINNED": (0, 1, 2),
    "ENCASTRE": (0, 1, 2, 3, 4, 5),
}

Holds = dict[tuple[int, int], float]


def read_supports(deck: Deck, dofs: Dofs, apart: frozenset[int]) -> tuple[Support, ...]:
    """Return what is held in the step the deck has been cut to.

    Parameters
    ----------
    apart
        Nodes of pretension sections, whose boundary conditions lock a bolt.

    Raises
    ------
    FormatError
        Naming the line of a prescribed motion other than zero, or of an unknown node.
    """
    held: Holds = {}
    where: dict[tuple[int, int], tuple[Keyword, int]] = {}
    for keyword in deck.of("BOUNDARY"):
        keyword.allow("OP", "TYPE", "AMPLITUDE", "FIXED", "LOAD CASE")
        if keyword.choice("TYPE", "DISPLACEMENT") != "DISPLACEMENT" or keyword.has("LOAD CASE"):
            message = "only displacements are supported (no TYPE=VELOCITY, no LOAD CASE)"
            raise keyword.error(message)
        if operation(keyword):
            held = {place: v for place, v in held.items() if where[place][0].step == keyword.step}
        for row, fields in enumerate(keyword.rows()):
            for place, value in _line(keyword, row, fields, dofs):
                held[place] = value
                where[place] = keyword, row
    for place, value in held.items():
        if value != 0.0 and place[0] not in apart:
            keyword, row = where[place]
            message = (
                f"node {dofs.nodes.ids[place[0]]} is moved by {value:g}; only zero is supported. "
                "Apply a force, or tighten bolts by *PRE-TENSION SECTION with a *CLOAD"
            )
            raise keyword.error(message, row)
    return tuple(_supports(held, dofs, apart))


def _line(
    keyword: Keyword, row: int, fields: list[str], dofs: Dofs
) -> Iterator[tuple[tuple[int, int], float]]:
    expected = "node or node set, first and last degree of freedom, value"
    if not 2 <= len(fields) <= 4:
        message = f"found {len(fields)} fields, expected {expected}"
        raise keyword.error(message, row)
    nodes = dofs.find(keyword, row, fields[0])
    if fields[1].upper() in TYPES:
        if len(fields) > 2:
            message = f"found fields behind {fields[1]}; expected none"
            raise keyword.error(message, row)
        components, value = TYPES[fields[1].upper()], 0.0
    else:
        first = component(keyword, row, fields[1])
        last = component(keyword, row, fields[2]) if len(fields) > 2 and fields[2] else first
        if last < first:
            message = f"the last degree of freedom {last + 1} is below the first {first + 1}"
            raise keyword.error(message, row)
        components = tuple(range(first, last + 1))
        value = optional_real(keyword, row, fields, 3, 0.0, "a displacement")
    for c in components:
        for node in nodes.tolist():
            yield (node, c), value


def _supports(held: Holds, dofs: Dofs, apart: frozenset[int]) -> Iterator[Support]:
    """One support per set of components, and one per node with axes of its own."""
    by_node: dict[int, list[int]] = {}
    for node, c in held:
        if node not in apart:
            by_node.setdefault(node, []).append(c)
    groups: dict[tuple[int, ...], list[int]] = {}
    number = 1
    for node, components in by_node.items():
        axes = dofs.axes(node)
        if axes is None:
            for key, at in _placed(dofs, node, sorted(components)):
                groups.setdefault(key, []).append(at)
        else:
            yield Support(
                id=number, nodes=np.array([node]), components=tuple(sorted(components)), axes=axes
            )
            number += 1
    for key, nodes in groups.items():
        yield Support(id=number, nodes=_sorted(nodes), components=key)
        number += 1


def _placed(dofs: Dofs, node: int, components: list[int]) -> list[tuple[tuple[int, ...], int]]:
    places = [dofs.place(node, c) for c in components]
    owners = dict.fromkeys(owner for owner, _ in places)
    return [(tuple(c for at, c in places if at == owner), owner) for owner in owners]


def _sorted(nodes: list[int]) -> Indices:
    return np.unique(np.array(nodes, dtype=np.int64))
