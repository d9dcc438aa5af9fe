"""CHEXA, CPENTA, CPYRAM, CTETRA, PSOLID and PCOMPS: solids, their materials and formulation."""

from collections.abc import Callable, Container, Mapping, Sequence
from functools import partial

import numpy as np

from faying._typing import Indices, Mask
from faying.io.nastran.cards import Card, Cards, by_id
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.materials import along, layers
from faying.io.straight_sides import StraightSides
from faying.model.assembly import Material
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.elements.orientation import right_side_out
from faying.model.generate import mid_side_ends

LAYERED = "PCOMPS"
_OF_LAYERS = (
    "PCOMPS: layered solids are as with PSOLID, of the material of all their layers; Nastran's "
    "have other stresses across the layers, which matters for few elements over a thickness"
)
_FULL_NETWORKS = {"TWO", "2", "THREE", "3"}
_REDUCED = {"", "0", "REDUCED"}
_NO_BUBBLES = (
    "PSOLID IN = TWO with reduced shear: CHEXA with 8 nodes have bubble functions, as by default; "
    "without them a cantilever of nu = 0.3 bends 10 % less with one element over its height, 3 % "
    "with two, 1 % with four (mystran)"
)


Middle = Callable[[Indices, Indices], Indices]
"""Function that returns nodes (n,) between nodes (n,) and (n,)."""

SOLID_CARDS = tuple(dict.fromkeys(element.elsewhere.nastran for element in SOLIDS.values()))


def read_solids(
    bulk: BulkData, materials: Mapping[int, Material], straight: StraightSides
) -> tuple[tuple[CellBlock, ...], dict[int, Material], str]:
    """Return solid elements, materials by property, and the formulation of bricks.

    Eight-node bricks are ``"incompatible"`` when their PSOLID leaves IN and ISOP at the defaults
    (IN blank, 0 or BUBBLE; ISOP blank, 0 or REDUCED) or ask for TWO (2) with reduced shear, and
    ``"standard"`` for ISOP = FULL (1) with IN = TWO or THREE (3). MSC Nastran Quick Reference
    Guide, PSOLID, remark 6. Decks that mix the two or request another scheme are refused. If some
    mid-side nodes of an element are blank, each becomes a new node that moves as the mean of the
    ends of its side.
    """
    blocks: list[CellBlock] = []
    used: dict[int, Material] = {}
    properties = by_id(bulk.cards, "PSOLID", LAYERED, what="property")
    for name in SOLID_CARDS:
        if name in bulk.cards:
            blocks += _blocks(bulk, bulk.cards[name], name, straight)
            for number in used_properties(bulk.cards[name], properties, "PSOLID or PCOMPS"):
                used[number] = _material(properties[number], materials, bulk.grids)
    bricks = {n for block in blocks if block.kind == "hex8" for n in np.unique(block.properties)}
    _note_schemes(blocks, properties, bulk.ignored)
    return tuple(blocks), used, _formulation([properties[n] for n in sorted(bricks)], bulk.ignored)


def _note_schemes(
    blocks: list[CellBlock], properties: Mapping[int, Card], ignored: list[str]
) -> None:
    """Note where the formulation of elements differs from the one that the deck requests."""
    for block in blocks:
        note = SOLIDS[block.kind].elsewhere.nastran_lacks
        used = np.unique(block.properties).tolist()
        if any(properties[number].cards.name == LAYERED for number in used):
            ignored.append(_OF_LAYERS)
        if note and any(properties[number].text(5) not in ("FULL", "1") for number in used):
            ignored.append(note)


def _blocks(bulk: BulkData, cards: Cards, name: str, straight: StraightSides) -> list[CellBlock]:
    linear, quadratic = sorted(
        (element for element in SOLIDS.values() if element.elsewhere.nastran == name),
        key=lambda element: element.n_nodes,
    )
    filled = np.stack([cards.given(2 + j) for j in range(quadratic.n_nodes)], axis=1)
    cards.refuse_where(
        np.asarray(~filled[:, : linear.n_nodes].all(axis=1)),
        lambda i: (
            f"{filled[i].sum()} nodes; supported are {linear.n_nodes} or {quadratic.n_nodes}, of "
            f"which the first {linear.n_nodes} must be given"
        ),
    )
    curved: Mask = np.asarray(filled[:, linear.n_nodes :].any(axis=1))
    result = []
    for element, chosen in ((linear, ~curved), (quadratic, curved)):
        these = cards.take(chosen)
        if len(these):
            ends = mid_side_ends(element.kind) if element is quadratic else ()
            middle = partial(straight.between, turns=False)
            nodes, blank = element_nodes(these, element.n_corners, ends, bulk.grids, middle)
            if blank:
                bulk.ignored.append(f"{blank} blank mid-side nodes of {name}: straight sides")
            places = np.vstack([bulk.grids.nodes, straight.nodes])
            nodes, turned = right_side_out(element.kind, nodes, places)
            if turned.any():
                first = these.words(0)[int(turned.argmax())]
                bulk.ignored.append(
                    f"node order of {turned.sum()} inverted {name}, the first {first}"
                )
            result.append(
                CellBlock(
                    kind=element.kind,
                    nodes=nodes,
                    ids=these.integers(0),
                    properties=property_ids(these),
                )
            )
    return result


