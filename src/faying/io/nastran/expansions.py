"""Coefficients of expansion of materials and of shells."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from faying._typing import Vector
from faying.digits import SOLVED
from faying.io.nastran.card_table import FIELDS
from faying.io.nastran.cards import Card, Cards, each
from faying.io.nastran.grids import BulkData
from faying.io.nastran.materials import PlaneMaterial, layers
from faying.model.shells import strain_rotation

_COEFFICIENTS = frozenset(("A", "A1", "A2", "A3", "A4", "A5", "A6"))


class UnreadError(Exception):
    """An unsupported feature of a set of temperatures."""


def unread(text: str) -> NoReturn:
    """Raise the error of an unsupported feature."""
    raise UnreadError(text)


@dataclass(frozen=True, eq=False, kw_only=True)
class Expansion:
    """Strains per degree: (6,) of MAT1, MAT9, MAT11, (3,) in the plane of MAT2, MAT8."""

    strains: Vector
    zero: float


NOTHING = Expansion(strains=np.zeros(6), zero=0.0)


def check_constant(bulk: BulkData) -> None:
    """Refuse temperature-dependent constants that case control requests."""
    if bulk.control.set_of("TEMPERATURE(MATERIAL)") is None:
        return
    for kind in (1, 2, 8, 9, 11):
        dependent = {card.integer(0) for card in bulk.cards.get(f"MAT{kind}", ())}
        for card in bulk.cards.get(f"MATT{kind}", ()):
            if card.integer(0) in dependent:
                unread(f"{card.where()} at temperatures of TEMPERATURE(BOTH) or (MATERIAL)")


def read_expansions(cards: Mapping[str, Cards]) -> dict[int, Expansion]:
    """Return the expansion coefficients of all materials that expand."""
    expansions = {}
    for card in each(cards, "MAT1", "MAT2", "MAT8", "MAT9", "MAT11"):
        name = card.cards.name
        fields = [i for i, field in enumerate(FIELDS[name]) if field.name in _COEFFICIENTS]
        strains = np.zeros(3 if name in ("MAT2", "MAT8") else 6)
        strains[: 3 if name == "MAT1" else len(fields)] = card.reals(fields, 0.0)
        if strains.any():
            zero = card.real(card.place("TREF"), 0.0)
            expansions[card.integer(0)] = Expansion(strains=strains, zero=zero)
    return expansions


def expansion_of_plate(
    card: Card, expansions: Mapping[int, Expansion], laws: Mapping[int, PlaneMaterial]
) -> Expansion | None:
    """Return the strains per degree in the plane of a shell; None without expansion."""
    if card.cards.name == "PSHELL":
        if card.integer(10, 0) in expansions:
            unread(f"{card.where()} with MID4 of a material that expands")
        of_material = expansions.get(card.integer(1))
        return None if of_material is None else replace(of_material, strains=_in_plane(of_material))
    plies = layers(card)
    if not any(ply.material in expansions for ply in plies):
        return None
    forces, moments = np.zeros(3), np.zeros(3)
    stiffness = np.zeros((6, 6))
    bottom = -sum(ply.thickness for ply in plies) / 2
    for ply in plies:
        turn = strain_rotation(np.array(np.radians(ply.angle)))
        law = turn.T @ laws[ply.material].law @ turn
        expansion = expansions.get(ply.material)
        strain = np.zeros(3) if expansion is None else np.linalg.solve(turn, _in_plane(expansion))
        t, middle = ply.thickness, bottom + ply.thickness / 2
        forces, moments = forces + t * law @ strain, moments + t * middle * law @ strain
        stiffness[:3, :3] += t * law
        stiffness[:3, 3:] += t * middle * law
        stiffness[3:, 3:] += (t * middle**2 + t**3 / 12) * law
        bottom += t
    if card.text(7) in ("MEM", "SMEAR"):
        strains = np.linalg.solve(stiffness[:3, :3], forces)
    else:
        stiffness[3:, :3] = stiffness[:3, 3:]
        strains = np.linalg.solve(stiffness, np.concatenate([forces, moments]))
        if np.abs(strains[3:]).max() * bottom > SOLVED * np.abs(strains[:3]).max():
            unread(f"{card.where()} of layers that bend when they expand")
    return Expansion(strains=np.asarray(strains[:3]), zero=card.real(5, 0.0))


def _in_plane(expansion: Expansion) -> Vector:
    return expansion.strains if len(expansion.strains) == 3 else expansion.strains[[0, 1, 3]]
