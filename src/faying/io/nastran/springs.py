"""CELAS1, CELAS2, PELAS: scalar springs."""

from collections.abc import Mapping

import numpy as np

from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.components import components
from faying.io.nastran.grids import Grids
from faying.model.assembly import Spring


def read_springs(cards: Mapping[str, Cards], grids: Grids, ignored: list[str]) -> list[Spring]:
    """Read springs; an end whose grid is blank or 0 is grounded.

    Raises
    ------
    FormatError
        If a property is missing, both ends are grounded, or a spring acts along an axis of a
        displacement system that is not a basic axis.
    """
    properties = _properties(cards)
    springs: list[Spring] = []
    for card in cards.get("CELAS1", ()):
        pid = card.integer(1, card.integer(0))
        if pid not in properties:
            text = f"property {pid} is not a PELAS of the deck; define it"
            raise card.error(text, 1)
        springs.append(_spring(card, properties[pid], grids))
    springs += [_spring(card, card.real(1), grids) for card in cards.get("CELAS2", ())]
    if any(card.text(6) for card in cards.get("CELAS2", ())):
        ignored.append("structural damping GE of CELAS2")
    return springs


def _properties(cards: Mapping[str, Cards]) -> dict[int, float]:
    found: dict[int, float] = {}
    for card in cards.get("PELAS", ()):
        for first in (0, 4):
            if card.text(first):
                number = card.integer(first)
                if number in found:
                    text = f"property {number} is defined twice; renumber one"
                    raise card.error(text, first)
                found[number] = card.real(first + 1)
    return found


def _spring(card: Card, stiffness: float, grids: Grids) -> Spring:
    ends: list[tuple[int, int]] = []
    signs: list[int] = []
    for field in (2, 4):
        if card.integer(field, 0) == 0:
            continue
        node = grids.one(card, field)
        chosen = components(card.text(field + 1), card.error)
        if len(chosen) != 1:
            text = f"a spring acts on one component; found '{card.text(field + 1)}'"
            raise card.error(text, field + 1)
        component, sign = _basic(card, node, chosen[0], grids)
        ends.append((node, component))
        signs.append(sign)
    if not ends or len(set(signs)) > 1 or len(set(ends)) < len(ends):
        text = (
            "a spring needs two different ends, or one and the ground, that act in one direction "
            "(check grids, components and displacement coordinate systems)"
        )
        raise card.error(text)
    return Spring(id=card.integer(0), ends=tuple(ends), stiffness=stiffness)


def _basic(card: Card, node: int, component: int, grids: Grids) -> tuple[int, int]:
    """Component in the basic frame and sign of a component along ± a basic axis."""
    axes = grids.systems.axes(node)
    if axes is None:
        return component, 1
    direction = axes[component % 3]
    along = int(np.abs(direction).argmax())
    # Axes from three points typed with seven digits are off by about 1e-7.
    if np.abs(np.delete(direction, along)).max() > 1e-6:
        text = (
            f"GRID {grids.ids[node]} has a displacement coordinate system whose axis is not a "
            "basic axis; springs in such systems are not supported, use a CBAR or an MPC"
        )
        raise card.error(text)
    return along + 3 * (component // 3), 1 if direction[along] > 0 else -1