def element_nodes(
    cards: Cards, n_corner: int, ends: Sequence[Sequence[int]], grids: Grids, middle: Middle
) -> tuple[Indices, int]:
    """Return node indices (n, n_node) of elements, and the number of blanks.

    ``ends`` are the corners beside each mid-side node; ``middle`` returns nodes for blank
    mid-side nodes.
    """
    corners = [grids.of_column(cards, 2 + j) for j in range(n_corner)]
    columns, blank = list(corners), 0
    for j, (start, end) in enumerate(ends):
        column = grids.of_column(cards, 2 + n_corner + j, blank=True)
        missing = column < 0
        if missing.any():
            column[missing] = middle(corners[start][missing], corners[end][missing])
            blank += int(missing.sum())
        columns.append(column)
    nodes = np.stack(columns, axis=1)
    cards.refuse_where(
        np.asarray((np.diff(np.sort(nodes, axis=1), axis=1) == 0).any(axis=1)),
        lambda i: (
            f"element {cards.words(0)[i]} has the same node twice; collapsed elements are not "
            "supported, use one of fewer nodes (CPENTA, CTETRA, CTRIA3)"
        ),
    )
    return nodes, blank


def property_ids(cards: Cards) -> Indices:
    """Return property ids (n,) of elements; a blank means the element id."""
    return np.where(cards.given(1), cards.integers(1, 0), cards.integers(0))


def used_properties(cards: Cards, properties: Container[int], kinds: str) -> list[int]:
    """Return the unique properties of elements; ``kinds`` lists the cards that define them."""
    numbers, first = np.unique(property_ids(cards), return_index=True)
    used: list[int] = numbers.tolist()
    cards.take(first).refuse_where(
        np.array([number not in properties for number in used]),
        lambda i: f"property {used[i]} is not in the deck; define it ({kinds})",
        1,
    )
    return used


def _material(card: Card, materials: Mapping[int, Material], grids: Grids) -> Material:
    if card.cards.name == LAYERED:
        return _of_layers(card, materials)
    if card.text(6) not in ("", "SMECH"):
        card.refuse(f"FCTN = {card.text(6)} is not supported; only structural solids (SMECH) are")
    return along(card, card.find(materials, 1, "material", "MAT1, MAT9 or MAT11"), grids.systems)


def _of_layers(card: Card, materials: Mapping[int, Material]) -> Material:
    """Return the common material of all layers, whatever their directions."""
    card.integer(1, 0)
    card.integer(2, 13)
    named = {layer.material for layer in layers(card)}
    (number, *others) = sorted(named)
    if others or number not in materials or materials[number].law is not None:
        card.refuse(
            f"layers of materials {', '.join(map(str, sorted(named)))}; layered solids are "
            "supported if all layers have one MAT1; else mesh each layer with its own PSOLID",
            9,
        )
    return materials[number]


def _formulation(properties: list[Card], ignored: list[str]) -> str:
    choices: dict[str, Card] = {}
    for card in properties:
        layered = card.cards.name == LAYERED
        network, scheme = ("", "") if layered else (card.text(3), card.text(5))
        if network in ("", "0", "BUBBLE", "TWO", "2") and scheme in _REDUCED:
            choices.setdefault("incompatible", card)
            if network in ("TWO", "2") and _NO_BUBBLES not in ignored:
                ignored.append(_NO_BUBBLES)
        elif scheme in ("FULL", "1") and network in _FULL_NETWORKS:
            choices.setdefault("standard", card)
            if network in ("THREE", "3"):
                ignored.append("PSOLID IN = THREE (CHEXA with 8 nodes use 2 x 2 x 2 points)")
        else:
            card.refuse(
                f"IN = '{network}' with ISOP = '{scheme}' is not supported for CHEXA; leave both "
                "blank (bubble functions) or give IN = TWO and ISOP = FULL (standard)"
            )
    if len(choices) == 2:
        choices["standard"].refuse(
            f"CHEXA of this PSOLID are standard, those of {choices['incompatible'].where()} have "
            "bubble functions; faying uses one formulation in a model, choose one"
        )
    return next(iter(choices), "incompatible")


def element_sets(blocks: tuple[CellBlock, ...]) -> dict[str, Indices]:
    """Return ``pid:<n>`` to the ids of the elements with that property."""
    sets: dict[str, list[Indices]] = {}
    for block in blocks:
        for number in np.unique(block.properties).tolist():
            sets.setdefault(f"pid:{number}", []).append(block.ids[block.properties == number])
    return {name: np.concatenate(parts) for name, parts in sets.items()}


def check_element_ids(groups: list[Cards]) -> None:
    """Refuse an element id that occurs twice in a deck."""
    if not groups:
        return
    ids = np.concatenate([cards.integers(0) for cards in groups])
    ends = np.cumsum([len(cards) for cards in groups])

    def place(element: int) -> tuple[Cards, int]:
        group = int(np.searchsorted(ends, element, side="right"))
        return groups[group], element - int(ends[group]) + len(groups[group])

    order = np.argsort(ids, kind="stable")
    twice = np.flatnonzero(np.diff(ids[order]) == 0)
    if twice.size:
        (earlier, row), (cards, card) = (place(int(order[twice[0] + j])) for j in (0, 1))
        where, number = earlier.where(row), ids[order[twice[0]]]
        cards.refuse(card, f"element {number} is already used at {where}; renumber one")
    if (ids <= 0).any():
        first = int((ids <= 0).argmax())
        cards, card = place(first)
        cards.refuse(card, f"element id {ids[first]} must be positive")
