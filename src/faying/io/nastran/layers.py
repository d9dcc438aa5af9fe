"""PSHELL, PSHEAR and laminates as lists of what they name: materials, layers, where they are."""

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass

from faying.io.nastran import fields as numbers
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, Cards

SHELL_PROPERTIES = ("PSHELL", "PCOMP", "PCOMPG", "PSHEAR")

_NUMBERED = ("PCOMPG", "PCOMPS")
"""Laminates whose layers have ids, each in a line of its own."""

_PLATE_MATERIALS = (1, 3, 5, 10)
"""MID1 to MID4 of PSHELL."""


@dataclass(frozen=True, kw_only=True)
class Layer:
    """A layer of a laminate: material id, thickness, angle in degrees."""

    material: int
    thickness: float
    angle: float


def layers(card: Card) -> list[Layer]:
    """Return the layers of a laminate from the bottom, mirrored where LAM = SYM."""
    stack: list[Layer] = []
    for first in _places(card):
        if not any(card.text(first + j) for j in range(4)):
            continue
        if card.cards.name in _NUMBERED:
            card.integer(first - 1)  # the layer's own id, which names results
        below = stack[-1] if stack else None
        layer = Layer(
            material=card.integer(first, below.material if below else None),
            thickness=card.real(first + 1, below.thickness if below else None),
            angle=card.real(first + 2, 0.0),
        )
        if not layer.thickness > 0:
            card.refuse(
                f"a layer has thickness {layer.thickness:g}; it must be positive", first + 1
            )
        stack.append(layer)
    if not stack:
        card.refuse("it has no layers")
    return stack + stack[::-1] if card.text(7) == "SYM" else stack


def _places(card: Card) -> list[int]:
    """First field, the material, of each layer."""
    if card.cards.name in _NUMBERED:
        return [row + 1 for row in range(8, len(card), 8)]
    return list(range(8, len(card), 4))


def materials_of_layered_solids(cards: Mapping[str, Cards]) -> frozenset[int]:
    """Return the ids of the materials that PCOMPS name."""
    numbers_of = (
        numbers.integer(card.text(first))
        for card in cards.get("PCOMPS", ())
        for first in _places(card)
    )
    return frozenset(number for number in numbers_of if number is not None)


def materials_of_shells(cards: Mapping[str, Cards]) -> frozenset[int]:
    """Return the ids of the materials that properties of shells name."""
    texts = [card.text(field) for card in cards.get("PSHELL", ()) for field in _PLATE_MATERIALS]
    texts += [card.text(1) for card in cards.get("PSHEAR", ())]
    for name in ("PCOMP", "PCOMPG"):
        texts += [card.text(first) for card in cards.get(name, ()) for first in _places(card)]
    ids = (numbers.integer(text) for text in texts)
    return frozenset(number for number in ids if number is not None)


def named_materials(
    bulk: BulkData, name: str, named: Container[int], defined: Container[int]
) -> Iterator[tuple[int, Card]]:
    """Yield the materials that properties name by id, and note the others.

    ``defined`` are those that exist already; what is read of this name is to be added to it.
    """
    unnamed = 0
    for card in bulk.cards.get(name, ()):
        number = card.integer(0)
        if number not in named:
            unnamed += 1
            continue
        if number in defined:
            card.refuse(f"material {number} is defined twice; renumber one")
        yield number, card
    if unnamed:
        bulk.ignored.append(f"{unnamed} {name} that no property names")
