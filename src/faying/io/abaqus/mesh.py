"""``*NODE`` and ``*ELEMENT``: coordinates, and elements by type."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import refuse
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import integers, lines, reals, table
from faying.io.abaqus.keyword import Keyword
from faying.io.frames import BASIC, Frame
from faying.model.axes import axes_along
from faying.model.elements import ALL_SOLIDS, SOLIDS, SolidElement


@dataclass(frozen=True, eq=False, kw_only=True)
class Nodes:
    """All nodes, sorted by id.

    Attributes
    ----------
    ids : (n_node,)
        Increasing.
    coordinates : (n_node, 3) [length]
    """

    ids: Indices
    coordinates: Matrix

    def index(self, ids: Indices, keyword: Keyword, rows: Indices) -> Indices:
        """Return the indices of node ids; ``rows`` are their data lines, for messages."""
        index: Indices = np.minimum(np.searchsorted(self.ids, ids), len(self.ids) - 1)
        wrong = np.flatnonzero(self.ids[index] != ids)
        if wrong.size:
            shown = int(ids[wrong[0]]) - keyword.scope.offset
            keyword.refuse(
                f"there is no node {shown}; define it under *NODE or correct the id",
                int(rows[wrong[0]]),
            )
        return index


def read_nodes(deck: Deck) -> Nodes:
    """Read all *NODE, with the *SYSTEM in force and the position of their instance."""
    ids, coordinates, owners, rows = [], [], [], []
    system = BASIC
    for keyword in deck.of("NODE", "SYSTEM"):
        if keyword.name == "SYSTEM":
            system = _system(keyword)
            continue
        numbers, points, lines = _node_block(keyword, system, deck.ignored)
        owners.append(keyword)
        ids.append(numbers + keyword.scope.offset)
        coordinates.append(points)
        rows.append(lines)
    if not ids or not sum(map(len, ids)):
        refuse(f"{deck.path}: the deck has no nodes; it needs *NODE with data lines")
    all_ids, points = np.concatenate(ids), np.concatenate(coordinates)
    for block, row in _repeated(ids):
        owners[block].refuse(
            f"node {ids[block][row]} is defined twice; remove one definition", int(rows[block][row])
        )
    order = np.argsort(all_ids, kind="stable")
    return Nodes(ids=all_ids[order], coordinates=points[order])


def located(parts: Sequence[Indices], position: int) -> tuple[int, int]:
    """Return the part, and the position in it, of a position in all parts joined."""
    ends = np.cumsum([len(part) for part in parts])
    part = int(np.searchsorted(ends, position, side="right"))
    return part, position - int(ends[part]) + len(parts[part])


def _node_block(
    keyword: Keyword, system: Frame, ignored: list[str]
) -> tuple[Indices, Matrix, Indices]:
    if keyword.has("INPUT"):
        keyword.refuse("INPUT= is not supported; use *INCLUDE, INPUT=… below *NODE")
    expected = "id, x, y, z"
    columns, counts = table(keyword).columns(1, 7, f"{expected}, and a normal at most")
    if (counts > 4).any():
        ignored.append(
            f"{int((counts > 4).sum())} nodes with fields after their coordinates (the first at "
            f"{keyword.where(int((counts > 4).argmax()))}): their normals are not read"
        )
    # Nodes without coordinates have no place, such as nodes of pretension sections.
    short = np.flatnonzero((counts > 1) & (counts < 4))
    if short.size:
        # Both programs read zeros; a missing coordinate is noted.
        ignored.append(
            f"{len(short)} nodes with fewer than three coordinates (the first at "
            f"{keyword.where(int(short[0]))}): those left out are zero"
        )
    rows = np.arange(len(keyword.data), dtype=np.int64)
    ids = integers(columns[0], keyword, rows, "a node id")
    if ids.size and ids.min() < 1:
        keyword.refuse(f"node id {ids.min()}; ids are positive", int(ids.argmin()))
    points = np.column_stack([reals(c, keyword, rows, "a coordinate") for c in columns[1:4]])
    kind = SYSTEMS[keyword.choice("SYSTEM")]
    points = system.to_basic(replace(BASIC, kind=kind).to_basic(points))
    return ids, points @ keyword.scope.rotation.T + keyword.scope.translation, rows


SYSTEMS = {"R": "R", "C": "C", "S": "E"}
"""Kinds of :class:`faying.io.frames.Frame`, by kinds of systems of nodes."""


def _system(keyword: Keyword) -> Frame:
    """Return the system of local coordinates; the basic one without data."""
    rows = lines(keyword)
    if not rows:
        return BASIC
    values = [line.padded(6, "a coordinate") for line in rows[:2]]
    origin = values[0][:3]
    x = values[0][3:] - origin
    # Without a second line z is unchanged and y is normal to z and x.
    y = values[1][:3] - origin if len(rows) > 1 else np.cross([0.0, 0.0, 1.0], x)
    axes = axes_along(x, y)
    if len(rows) > 2 or axes is None:
        keyword.refuse(
            "expected the origin and a point on the x axis, then a point in the x-y plane", 0
        )
    return Frame(kind="R", origin=origin, axes=axes)


SOLID_TYPES: Mapping[str, SolidElement] = {
    **{name: element for element in ALL_SOLIDS for name in element.elsewhere.abaqus},
    "C3D5": SOLIDS["pyramid5"],
    "C3D13": SOLIDS["pyramid13"],
}
"""Solid elements by type; pyramids are only read, since CalculiX has none."""

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
"""Number of nodes of elements that are neither solids nor shells."""

SHELL_TYPES: Mapping[str, tuple[str, int]] = {
    **dict.fromkeys(("S3", "S3R", "STRI3"), ("tri3", 3)),
    **dict.fromkeys(("S4", "S4R"), ("quad4", 4)),
    **dict.fromkeys(("S6", "STRI65"), ("tri6", 6)),
    **dict.fromkeys(("S8", "S8R"), ("quad8", 8)),
}
"""Kind and number of nodes of shell types."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementBlock:
    """The elements of an *ELEMENT keyword.

    Attributes
    ----------
    type
        Type as in the deck, upper case.
    ids : (n_element,)
    nodes : (n_element, n_node_per_element)
        Node indices; solids in the node order of faying.
    rows : (n_element,)
        Data line of each element.
    """

    type: str
    ids: Indices
    nodes: Indices
    rows: Indices
    keyword: Keyword


