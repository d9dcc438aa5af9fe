"""PBAR, PBARL, PBEAM, PBEAML: constant cross-sections of beams.

With I1 = ∫y² dA, I2 = ∫z² dA and I12 = ∫yz dA, principal axes are turned from y to z by φ with
tan 2φ = 2 I12 / (I1 - I2).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from faying._typing import Vector
from faying.digits import DECK_DIGITS, SHORT_DIGITS
from faying.io.nastran.cards import Card, Cards, by_id, each
from faying.io.nastran.grids import BulkData
from faying.io.nastran.walled_sections import ESTIMATED, SHAPES, walled_section
from faying.model.assembly import BeamSection, Material
from faying.model.axes import rectangular_section, round_section


def principal(card: Card, section: BeamSection) -> tuple[BeamSection, float]:
    """Return a section along its principal axes, and the angle of these [rad]."""
    product, field = _product(card), card.place("I12")
    if not product:
        return section, 0.0
    first, second = section.inertia_z, section.inertia_y
    if not product**2 < first * second:
        card.refuse(
            f"I12 = {product:g} with I1 = {first:g}, I2 = {second:g}; I12² must be below I1 I2",
            field,
        )
    if section.shear_factor_y != section.shear_factor_z:
        card.refuse(
            f"I12 = {product:g} and different shear factors, which have no common principal "
            "axes; give K1 = K2, or turn the orientation vector to the principal axes",
            field,
        )
    mean, half = (first + second) / 2, math.hypot((first - second) / 2, product)
    large = mean + half
    small = (first * second - product**2) / large
    turned = replace(section, inertia_z=large, inertia_y=small)
    return turned, math.atan2(2 * product, first - second) / 2


def turned_properties(cards: Mapping[str, Cards]) -> set[int]:
    """Return the ids of properties whose principal axes are not those of the element."""
    families = ("PBAR", "PBEAM")
    return {card.integer(0) for card in each(cards, *families) if _product(card)}


def turned_about(axis: Vector, vector: Vector, angle: float) -> Vector:
    """Return a vector turned about an axis, without its part along the axis; as is for 0."""
    if angle == 0.0:
        return vector
    along = axis / np.linalg.norm(axis)
    across = vector - (vector @ along) * along
    turned = math.cos(angle) * across + math.sin(angle) * np.cross(along, across)
    return np.asarray(turned)


def _product(card: Card) -> float:
    """Return I12; zero if negligible, or if dimensions define the section."""
    if not card.text(card.place("I12")):
        return 0.0
    size = math.sqrt(abs(card.real(card.place("I1"), 0.0) * card.real(card.place("I2"), 0.0)))
    product = card.real(card.place("I12"))
    return product if abs(product) > DECK_DIGITS * size else 0.0


class Property(NamedTuple):
    """Section and material of beams, and the angle of principal axes from y to z [rad].

    ``warping`` [length⁶] is the warping constant for beams with warping points.
    """

    section: BeamSection
    material: Material
    angle: float
    warping: float = 0.0


_DIMENSIONS = {
    **{"ROD": 1, "TUBE": 2, "BAR": 2, "BOX": 4},
    **{kind: count for kind, (count, _) in SHAPES.items()},
}
_STATIONS = ("YES", "YESA", "NO")


def read_sections(bulk: BulkData) -> dict[str, dict[int, Property]]:
    """Return sections by element card (CBAR, CBEAM) and property id.

    K1, K2 left blank are rigid in shear on PBAR and 1.0 on PBEAM; 0.0 is rigid on both. PBARL and
    PBEAML take shear factors from :func:`dimensioned_section`. Non-structural mass is added to the
    density, with a note.
    """
    result: dict[str, dict[int, Property]] = {"CBAR": {}, "CBEAM": {}}
    heavy = 0
    readers = {
        "CBAR": {"PBAR": _pbar, "PBARL": _dimensioned},
        "CBEAM": {"PBEAM": _pbeam, "PBEAML": _dimensioned},
    }
    lines = each(bulk.cards, "CBAR", "CBEAM", "BAROR", "BEAMOR")
    used = {card.integer(1, 0) or card.integer(0, 0) for card in lines}
    for element, read in readers.items():
        for number, card in by_id(bulk.cards, *read, what="property").items():
            name = card.cards.name
            if number not in used and card.integer(1) not in bulk.materials:
                bulk.ignored.append(f"{name} {number}, without a MAT1, that no element uses")
                continue
            material, factor = bulk.material(card, 1)
            section, angle = principal(card, _checked(card, read[name](card, material)))
            line_mass = card.real(_mass_field(card), 0.0) * bulk.mass_factor
            if not 0 <= line_mass < math.inf:
                card.refuse(
                    f"non-structural mass {line_mass:g} must not be negative", _mass_field(card)
                )
            heavy += line_mass > 0
            heavier = replace(material, density=material.density + line_mass / section.area)
            warping = _warping(card) if name == "PBEAM" else 0.0
            result[element][number] = Property(with_shear(section, factor), heavier, angle, warping)
    if any(card.text(3) in SHAPES for card in each(bulk.cards, "PBARL", "PBEAML")):
        bulk.ignored.append(ESTIMATED)
    if heavy:
        bulk.ignored.append(
            f"non-structural mass of {heavy} properties of beams: added to their density, so it "
            "also adds rotary inertia"
        )
    return result


def _mass_field(card: Card) -> int:
    """Return the field of the mass per length."""
    name = card.cards.name
    return {"PBAR": 6, "PBEAM": 7}.get(name) or 8 + _DIMENSIONS[card.text(3)]


def with_shear(section: BeamSection, factor: float) -> BeamSection:
    """Multiply torsion and shear stiffness by a factor; zero means no shear deformation."""
    along_y, along_z = (
        factor * share if factor else math.inf
        for share in (section.shear_factor_y, section.shear_factor_z)
    )
    torsion = factor * section.torsion
    return replace(section, torsion=torsion, shear_factor_y=along_y, shear_factor_z=along_z)


def _checked(card: Card, section: BeamSection) -> BeamSection:
    values = (section.area, section.inertia_y, section.inertia_z, section.torsion)
    if not all(map(math.isfinite, values)):
        card.refuse("the section is too large for a number; check the units")
    return section


def _factor(card: Card, field: int, default: float) -> float:
    value = card.real(field, default)
    if value < 0:
        card.refuse(f"shear factor {value:g} must not be negative", field)
    return value or math.inf


def _pbar(card: Card, _: Material) -> BeamSection:
    return BeamSection(
        area=card.real(2),
        inertia_z=card.real(3, 0.0),
        inertia_y=card.real(4, 0.0),
        torsion=card.real(5, 0.0),
        shear_factor_y=_factor(card, 16, 0.0),
        shear_factor_z=_factor(card, 17, 0.0),
    )


def _pbeam(card: Card, _: Material) -> BeamSection:
    row = _behind_stations(card)
    card.refuse_non_zero([row + 4, row + 5], "non-structural inertia", "use a CONM2 at the node")
    if card.real(7, 0.0):
        card.refuse_non_zero(range(row + 8, row + 12), "an offset of mass", "remove it")
    card.refuse_non_zero(range(row + 12, row + 16), "an offset of the neutral axis", "remove it")
    return BeamSection(
        area=card.real(2),
        inertia_z=card.real(3),
        inertia_y=card.real(4),
        torsion=card.real(6, 0.0),
        shear_factor_y=_factor(card, row, 1.0),
        shear_factor_z=_factor(card, row + 1, 1.0),
    )


def _warping(card: Card) -> float:
    """Return CW; a blank at end B means the value at A."""
    field = _behind_stations(card) + 6
    first = card.real(field, 0.0)
    if _differ(first, card.real(field + 1, first)):
        card.refuse("CW changes along the beam, which is not supported; split the beam", field + 1)
    return first


def _behind_stations(card: Card) -> int:
    """Check the stations along the beam and return the field of K1 after them."""
    row = 8
    if card.text(row) not in _STATIONS:
        row += 8
    while card.text(row) in _STATIONS:
        _check_constant(card, row + 2, card.reals(range(2, 8), 0.0), 3)
        row += 16 if card.text(row) == "YES" else 8
    return row


def _check_constant(card: Card, first: int, values: Iterable[float], positive: int) -> None:
    """Refuse a section that changes along the beam; values are those at its first end.

    The first ``positive`` values must be positive; there 0.0 counts as a blank.
    """
    for j, value in enumerate(values):
        there = card.real(first + j, value)
        if _differ(there, value) and (j >= positive or there != 0.0):
            name = f"field {(first + j) % 8 + 2}"
            card.refuse(
                f"the section changes along the beam ({name}); tapered beams are not supported, "
                "split the beam into constant pieces",
                first + j,
            )


def _differ(first: float, second: float) -> bool:
    """Return whether two values differ by more than the digits of a field."""
    return not math.isclose(first, second, rel_tol=SHORT_DIGITS, abs_tol=0.0)


def _sizes(card: Card) -> tuple[str, list[float]]:
    kind = card.text(3)
    if kind not in _DIMENSIONS or card.text(2) not in ("", "MSCBML0", "MSCBMLO"):
        card.refuse(
            f"section '{kind}' of group '{card.text(2)}' is not supported; supported are "
            f"{', '.join(_DIMENSIONS)} of MSCBML0, or give A, I1, I2, J on PBAR or PBEAM"
        )
    sizes = [card.real(8 + j) for j in range(_DIMENSIONS[kind])]
    if not min(sizes) > 0 and not (kind == "TUBE" and sizes[0] > 0 == sizes[1]):
        card.refuse("dimensions of the section must be positive", 8)
    return kind, sizes


def _check_stations(card: Card, sizes: Sequence[float]) -> None:
    """Refuse a PBEAML whose dimensions change along the beam."""
    mass_field = 8 + len(sizes)
    field = mass_field + 1
    while field < len(card):
        if card.text(field) not in ("", *_STATIONS):
            card.refuse(
                f"expected YES or NO, found '{card.text(field)}'; check the number of dimensions",
                field,
            )
        _check_constant(card, field + 2, (*sizes, card.real(mass_field, 0.0)), 0)
        field += 3 + len(sizes)


def _dimensioned(card: Card, material: Material) -> BeamSection:
    kind, sizes = _sizes(card)
    if card.cards.name == "PBEAML":
        _check_stations(card, sizes)
    if (kind == "TUBE" and sizes[1] >= sizes[0]) or (
        kind == "BOX" and (2 * sizes[3] >= sizes[0] or 2 * sizes[2] >= sizes[1])
    ):
        card.refuse(f"the walls of the {kind} fill its inside; correct the dimensions", 8)
    try:
        if kind in SHAPES:
            section, symmetric = walled_section(kind, sizes)
            if card.cards.name == "PBEAML" and not symmetric:
                card.refuse(
                    f"the centroid and shear centre of {kind} differ, which is not supported; "
                    "give A, I1, I2, J on PBEAM, or use CBAR"
                )
            return section
        return dimensioned_section(kind, sizes, material.poissons_ratio)
    except ValueError as error:
        text = f"{error}: the dimensions of {kind} contradict each other; correct them"
        raise card.error(text, 8) from error
    except (OverflowError, ZeroDivisionError) as error:
        text = "the dimensions are too large or too small for a number; check the units"
        raise card.error(text, 8) from error


def dimensioned_section(kind: str, sizes: Sequence[float], nu: float) -> BeamSection:
    """Return the section of PBARL and PBEAML with sizes DIM1, DIM2, ... [length].

    Kinds are ROD (radius), TUBE (outer, inner radius), BAR (width along local z, height along
    local y), BOX (width, height, thickness of the top and bottom, thickness of the sides), and
    those of :func:`walled_section`. Shear factors depend on Poisson's ratio ν.

    Notes
    -----
    Shear factors of BOX: the area of the walls parallel to the shear. Nastran's own factors come
    from a finite element solution of the section and differ by a few per cent. Torsion of BAR: the
    usual approximation to Saint-Venant's series (W. C. Young, Roark's formulas for stress and
    strain), of BOX: Bredt's thin-walled formula.
    """
    if kind in ("ROD", "TUBE"):
        outer, inner = sizes[0], sizes[1] if kind == "TUBE" else 0.0
        return round_section(outer, inner, nu)
    width, height = sizes[:2]
    if kind == "BAR":
        long, short = max(width, height), min(width, height)
        slender = 1 - short**4 / (12 * long**4)
        torsion = long * short**3 * (1 / 3 - 0.21 * short / long * slender)
        return rectangular_section(height, width, torsion, nu)
    cover, side = sizes[2:]
    within, below = width - 2 * side, height - 2 * cover
    area = width * height - within * below
    enclosed = (width - side) * (height - cover)
    return BeamSection(
        area=area,
        inertia_z=(width * height**3 - within * below**3) / 12,
        inertia_y=(height * width**3 - below * within**3) / 12,
        torsion=2 * enclosed**2 / ((width - side) / cover + (height - cover) / side),
        shear_factor_y=2 * side * height / area,
        shear_factor_z=2 * cover * width / area,
    )
