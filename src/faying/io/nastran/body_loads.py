"""GRAV, RFORCE: gravity and rotation, by the mass of all elements."""

from collections.abc import Iterator, Mapping, Sequence
from math import pi

import numpy as np

from faying._typing import Matrix, Vector
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.fields import SHORT_DIGITS
from faying.io.nastran.grids import Grids
from faying.model.assembly import PointMass
from faying.model.body_forces import centrifugal


def read_accelerations(
    cards: Mapping[str, Cards],
    grids: Grids,
    nodes: Matrix,
    masses: Sequence[PointMass],
    unread: dict[int, str],
) -> Iterator[tuple[int, Matrix]]:
    """Yield load set and accelerations (n_node, 3) of each card.

    MSC Nastran Quick Reference Guide: GRAV accelerates by A N; RFORCE turns with A revolutions per
    unit of time about R through grid G, or the origin.

    Parameters
    ----------
    nodes : (n_node, 3) [length]
        All that have mass.
    unread
        Load set to what is not read of it; sets of cards that are not represented are added.
    """
    for card in cards.get("GRAV", ()):
        vector = _basic(card, 1, [card.real(j, 0.0) for j in (3, 4, 5)], grids)
        if vector is None:
            reason = f"{card.where()} in a system that turns"
            unread.setdefault(card.integer(0), reason)
        else:
            yield card.integer(0), np.tile(card.real(2) * vector, (len(nodes), 1))
    for card in cards.get("RFORCE", ()):
        number, speed = card.integer(0), 2 * pi * card.real(3, 0.0)
        axis = _basic(card, 2, [card.real(j, 0.0) for j in (4, 5, 6)], grids)
        point = grids.nodes[grids.one(card, 1)] if card.integer(1, 0) else np.zeros(3)
        if any(any(mass.offset) for mass in masses):
            unread.setdefault(number, f"{card.where()} of CONM2 that are offset")
        elif (
            axis is None or abs(float(np.linalg.norm(axis)) - 1) > SHORT_DIGITS or card.real(8, 0.0)
        ):
            reason = (
                f"{card.where()} with RACC, or a direction that is turning or not of length one"
            )
            unread.setdefault(number, reason)
        else:
            yield number, centrifugal(speed**2, point, axis / np.linalg.norm(axis), nodes)


def _basic(card: Card, field: int, values: list[float], grids: Grids) -> Vector | None:
    """Turn a vector to the basic frame; None if its system has other directions elsewhere."""
    if card.integer(field, 0) == 0:
        return np.array(values)
    frame = grids.systems.frame_of(card, field)
    return np.asarray(np.array(values) @ frame.axes) if frame.kind == "R" else None
