"""CBUSH, CBUSH1D, CBEND: springs along and about local axes.

The arc of a CBEND is symmetric about the plane between its ends, so in-plane forces decouple from
out-of-plane forces. For either kind a point on the line of symmetry, the elastic centre, carries
three uncoupled springs at the end of rigid arms. Their flexibilities are integrals over the arc of
the strain energy of a thick curved bar,

    (M² / I1 + N² / A - 2 ΔN M N / I1) / 2E + V² / 2 K1 G A    in the plane of the arc,
    (B² / I2) / 2E + (T² / J + V² / K2 A) / 2G                 across it,

with N positive in tension, M if it straightens the bar, and ΔN (DELTAN) from centroid to neutral
axis towards the centre of curvature. MSC Nastran Quick Reference Guide, CBEND and PBEND.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS, SHORT_DIGITS, SOLVED
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, by_id, property_of
from faying.io.nastran.grids import BulkData, Grids
from faying.model.assembly import Bush
from faying.model.axes import any_across, axes_along

_ROWS = ("K", "B", "GE", "RCV", "M", "T", "D", "")


class _Property(NamedTuple):
    """Six stiffnesses and the mass of a bush, and whether it has damping."""

    stiffness: tuple[float, ...]
    mass: float
    damped: bool


def read_bushes(bulk: BulkData) -> list[Bush]:
    """Read bushes.

    MSC Nastran Quick Reference Guide, CBUSH, remarks 2 to 9: the axes are those of CID (at GA if
    it is curved), else x runs from GA to GB and the orientation vector lies in the x-y plane; the
    springs act at the fraction S between the nodes, or at the point given in OCID.
    """
    properties = {
        name: {
            number: read(card) for number, card in by_id(bulk.cards, name, what="property").items()
        }
        for name, read in (("PBUSH", _general), ("PBUSH1D", _axial))
    }
    bushes: list[Bush] = []
    damped = 0
    for name, family in (("CBUSH", "PBUSH"), ("CBUSH1D", "PBUSH1D")):
        for card in bulk.cards.get(name, ()):
            bush_property = property_of(card, properties[family], family)
            damped += bush_property.damped
            bushes.append(_bush(bulk, card, bush_property))
    if damped:
        bulk.ignored.append(f"damping of {damped} CBUSH (give [damping] in the study)")
    return bushes


def _general(card: Card) -> _Property:
    """Read rows of a word and up to six values: stiffness K, damping B or GE, mass M."""
    stiffness, mass, damped = [0.0] * 6, 0.0, False
    for row in range(0, len(card), 8):
        word = card.text(row + 1)
        values = range(row + 2, row + 8)
        if word not in _ROWS or (row and card.text(row)):
            card.refuse(f"'{word}' in field 3 is not supported; K, B, GE, RCV and M are", row + 1)
        if word == "K":
            stiffness = [card.real(field, 0.0) for field in values]
        elif word == "M":
            mass = card.real(row + 2, 0.0)
        elif word in ("B", "GE"):
            damped |= any(card.real(field, 0.0) for field in values)
        elif word in ("T", "D") and any(card.text(field) for field in values):
            card.refuse(
                f"{word} (thermal or initial deformation) is not supported; remove the row", row + 1
            )
    return _checked(card, stiffness, mass, damped)


def _axial(card: Card) -> _Property:
    """Read K, C, M of a PBUSH1D; refuse nonlinear springs and dampers."""
    if any(card.text(field) for field in range(8, len(card))):
        card.refuse("a nonlinear spring or damper is not supported; keep K, C and M only", 8)
    stiffness = [card.real(1, 0.0), *[0.0] * 5]
    return _checked(card, stiffness, card.real(3, 0.0), bool(card.real(2, 0.0)))


def _checked(card: Card, stiffness: list[float], mass: float, damped: bool) -> _Property:
    if mass < 0 or min(stiffness) < 0:
        card.refuse(f"stiffness {min(stiffness):g}, mass {mass:g}; neither may be negative")
    return _Property(tuple(stiffness), mass, damped)


def _bush(bulk: BulkData, card: Card, bush_property: _Property) -> Bush:
    start = bulk.grids.one(card, 2)
    end = bulk.grids.one(card, 3) if card.integer(3, 0) else None
    line = np.zeros(3) if end is None else bulk.grids.nodes[end] - bulk.grids.nodes[start]
    return Bush.of_arrays(
        card.integer(0),
        [start] if end is None else [start, end],
        bush_property.stiffness,
        _axes(card, bush_property, bulk.grids, start, line),
        _place(card, bulk.grids, start, line),
        bush_property.mass * bulk.mass_factor,
    )


def _axes(card: Card, bush_property: _Property, grids: Grids, start: int, line: Vector) -> Matrix:
    field = 7 if card.cards.name == "CBUSH" else 4
    if card.text(field):
        frame = grids.systems.frame_of(card, field)
        of_frame = np.asarray(frame.directions(grids.nodes[start][None])[0])
        if card.cards.name == "CBUSH1D" and np.abs(
            np.cross(of_frame[0], line)
        ).max() > DECK_DIGITS * max(float(np.abs(line).max()), 1e-300):
            card.refuse(
                "its nodes lie apart across the axis of CID; use CBUSH, or leave CID blank", field
            )
        return of_frame
    if not 0 < np.linalg.norm(line) < np.inf:
        card.refuse("its nodes coincide or GB is blank; give the axes of the springs by CID", field)
    vector = orientation(card, grids, start) if field == 7 else None
    if vector is None:
        if any(bush_property.stiffness[component] for component in (1, 2, 4, 5)):
            card.refuse(
                "springs across the line of its nodes need an orientation (GO, X1 to X3 or CID)", 4
            )
        vector = np.array(any_across(line))
    return element_axes(card, line, vector)


def element_axes(card: Card, line: Vector, vector: Vector) -> Matrix:
    """Return the axes (3, 3) of an element along a line, y towards a vector."""
    if not 0 < np.linalg.norm(line) < np.inf:
        card.refuse("the element has no length; its two nodes coincide")
    axes = axes_along(line, vector)
    if axes is None:
        card.refuse(
            "the orientation vector is zero or parallel to the line of its nodes; give another one",
            4,
        )
    return axes


def orientation(card: Card, grids: Grids, start: int, *, basic: bool = False) -> Vector | None:
    """Return the orientation vector in the basic frame; None if the card has none.

    The card has basic components, or components in the displacement system of the first grid.
    """
    if not any(card.text(field) for field in (4, 5, 6)):
        return None
    if not card.text(5) and not card.text(6) and numbers.integer(card.text(4)) is not None:
        return np.asarray(grids.nodes[grids.one(card, 4)] - grids.nodes[start])
    vector = card.reals((4, 5, 6), 0.0)
    axes = None if basic else grids.systems.axes(start)
    return vector if axes is None else np.asarray(vector @ axes)


def _place(card: Card, grids: Grids, start: int, line: Vector) -> Vector:
    """Return the coordinates (3,) where the springs act."""
    if card.cards.name == "CBUSH1D":
        return np.asarray(grids.nodes[start])
    if card.integer(9, -1) >= 0:
        location = np.array([[card.real(field, 0.0) for field in (10, 11, 12)]])
        return np.asarray(grids.systems.frame_of(card, 9).to_basic(location)[0])
    return np.asarray(grids.nodes[start] + card.real(8, 0.5) * line)


@dataclass(frozen=True, kw_only=True)
class _Arc:
    """An arc: chord from A to B, direction away from the centre, radius and angle spanned."""

    centre: Vector
    chord: Vector
    outward: Vector
    radius: float
    angle: float


def read_bends(bulk: BulkData) -> list[Bush]:
    """Read curved bars, with half of the mass of each at either end."""
    bushes: list[Bush] = []
    properties = by_id(bulk.cards, "PBEND", what="property")
    heavy = 0
    for card in bulk.cards.get("CBEND", ()):
        bend = property_of(card, properties, "PBEND")
        of_card = _bushes(card, bend, bulk)
        heavy += of_card[0].mass > 0
        bushes += of_card
    if heavy:
        bulk.ignored.append(f"mass of {heavy} CBEND: half of it at either end, without inertia")
    return bushes


def _arc(card: Card, section: Card, grids: Grids) -> _Arc:
    start, end = (grids.nodes[grids.one(card, field)] for field in (2, 3))
    line = end - start
    length = float(np.linalg.norm(line))
    vector = orientation(card, grids, grids.one(card, 2))
    size = 0.0 if vector is None else float(np.linalg.norm(vector))
    if vector is None or not (0 < length < np.inf and 0 < size < np.inf):
        card.refuse("its nodes coincide, or G0 or X1 to X3 give no direction", 4)
    chord, vector = line / length, vector / size
    along = float(vector @ chord)
    side = vector - along * chord
    width = float(np.linalg.norm(side))
    if not width > SOLVED:
        card.refuse(
            "G0 or X1 to X3 lie on the line of the nodes; they must span the plane of the arc", 4
        )
    side = side / width
    half, outward = _half_angle(card, section, along, width, length)
    radius = length / (2 * math.sin(half))
    return _Arc(
        centre=start + length / 2 * chord - outward * radius * math.cos(half) * side,
        chord=chord,
        outward=outward * side,
        radius=radius,
        angle=2 * half,
    )


def _half_angle(
    card: Card, section: Card, along: float, width: float, length: float
) -> tuple[float, float]:
    """Return half the angle of the arc, and its side of the chord: 1 if it is that of O."""
    geometry, radius, angle = card.integer(7), section.real(6, 0.0), section.real(7, 0.0)
    if geometry == 1 and not (radius or angle):
        if abs(along) > SOLVED:
            return math.atan2(abs(along), width), -math.copysign(1.0, along)
        text = "the line to the centre of curvature is square to the chord: no arc ends there"
    elif geometry == 2 and not (radius or angle):
        if along > -SOLVED:
            return min(math.atan2(width, along), math.pi / 2), 1.0
        text = "the tangent at GA leads away from GB: more than a half circle is not supported"
    elif geometry == 3 and radius > 0 and not angle:
        if length <= 2 * radius * (1 + SHORT_DIGITS):
            return math.asin(min(length / (2 * radius), 1.0)), 1.0
        text = f"RB = {radius:g} is smaller than half the distance {length:g} of the nodes"
    elif geometry == 4 and 0 < angle <= 180 and not radius:
        return math.radians(angle) / 2, 1.0
    else:
        text = (
            f"GEOM = {geometry} with RB = {radius:g}, THETAB = {angle:g}; 1 and 2 have neither, 3 "
            "has RB, 4 has THETAB up to 180"
        )
    raise card.error(text, 7)


def _bushes(card: Card, bend: Card, bulk: BulkData) -> list[Bush]:
    """Return the bush in the plane of the arc and that across it."""
    if numbers.integer(bend.text(2)) is not None:
        bend.refuse(
            f"FSI = {bend.text(2)}, a pipe whose flexibility depends on codes of piping, is not "
            "supported; give A, I1, I2 and J",
            2,
        )
    bend.refuse_non_zero([19, 20], "an offset", "move the grid points to the centroid")
    material, factor = bulk.material(bend, 1)
    shear_modulus = factor * material.youngs_modulus / (2 * (1 + material.poissons_ratio))
    if not shear_modulus > 0:
        bend.refuse(f"its material has G = {shear_modulus:g}, which must be positive", 1)
    arc = _arc(card, bend, bulk.grids)
    radius, angle = arc.radius, arc.angle
    area, inertia, inertia_across, torsion = bend.reals((2, 3, 4, 5), 0.0).tolist()
    axial, bending, bending_across = (
        material.youngs_modulus * size for size in (area, inertia, inertia_across)
    )
    twisting = shear_modulus * torsion
    # Flexibilities in shear, zero where the section is rigid.
    shear, shear_across = (
        0.0 if share == 0.0 else 1 / (share * shear_modulus * area)
        for share in bend.reals((16, 17), 0.0).tolist()
    )
    neutral = bend.real(21, bending / (axial * radius))
    # Integrals over the arc of 1, cos, cos² and sin² of the angle from its middle.
    whole, cosine = radius * angle, 2 * radius * math.sin(angle / 2)
    cos2, sin2 = (radius / 2 * (angle + sign * math.sin(angle)) for sign in (1, -1))

    stretch = 1 / axial + radius * (radius - 2 * neutral) / bending
    chordwise = stretch * cos2 + shear * sin2
    outward = stretch * sin2 + shear * cos2
    turn = whole / bending
    coupled = (radius - neutral) * cosine / bending
    plane = (chordwise - coupled**2 / turn, outward, turn)

    sideways = whole * (radius**2 / twisting + shear_across)
    twist = cos2 / twisting + sin2 / bending_across
    nod = sin2 / twisting + cos2 / bending_across
    twisted = -radius * cosine / twisting
    across = (sideways - twisted**2 / twist, twist, nod)

    if not min(*plane, *across) > 0:
        card.refuse(
            f"DELTAN = {neutral:g} is impossible for a curved bar of radius {radius:g}; correct it"
        )
    ends = bulk.grids.one(card, 2), bulk.grids.one(card, 3)
    axes = np.array([arc.chord, arc.outward, np.cross(arc.chord, arc.outward)])
    stiff = [1 / flexibility for flexibility in (*plane, *across)]
    mass = (material.density * area + bend.real(18, 0.0) * bulk.mass_factor) * whole
    return [
        Bush.of_arrays(
            card.integer(0), ends, springs, axes, arc.centre + shift * arc.outward, share
        )
        for springs, shift, share in (
            ({0: stiff[0], 1: stiff[1], 5: stiff[2]}, coupled / turn, mass),
            ({2: stiff[3], 3: stiff[4], 4: stiff[5]}, -twisted / twist, 0.0),
        )
    ]
