"""I12 of PBAR and PBEAM: sections that are not given along their principal axes.

With I1 = ∫y² dA, I2 = ∫z² dA and I12 = ∫yz dA the principal axes are turned from y to z by φ with
tan 2φ = 2 I12 / (I1 - I2).
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Vector
from faying.digits import DECK_DIGITS
from faying.io.nastran.cards import Card, Cards
from faying.model.assembly import BeamSection

_FIELD = {"PBAR": 18, "PBEAM": 5}


def principal(card: Card, section: BeamSection) -> tuple[BeamSection, float]:
    """Return a section along its principal axes, and how far they are turned [rad]."""
    if not _is_turned(card):
        return section, 0.0
    product = card.real(_FIELD[card.cards.name])
    first, second = section.inertia_z, section.inertia_y
    field = _FIELD[card.cards.name]
    if not product**2 < first * second:
        card.refuse(
            f"I12 = {product:g} with I1 = {first:g}, I2 = {second:g}; I12² must be below I1 I2",
            field,
        )
    if section.shear_factor_y != section.shear_factor_z:
        card.refuse(
            f"I12 = {product:g} and shear factors that differ, which have no principal axes in "
            "common; give K1 = K2, or turn the orientation vector to the principal axes",
            field,
        )
    mean, half = (first + second) / 2, math.hypot((first - second) / 2, product)
    large = mean + half
    small = (first * second - product**2) / large
    turned = replace(section, inertia_z=large, inertia_y=small)
    return turned, math.atan2(2 * product, first - second) / 2


def turned_properties(cards: Mapping[str, Cards]) -> set[int]:
    """Return the ids of properties whose principal axes are not those of the element."""
    return {card.integer(0) for name in _FIELD for card in cards.get(name, ()) if _is_turned(card)}


def turned_about(axis: Vector, vector: Vector, angle: float) -> Vector:
    """Return the direction across an axis next to a vector, turned about the axis."""
    if angle == 0.0:
        return vector
    along = axis / np.linalg.norm(axis)
    across = vector - (vector @ along) * along
    turned = math.cos(angle) * across + math.sin(angle) * np.cross(along, across)
    return np.asarray(turned)


def _is_turned(card: Card) -> bool:
    if card.cards.name not in _FIELD:
        return False
    size = math.sqrt(abs(card.real(3, 0.0) * card.real(4, 0.0)))
    return abs(card.real(_FIELD[card.cards.name], 0.0)) > DECK_DIGITS * size
