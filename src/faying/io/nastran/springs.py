"""CELAS1 to CELAS4 and CMASS1 to CMASS4: springs and masses at single components."""

from collections.abc import Callable, Mapping

import numpy as np

from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.grids import Grids
from faying.model.assembly import ScalarMass, Spring

End = tuple[int, int]


def read_springs(cards: Mapping[str, Cards], grids: Grids, ignored: list[str]) -> list[Spring]:
    """Read springs; an end whose grid is blank or 0 is grounded.

    Raises
    ------
    FormatError
        If a property is missing, both ends are grounded, or a spring acts along an axis of a
        displacement system that is not a basic axis.
    """
    if any(card.text(6) for card in cards.get("CELAS2", ())):
        ignored.append("structural damping GE of CELAS2")
    return [
        Spring(id=card.integer(0), ends=_ends(card, grids), stiffness=value)
        for card, value in _valued(cards, "CELAS", "PELAS")
    ]


def read_scalar_masses(
    cards: Mapping[str, Cards], grids: Grids, mass_factor: float
) -> list[ScalarMass]:
    """Read scalar masses, which act at one component or on the difference of two.

    Raises
    ------
    FormatError
        As :func:`read_springs`.
    """
    return [
        ScalarMass(id=card.integer(0), ends=_ends(card, grids), mass=value * mass_factor)
        for card, value in _valued(cards, "CMASS", "PMASS")
    ]


def _valued(
    cards: Mapping[str, Cards], family: str, property_name: str
) -> list[tuple[Card, float]]:
    """Return elements of a family and their values; 1 and 3 have theirs from a property."""
    properties = _properties(cards, property_name)

    def of_property(card: Card) -> float:
        number = card.integer(1, card.integer(0))
        if number not in properties:
            text = f"property {number} is not a {property_name} of the deck; define it"
            raise card.error(text, 1)
        return properties[number]

    def own(card: Card) -> float:
        return card.real(1)

    kinds: tuple[tuple[str, Callable[[Card], float]], ...] = (
        (f"{family}1", of_property),
        (f"{family}2", own),
        (f"{family}3", of_property),
        (f"{family}4", own),
    )
    return [(card, value(card)) for name, value in kinds for card in cards.get(name, ())]


def _properties(cards: Mapping[str, Cards], name: str) -> dict[int, float]:
    # PELAS holds two properties of four fields, PMASS four of two.
    starts = (0, 4) if name == "PELAS" else (0, 2, 4, 6)
    found: dict[int, float] = {}
    for card in cards.get(name, ()):
        for first in starts:
            if card.text(first):
                number = card.integer(first)
                if number in found:
                    text = f"property {number} is defined twice; renumber one"
                    raise card.error(text, first)
                found[number] = card.real(first + 1)
    return found


def _ends(card: Card, grids: Grids) -> tuple[End, ...]:
    ends: list[End] = []
    signs: list[int] = []
    # Kinds 3 and 4 join scalar points, which have no components.
    scalar = card.cards.name[-1] in "34"
    for field in (2, 3) if scalar else (2, 4):
        if card.integer(field, 0) == 0:
            continue
        node = grids.one(card, field)
        digits = "" if scalar else card.text(field + 1)
        chosen = grids.components(np.array([node]), digits, card.error)
        if len(chosen) != 1:
            text = f"a spring or mass acts on one component; found '{digits}'"
            raise card.error(text, field + 1)
        component, sign = _basic(card, node, chosen[0], grids)
        ends.append((node, component))
        signs.append(sign)
    if not ends or len(set(signs)) > 1 or len(set(ends)) < len(ends):
        text = (
            "a spring or mass needs two different ends, or one and the ground, that act in one "
            "direction (check grids, components and displacement coordinate systems)"
        )
        raise card.error(text)
    return tuple(ends)


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
            "basic axis; springs in such systems are not supported, use a CBUSH"
        )
        raise card.error(text)
    return along + 3 * (component // 3), 1 if direction[along] > 0 else -1
