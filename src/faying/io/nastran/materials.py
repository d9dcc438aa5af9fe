"""MAT1: isotropic material."""

import math
from collections.abc import Mapping

from faying.exceptions import ModelError
from faying.io.nastran import fields as numbers
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.layers import materials_of_layered_solids, materials_of_shells
from faying.model.assembly import Material

# Nastran itself warns when E, G and ν disagree by more than one per cent.
_CONTRADICTION = 0.01
_INCOMPRESSIBLE = 0.5

PROPERTIES = ("PSOLID", "PBAR", "PBARL", "PBEAM", "PBEAML", "PROD", "PTUBE", "PBEND")
"""Cards that name a material in their second field."""

MATERIALS = frozenset(
    (
        *("MAT3", "MAT10", "MATG", "MATHE"),
        *("MATHP", "MATS1", "MATVE", "CREEP"),
    )
)
"""Cards of materials that are not isotropic and linear, or of what makes MAT1 so, by its id."""


def read_materials(bulk: BulkData) -> tuple[dict[int, Material], dict[int, float]]:
    """Return the materials that are used, by id; densities are multiplied by PARAM,WTMASS.

    Two of E, G, NU are given, or E alone with NU = 0. Where all three are and contradict each
    other, solids and the membranes of shells take E and NU, lines and transverse shear of shells
    G. Also returned is G over E / (2 (1 + NU)) of materials in which they differ: the torsion and
    shear of lines and the transverse shear of shells are multiplied by it. Materials that only
    lines name are read with NU = 0 where no Poisson's ratio explains them.
    """
    materials: dict[int, Material] = {}
    factors: dict[int, float] = {}
    origin: dict[int, str] = {}
    damped = 0
    contradicting: list[int] = []
    single: list[int] = []
    named, shells = materials_named(bulk.cards), materials_of_shells(bulk.cards)
    only_lines = named - _named_by_bodies(bulk.cards)
    for card in bulk.cards.get("MAT1", ()):
        number = card.integer(0)
        if number not in named:
            continue
        if number in origin:
            card.refuse(f"material {number} is already defined at {origin[number]}; renumber one")
        origin[number] = card.where()
        lines = _line_constants(card) if number in only_lines else None
        youngs, poisson = _constants(card, number, shells) if lines is None else (lines[0], 0.0)
        if lines is not None:
            factors[number] = 2 * lines[1] / lines[0]
        elif _contradict(card):
            contradicting.append(number)
            factors[number] = card.real(2) / _consistent(card)
        elif not (card.text(2) or card.text(3)):
            single.append(number)
            factors[number] = 0.0
        if not math.isfinite(youngs + poisson):
            card.refuse(
                f"material {number}: E, G and NU are too large for a number; check the units"
            )
        try:
            materials[number] = Material(
                youngs_modulus=youngs,
                poissons_ratio=poisson,
                density=card.real(4, 0.0) * bulk.mass_factor,
                name=str(number),
                expansion=card.real(5) if card.text(5) else None,
            )
        except ModelError as error:
            raise card.error(str(error)) from error
        damped += card.real(7, 0.0) != 0.0
    if damped:
        bulk.ignored.append(f"structural damping GE of {damped} MAT1 (give [damping] in the study)")
    if contradicting:
        bulk.ignored.append(
            f"E, G and NU of MAT1 {_listed(contradicting)} contradict each other by more than 1 %: "
            "as in Nastran solids and membranes of shells have E and NU, transverse shear and "
            "torsion of lines G"
        )
    if single:
        bulk.ignored.append(
            f"MAT1 {_listed(single)} with E alone: as in Nastran NU is 0, and G is 0 for torsion "
            "and shear of lines"
        )
    return materials, factors


def _listed(numbers: list[int]) -> str:
    shown = ", ".join(map(str, numbers[:5]))
    return shown if len(numbers) <= 5 else f"{shown} and {len(numbers) - 5} more"


def _line_constants(card: Card) -> tuple[float, float] | None:
    """E and G that contradict each other as those of an isotropic material; None if they do not."""
    youngs, shear = card.real(1, 0.0), card.real(2, 0.0)
    if not (youngs > 0 and shear > 0):
        return None
    ratio = card.real(3, youngs / (2 * shear) - 1)
    consistent = youngs / (2 * (1 + ratio)) if ratio > -1 else 0.0
    contradict = abs(shear - consistent) > _CONTRADICTION * consistent
    return (youngs, shear) if contradict or not -1 < ratio < _INCOMPRESSIBLE else None


def _consistent(card: Card) -> float:
    """G of E and NU."""
    return card.real(1) / (2 * (1 + card.real(3)))


def _contradict(card: Card) -> bool:
    """Whether E, G and NU are all given, and are not those of an isotropic material."""
    if not all(card.text(j) for j in (1, 2, 3)) or not card.real(1) > 0 or card.real(3) <= -1:
        return False
    consistent = _consistent(card)
    return card.real(2) > 0 and abs(card.real(2) - consistent) > _CONTRADICTION * consistent


def materials_of_solids(cards: Mapping[str, Cards]) -> frozenset[int]:
    """Return the ids of the materials that solids name."""
    solids = (numbers.integer(card.text(1)) for card in cards.get("PSOLID", ()))
    return frozenset(n for n in solids if n is not None) | materials_of_layered_solids(cards)


def _named_by_bodies(cards: Mapping[str, Cards]) -> frozenset[int]:
    """Ids of the materials that solids and shells name."""
    return materials_of_shells(cards) | materials_of_solids(cards)


def materials_named(cards: Mapping[str, Cards]) -> frozenset[int]:
    """Return the ids of the materials that properties of elements name."""
    fields = {**dict.fromkeys(PROPERTIES, 1), "CONROD": 3}
    return _named_by_bodies(cards) | frozenset(
        number
        for name, field in fields.items()
        for card in cards.get(name, ())
        if (number := numbers.integer(card.text(field))) is not None
    )


def _constants(card: Card, number: int, shells: frozenset[int]) -> tuple[float, float]:
    """E and NU, from G where one of them is blank."""
    filled = [bool(card.text(j)) for j in (1, 2, 3)]
    youngs, shear, poisson = (card.real(j, 0.0) for j in (1, 2, 3))
    if filled == [True, False, False] and number not in shells:
        return youngs, 0.0
    if sum(filled) < 2:
        card.refuse(f"material {number} gives {sum(filled)} of E, G, NU; two are needed")
    if not filled[0]:
        return 2 * shear * (1 + poisson), poisson
    if not filled[2]:
        if not shear > 0:
            card.refuse(f"material {number} has G = {shear:g}; it must be positive")
        return youngs, youngs / (2 * shear) - 1
    return youngs, poisson