@dataclass(frozen=True, eq=False, kw_only=True)
class Elements:
    """The elements of a deck: solids, and others by type."""

    solids: tuple[ElementBlock, ...]
    others: Mapping[str, tuple[ElementBlock, ...]]

    def of(self, *types: str) -> list[ElementBlock]:
        """Return the blocks of types other than solids."""
        return [block for name in types for block in self.others.get(name, ())]

    def without(self, ids: Indices) -> "Elements":
        """Return the elements without some ids and without empty blocks."""

        def kept(blocks: tuple[ElementBlock, ...]) -> tuple[ElementBlock, ...]:
            masks = [~np.isin(block.ids, ids) for block in blocks]
            return tuple(
                replace(block, ids=block.ids[m], nodes=block.nodes[m], rows=block.rows[m])
                for block, m in zip(blocks, masks, strict=True)
                if m.any()
            )

        others = {name: kept(blocks) for name, blocks in self.others.items()}
        return Elements(
            solids=kept(self.solids),
            others={name: blocks for name, blocks in others.items() if blocks},
        )

    @property
    def blocks(self) -> list[ElementBlock]:
        """All blocks."""
        return [*self.solids, *(block for blocks in self.others.values() for block in blocks)]


def read_elements(deck: Deck, nodes: Nodes) -> Elements:
    """Read all *ELEMENT."""
    solids: list[ElementBlock] = []
    others: dict[str, tuple[ElementBlock, ...]] = {}
    for keyword in deck.of("ELEMENT"):
        if keyword.has("DLOAD"):
            keyword.refuse(
                "shells that only transfer loads (DLOAD) to the solids beneath them are not "
                "supported; load faces of solids by *DSLOAD or P1 … P6 of *DLOAD"
            )
        block = _block(keyword, nodes, deck.ignored)
        if block.type in SOLID_TYPES:
            solids.append(block)
        else:
            others[block.type] = (*others.get(block.type, ()), block)
    result = Elements(solids=tuple(solids), others=others)
    blocks = result.blocks
    for number, row in _repeated([block.ids for block in blocks]):
        blocks[number].keyword.refuse(
            f"element {blocks[number].ids[row]} is defined twice; give it another id",
            int(blocks[number].rows[row]),
        )
    if not blocks:
        refuse(f"{deck.path}: the deck has no elements; it needs *ELEMENT with data lines")
    return result


def _block(keyword: Keyword, nodes: Nodes, ignored: list[str]) -> ElementBlock:
    kind = keyword.required("TYPE").upper()
    if kind in SOLID_TYPES:
        size = SOLID_TYPES[kind].n_nodes
    elif kind in LINE_TYPES:
        size = LINE_TYPES[kind]
    elif kind in SHELL_TYPES:
        size = SHELL_TYPES[kind][1]
    else:
        supported = ", ".join([*SOLID_TYPES, *LINE_TYPES, *SHELL_TYPES])
        keyword.refuse(f"elements of TYPE={kind} are not supported; supported are {supported}")
    width = size + 1
    if not keyword.data:
        keyword.refuse("it has no data lines; give element ids and nodes, or remove it")
    fields = table(keyword)
    cropped = fields.cropped(width)
    if cropped is not fields:
        ignored.append(f"fields after the {size} nodes of {kind}, which CalculiX ignores too")
    texts, rows = cropped.records(width, f"an id and {size} nodes for each {kind}")
    flat = integers(texts.ravel(), keyword, np.repeat(rows, width), "an id or a node of an element")
    values = flat.reshape(-1, width)
    if values.size and values[:, 0].min() < 1:
        keyword.refuse(
            f"element id {values[:, 0].min()}; ids are positive", int(rows[values[:, 0].argmin()])
        )
    offset = keyword.scope.offset
    ends = values[:, 1:]
    if kind in SOLID_TYPES:
        ends = SOLID_TYPES[kind].elsewhere.ours(ends)
    index = nodes.index(ends.ravel() + offset, keyword, np.repeat(rows, size))
    block = ElementBlock(
        type=kind,
        ids=values[:, 0] + offset,
        nodes=index.reshape(ends.shape),
        rows=rows,
        keyword=keyword,
    )
    _check_own_nodes(block)
    return block


def _check_own_nodes(block: ElementBlock) -> None:
    """Refuse elements that have a node twice."""
    ordered = np.sort(block.nodes, axis=1)
    twice = np.flatnonzero((np.diff(ordered, axis=1) == 0).any(axis=1))
    if twice.size:
        first = int(twice[0])
        block.keyword.refuse(
            f"element {block.ids[first]} has a node twice; collapsed elements are not "
            "supported, use a wedge or a tetrahedron",
            int(block.rows[first]),
        )


def _repeated(parts: Sequence[Indices]) -> Iterator[tuple[int, int]]:
    """Yield part and position of each repeated id."""
    ids = np.concatenate([np.empty(0, dtype=np.int64), *parts])
    order = np.argsort(ids, kind="stable")
    again = np.flatnonzero(np.diff(ids[order]) == 0)
    return (located(parts, int(position)) for position in order[again + 1])
