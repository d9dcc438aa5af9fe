"""Materials MAT1, MAT2, MAT8, MAT9, MAT11, and the properties and layers that use them."""

import math
from collections import ChainMap, Counter
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix
from faying.display.facts import listed
from faying.exceptions import ModelError
from faying.io.nastran import fields as numbers
from faying.io.nastran.card_table import FIELDS
from faying.io.nastran.cards import Card, Cards, each
from faying.io.nastran.coordinates import Systems
from faying.io.nastran.fields import ROW
from faying.io.nastran.grids import BulkData
from faying.model.assembly import Material
from faying.model.elastic_law import orthotropic_law, turned
from faying.model.shells import plane_stress

SHELL_PROPERTIES = ("PSHELL", "PCOMP", "PCOMPG", "PSHEAR")

SOLID_PROPERTIES = ("PSOLID", "PCOMPS")

_LAYERED = {"PCOMP": 4, "PCOMPG": 8, "PCOMPS": 8}
"""Laminates, and the number of fields of a layer; with a line each, the first is its id."""


class Layer(NamedTuple):
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
        if _LAYERED[card.cards.name] == ROW:
            card.integer(first - 1)  # the layer's id, only for results
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
    """Return the first field of each layer, its material."""
    size = _LAYERED.get(card.cards.name)
    return [] if size is None else [first + size // ROW for first in range(ROW, len(card), size)]


def materials_of(cards: Mapping[str, Cards], *names: str) -> frozenset[int]:
    """Return the ids of the materials on cards, in fields MID and in layers."""
    ids = (
        numbers.integer(card.text(place))
        for card in each(cards, *names)
        for place in (*_material_fields(card.cards.name), *_places(card))
    )
    return frozenset(number for number in ids if number is not None)


def _material_fields(name: str) -> list[int]:
    """Return the fields that name materials, without the card's id."""
    return [i for i, field in enumerate(FIELDS[name]) if i and field.name.startswith("MID")]


def named_materials(
    bulk: BulkData, names: Iterable[str], named: Container[int], defined: Container[int]
) -> Iterator[tuple[int, Card]]:
    """Yield the materials of some cards that properties use, and note the others.

    ``defined`` are the known materials; the caller adds the new ones.
    """
    unnamed: Counter[str] = Counter()
    for card in each(bulk.cards, *names):
        number = card.integer(0)
        if number not in named:
            unnamed[card.cards.name] += 1
            continue
        if number in defined:
            card.refuse(f"material {number} is defined twice; renumber one")
        yield number, card
    bulk.ignored.extend(f"{count} {name} that no property uses" for name, count in unnamed.items())


# Nastran itself warns when E, G and ν disagree by more than one per cent.
_CONTRADICTION = 0.01
_INCOMPRESSIBLE = 0.5

MATERIALS = frozenset(
    (
        *("MAT3", "MAT10", "MATG", "MATHE"),
        *("MATHP", "MATS1", "MATVE", "CREEP"),
    )
)
"""Cards of nonlinear or anisotropic materials, and cards that make a MAT1 of their id such."""


def read_materials(bulk: BulkData) -> tuple[dict[int, Material], dict[int, float]]:
    """Return the used materials by id, with densities multiplied by PARAM,WTMASS.

    Two of E, G, NU are given, or E alone with NU = 0. If all three are given and contradict each
    other, solids and membranes of shells take E and NU, lines and transverse shear of shells G.
    Also returned is the ratio of G to E / (2 (1 + NU)) where they differ: a factor of the torsion
    and shear of lines and the transverse shear of shells. Materials that only lines use get NU = 0
    if no Poisson's ratio fits E and G.
    """
    materials: dict[int, Material] = {}
    factors: dict[int, float] = {}
    origin: dict[int, str] = {}
    damped = 0
    unusual: dict[str, list[int]] = {}
    named, shells = (materials_of(bulk.cards, *names) for names in (FIELDS, SHELL_PROPERTIES))
    only_lines = named - shells - materials_of(bulk.cards, *SOLID_PROPERTIES)
    for card in bulk.cards.get("MAT1", ()):
        number = card.integer(0)
        if number not in named:
            continue
        if number in origin:
            card.refuse(f"material {number} is already defined at {origin[number]}; renumber one")
        origin[number] = card.where()
        youngs, poisson, factor, kind = _constants(card, number in only_lines, number in shells)
        unusual.setdefault(kind, []).append(number)
        if factor != 1.0:
            factors[number] = factor
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
    if contradicting := unusual.get("contradicting"):
        bulk.ignored.append(
            f"E, G and NU of MAT1 {listed(contradicting)} contradict each other by more than 1 %: "
            "as in Nastran solids and membranes of shells have E and NU, transverse shear and "
            "torsion of lines G"
        )
    if single := unusual.get("E alone"):
        bulk.ignored.append(
            f"MAT1 {listed(single)} with E alone: as in Nastran NU is 0, and G is 0 for torsion "
            "and shear of lines"
        )
    return materials, factors


def _constants(card: Card, only_lines: bool, of_shells: bool) -> tuple[float, float, float, str]:
    """Return E, NU, the ratio of G to E / (2 (1 + NU)), and any peculiarity of the three."""
    number, filled = card.integer(0), [bool(card.text(j)) for j in (1, 2, 3)]
    youngs, shear, poisson = (card.real(j, 0.0) for j in (1, 2, 3))
    if youngs > 0 and shear > 0:
        ratio = poisson if filled[2] else youngs / (2 * shear) - 1
        consistent = youngs / (2 * (1 + ratio)) if ratio > -1 else 0.0
        contradict = abs(shear - consistent) > _CONTRADICTION * consistent
        if only_lines and (contradict or not -1 < ratio < _INCOMPRESSIBLE):
            return youngs, 0.0, 2 * shear / youngs, "of lines"
        if contradict and consistent > 0:
            return youngs, ratio, shear / consistent, "contradicting"
    if filled == [True, False, False] and not of_shells:
        return youngs, 0.0, 0.0, "E alone"
    if sum(filled) < 2:
        card.refuse(f"material {number} has {sum(filled)} of E, G, NU; give two")
    if not filled[0]:
        return 2 * shear * (1 + poisson), poisson, 1.0, ""
    if filled[2]:
        return youngs, poisson, 1.0, ""
    if not shear > 0:
        card.refuse(f"material {number} has G = {shear:g}; it must be positive")
    return youngs, youngs / (2 * shear) - 1, 1.0, ""


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaneMaterial:
    """Material of a shell layer in its own axes.

    Attributes
    ----------
    law : (3, 3) [force/length²]
        Plane stresses per strain (εxx, εyy, γxy).
    shear : (2, 2) [force/length²]
        Transverse shear stresses per strain; None is rigid.
    density : [mass/length³]
    """

    law: Matrix
    shear: Matrix | None
    density: float


def read_plane_materials(bulk: BulkData) -> dict[int, PlaneMaterial]:
    """Return the materials of shells by id."""
    by_number = {
        number: PlaneMaterial(
            law=plane_stress(material.youngs_modulus, material.poissons_ratio),
            shear=bulk.shear_factors.get(number, 1.0) * material.shear_modulus * np.eye(2),
            density=material.density,
        )
        for number, material in bulk.materials.items()
    }
    named = materials_of(bulk.cards, *SHELL_PROPERTIES)
    readers = {"MAT2": _anisotropic, "MAT8": _orthotropic}
    for number, card in named_materials(bulk, readers, named, by_number):
        by_number[number] = readers[card.cards.name](card, bulk.mass_factor)
    return by_number


def _anisotropic(card: Card, mass_factor: float) -> PlaneMaterial:
    g11, g12, g13, g22, g23, g33 = (card.real(j, 0.0) for j in range(1, 7))
    law = np.array([[g11, g12, g13], [g12, g22, g23], [g13, g23, g33]])
    # For transverse shear G33 is blank, and the other fields are a matrix of two rows.
    return PlaneMaterial(law=law, shear=law[:2, :2], density=card.real(7, 0.0) * mass_factor)


def _orthotropic(card: Card, mass_factor: float) -> PlaneMaterial:
    first, second, ratio = card.real(1), card.real(2), card.real(3)
    in_plane = card.real(4, 0.0)
    sideways = [card.real(5, 0.0), card.real(6, 0.0)]
    minor_ratio = ratio * second / first
    if not abs(ratio * minor_ratio) < 1:
        card.refuse(
            f"E1 = {first:g}, E2 = {second:g}, NU12 = {ratio:g} is an unstable material; correct it"
        )
    scale = 1 / (1 - ratio * minor_ratio)
    law = np.diag([scale * first, scale * second, in_plane])
    law[0, 1] = law[1, 0] = scale * ratio * second
    return PlaneMaterial(
        law=law,
        shear=np.diag(sideways) if min(sideways) > 0 else None,
        density=card.real(7, 0.0) * mass_factor,
    )


def read_anisotropic(bulk: BulkData) -> dict[int, Material]:
    """Return the anisotropic materials along their own axes, by id.

    Materials that no PSOLID uses are left out with a note.
    """
    anisotropic: dict[int, Material] = {}
    laws = {"MAT9": _general_law, "MAT11": _orthotropic_law}
    named = materials_of(bulk.cards, *SOLID_PROPERTIES)
    defined = ChainMap(anisotropic, dict(bulk.materials))
    for number, card in named_materials(bulk, laws, named, defined):
        density = card.real(card.place("RHO"), 0.0) * bulk.mass_factor
        try:
            law = laws[card.cards.name](card)
            anisotropic[number] = Material.anisotropic(law, density=density, name=str(number))
        except (ModelError, ValueError) as error:
            text = f"material {number}: {error}"
            raise card.error(text) from error
    return anisotropic


def along(card: Card, material: Material, systems: Systems) -> Material:
    """Return a material in the coordinate system CORDM of its PSOLID."""
    number = card.integer(2, 0)
    if material.law is None or number == 0:
        return material
    if number < 0:
        card.refuse(
            "CORDM = -1, axes of each element, is not supported; give a rectangular system", 2
        )
    frame = systems.frame_of(card, 2)
    if frame.kind != "R":
        card.refuse(f"CORDM = {number} is not rectangular; use a rectangular system", 2)
    return replace(material, law=turned(material.law, np.asarray(frame.axes)))


def _general_law(card: Card) -> Matrix:
    law = np.zeros((6, 6))
    law[np.triu_indices(6)] = card.reals(range(1, 22), 0.0)
    return law + np.triu(law, 1).T


def _orthotropic_law(card: Card) -> Matrix:
    shear = np.array([card.real(7), card.real(9), card.real(8)])
    moduli, ratios = card.reals((1, 2, 3)).tolist(), card.reals((4, 5, 6)).tolist()
    return orthotropic_law(moduli, ratios, shear)
