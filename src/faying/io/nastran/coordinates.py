"""CORD1R/C/S, CORD2R/C/S: coordinate systems in the basic frame."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Matrix
from faying.io.frames import BASIC, Frame, NodeAxes
from faying.io.nastran.cards import Card, Cards
from faying.model.axes import axes_along

CARDS = "CORD2R, ..."
"""Cards of coordinate systems."""

ON_AXIS = (
    "GRID on the axis of their displacement system, which has no radial direction there: faying "
    "takes the system's x axis, Nastran a direction that depends on rounding"
)
"""Note on grid points on such an axis, after their number."""


def missing_system(number: int) -> str:
    """Return the message for a missing coordinate system."""
    return f"coordinate system {number} is not in the deck; define it ({CARDS})"


class _Definition(NamedTuple):
    """Definition of a frame: three points (3, 3), and the system of each."""

    card: Card
    systems: list[int]
    points: Matrix


def read_frames(
    cards: Mapping[str, Cards], locate: Callable[[int, Card], tuple[int, Matrix]]
) -> dict[int, Frame]:
    """Return all coordinate systems of a deck in the basic frame.

    ``locate`` maps a grid id to its coordinate system and its coordinates (3,) there.
    """
    waiting = _definitions(cards, locate)
    frames = {0: BASIC}
    while waiting:
        ready = {
            number: _frame(definition, frames)
            for number, definition in waiting.items()
            if frames.keys() >= set(definition.systems)
        }
        if not ready:
            number, (card, systems, _) = next(iter(waiting.items()))
            card.refuse(
                f"coordinate system {number} refers to system "
                f"{next(system for system in systems if system not in frames)}, which is missing "
                "or refers back to it; define it"
            )
        frames |= ready
        waiting = {number: d for number, d in waiting.items() if number not in ready}
    return frames


def _definitions(
    cards: Mapping[str, Cards], locate: Callable[[int, Card], tuple[int, Matrix]]
) -> dict[int, _Definition]:
    definitions: dict[int, _Definition] = {}
    for card in (card for kind in "RCS" for card in cards.get(f"CORD2{kind}", ())):
        points = card.reals(range(2, 11), 0.0).reshape(3, 3)
        _add(definitions, card, [card.integer(1, 0)] * 3, points)
    for card in (card for kind in "RCS" for card in cards.get(f"CORD1{kind}", ())):
        for fields in card.groups(0, 4):
            places = [locate(fields.integer(j), fields) for j in (1, 2, 3)]
            systems, coordinates = zip(*places, strict=True)
            _add(definitions, fields, [*systems], np.array(coordinates))
    return definitions


def _add(
    definitions: dict[int, _Definition], card: Card, systems: list[int], points: Matrix
) -> None:
    number = card.integer(0)
    if number in definitions:
        where = definitions[number].card.where()
        card.refuse(f"coordinate system {number} is already defined at {where}; give it another id")
    if number <= 0:
        card.refuse(f"coordinate system id {number} must be positive")
    definitions[number] = _Definition(card, systems, points)


def _frame(definition: _Definition, frames: Mapping[int, Frame]) -> Frame:
    card, systems, points = definition
    a, b, c = (
        frames[system].to_basic(xyz[None])[0] for system, xyz in zip(systems, points, strict=True)
    )
    axes = axes_along(b - a, c - a)
    if axes is None:
        card.refuse("its three points lie on one line, so they define no axes; move one of them")
    return Frame(kind=card.cards.name[-1], origin=a, axes=axes[[1, 2, 0]])


class Systems(NodeAxes):
    """The coordinate systems of a deck with the grid points that use them (CD)."""

    def frame_of(self, card: Card, field: int, number: int | None = None) -> Frame:
        """Return the system named in a field of a card, or the system ``number``."""
        number = card.integer(field, 0) if number is None else number
        return card.find(self.frames, field, "coordinate system", CARDS, number)

    def directions_at(self, cards: Cards, field: int, rows: Indices, points: Matrix) -> Matrix:
        """Return the directions (n, 3, 3) at points of the systems named in a field of cards.

        ``rows`` (n,) are the cards of the points.
        """
        systems = cards.integers(field, 0)[rows]
        result = np.empty((len(points), 3, 3))
        for number in np.unique(systems).tolist():
            these = np.flatnonzero(systems == number)
            if number not in self.frames:
                cards.refuse(int(rows[these[0]]), missing_system(number), field)
            result[these] = self.frames[number].directions(points[these])
        return result
