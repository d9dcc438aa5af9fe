"""``*ELEMENT``: solids as blocks of cells, and tables of all other elements."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices
from faying.exceptions import FormatError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.element_types import LINE_TYPES, SHELL_TYPES, SOLID_TYPES
from faying.io.abaqus.fields import integers, table
from faying.io.abaqus.keyword import Keyword, T
from faying.io.abaqus.nodes import Nodes


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementBlock:
    """Elements of one *ELEMENT.

    Attributes
    ----------
    type
        As in the deck, upper case.
    ids : (n_element,)
    nodes : (n_element, n_node_per_element)
        Indices of nodes, solids in our order.
    rows : (n_element,)
        Data line of each element.
    """

    type: str
    ids: Indices
    nodes: Indices
    rows: Indices
    keyword: Keyword

    def section(self, i: int, sections: Mapping[int, T], keyword: str) -> T:
        """Return what a keyword gave one of the elements, by the ids of these."""
        number = int(self.ids[i])
        if number not in sections:
            message = f"element {number} has no *{keyword}; give its set one"
            self.keyword.refuse(message, int(self.rows[i]))
        return sections[number]


@dataclass(frozen=True, eq=False, kw_only=True)
class Elements:
    """All elements: solids, and others by type."""

    solids: tuple[ElementBlock, ...]
    others: Mapping[str, tuple[ElementBlock, ...]]

    def of(self, *types: str) -> list[ElementBlock]:
        """Return the blocks of elements that are no solids."""
        return [block for name in types for block in self.others.get(name, ())]

    def without(self, ids: Indices) -> "Elements":
        """Return all elements but these; blocks that nothing remains of are gone."""

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
        keyword.check()
        if keyword.has("DLOAD"):
            keyword.refuse(
                "shells that only carry loads (DLOAD) onto the solids beneath them are not "
                "supported; press on faces of solids, by *DSLOAD or P1 … P6 of *DLOAD"
            )
        block = _block(keyword, nodes, deck.ignored)
        if block.type in SOLID_TYPES:
            solids.append(block)
        else:
            others[block.type] = (*others.get(block.type, ()), block)
    result = Elements(solids=tuple(solids), others=others)
    _check_distinct(result.blocks)
    if not result.blocks:
        message = f"{deck.path}: the deck has no elements; it needs *ELEMENT with data lines"
        raise FormatError(message)
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
        ignored.append(f"fields behind the {size} nodes of {kind}, which CalculiX passes over too")
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
    """Refuse elements that name a node twice."""
    ordered = np.sort(block.nodes, axis=1)
    twice = np.flatnonzero((np.diff(ordered, axis=1) == 0).any(axis=1))
    if twice.size:
        first = int(twice[0])
        block.keyword.refuse(
            f"element {block.ids[first]} names a node twice; collapsed elements are not "
            "supported, use a wedge or a tetrahedron",
            int(block.rows[first]),
        )


def _check_distinct(blocks: list[ElementBlock]) -> None:
    ids = np.concatenate([np.empty(0, dtype=np.int64), *(block.ids for block in blocks)])
    order = np.argsort(ids, kind="stable")
    again = np.flatnonzero(np.diff(ids[order]) == 0)
    if again.size:
        position = int(order[again[0] + 1])
        for block in blocks:
            if position < len(block.ids):
                block.keyword.refuse(
                    f"element {block.ids[position]} is defined twice; give it another id",
                    int(block.rows[position]),
                )
            position -= len(block.ids)
