"""CTRIA3, CQUAD4, CTRIA6, CQUAD8, CTRIAR, CQUADR, CSHEAR: shells and shear panels."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.io.nastran import fields as numbers
from faying.io.nastran.card_table import place_of
from faying.io.nastran.cards import Card, Cards, by_id
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.shell_sections import ShellProperty
from faying.io.nastran.solids import element_nodes, property_ids, used_properties
from faying.io.straight_sides import StraightSides
from faying.model.assembly import Beam, BeamSection, Material
from faying.model.axes import any_across
from faying.model.elements import FACES
from faying.model.shell_matrices import PANEL
from faying.model.shells import ShellBlock, ShellSection

_KINDS = {
    **{"CTRIA3": "tri3", "CQUAD4": "quad4", "CTRIA6": "tri6", "CQUAD8": "quad8"},
    **{"CTRIAR": "tri3", "CQUADR": "quad4", "CSHEAR": PANEL},
}
SHELL_CARDS = tuple(_KINDS)

ROTATING = "CTRIAR and CQUADR are read as CTRIA3 and CQUAD4, without drilling stiffness"
"""Note on elements that resist rotations about the normal in Nastran."""

CURVED = (
    "CTRIA6 and CQUAD8 have another transverse shear than Nastran's: on a coarse mesh they "
    "deflect more (19 % for 28 CTRIA6 in a plate held at its corners); compare a finer mesh"
)
"""Note on shells with mid-side nodes."""


_N_CORNERS = {**{kind: face.n_corners for kind, face in FACES.items()}, PANEL: 4}


def read_shells(
    bulk: BulkData, properties: Mapping[int, ShellProperty], straight: StraightSides
) -> tuple[tuple[ShellBlock, ...], dict[int, ShellSection]]:
    """Return shells and their sections.

    A blank mid-side node becomes a new node that moves as the mean of the ends of the side. Shells
    with nodal thicknesses have the mean thickness; their sections are numbered after the
    properties of the deck.
    """
    blocks: list[ShellBlock] = []
    sections: dict[int, ShellSection] = {}
    by_thickness: dict[tuple[int, float], int] = {}
    middle = partial(straight.between, turns=True)
    for name, kind in _KINDS.items():
        if name not in bulk.cards:
            continue
        cards_of_name = bulk.cards[name]
        n = _N_CORNERS[kind]
        curved = kind in FACES and FACES[kind].n_nodes > n
        sides = [(j, (j + 1) % n) for j in range(n)] if curved else []
        nodes, _ = element_nodes(cards_of_name, n, sides, bulk.grids, middle)
        numbers_of = property_ids(cards_of_name)
        for number in used_properties(cards_of_name, properties, "PSHELL, PCOMP, ..."):
            sections[number] = properties[number].section(properties[number].thickness)
        numbers_of = _thick(cards_of_name, kind, numbers_of, properties, sections, by_thickness)
        blocks.append(
            ShellBlock(
                kind=kind,
                nodes=nodes,
                ids=cards_of_name.integers(0),
                properties=numbers_of,
                offsets=cards_of_name.reals(place_of(name, "ZOFFS"), 0.0),
                directions=_directions(cards_of_name, kind, nodes, bulk.grids),
            )
        )
    if straight.turning:
        bulk.ignored.append(
            f"{len(straight.turning)} blank mid-side nodes of shells: straight sides"
        )
    if "CTRIAR" in bulk.cards or "CQUADR" in bulk.cards:
        bulk.ignored.append(ROTATING)
    if "CTRIA6" in bulk.cards or "CQUAD8" in bulk.cards:
        bulk.ignored.append(CURVED)
    return tuple(blocks), sections


def _thick(
    cards: Cards,
    kind: str,
    numbers_of: Indices,
    properties: Mapping[int, ShellProperty],
    sections: dict[int, ShellSection],
    by_thickness: dict[tuple[int, float], int],
) -> Indices:
    """Return property numbers of shells; shells with nodal thicknesses get new ones."""
    n_corner = _N_CORNERS[kind]
    first, flag = place_of(cards.name, "T1"), place_of(cards.name, "TFLAG")
    columns = range(first, first + n_corner)
    thick = np.flatnonzero(np.any([cards.given(field) for field in columns], axis=0))
    result = numbers_of.copy()
    for card in cards.take(thick):
        row = int(thick[card.number])
        number = int(numbers_of[row])
        usual = properties[number].thickness
        relative = card.integer(flag, 0) == 1
        values = [card.real(field, 1.0 if relative else usual) for field in columns]
        thickness = float(np.mean(values)) * (usual if relative else 1.0)
        if min(values) < 0 or not thickness > 0:
            card.refuse("thicknesses T1 to T4 must not be negative, and one positive", first)
        if abs(thickness - usual) <= DECK_DIGITS * usual:
            continue
        key = (number, thickness)
        if key not in by_thickness:
            by_thickness[key] = max([*properties, *by_thickness.values()]) + 1
            sections[by_thickness[key]] = properties[number].section(thickness)
        result[row] = by_thickness[key]
    return result


def _directions(cards: Cards, kind: str, nodes: Indices, grids: Grids) -> Matrix:
    """Return the material's x axis (n, 3): at THETA to the first side, or the x axis of MCID."""
    theta = place_of(cards.name, "THETA")
    raw = cards.column(theta)
    _, not_integer = numbers.integers(raw)
    angle = np.radians(cards.reals(theta, 0.0))
    places = grids.nodes[nodes[:, : _N_CORNERS[kind]]]
    result = _at_angle(places, np.where(not_integer, angle, 0.0))
    rows = np.flatnonzero(~not_integer)
    centres = places[rows].mean(axis=1)
    axes = grids.systems.directions_at(cards.take(rows), theta, np.arange(len(rows)), centres)
    result[rows] = axes[:, 0]
    return result


def _at_angle(places: Matrix, angle: Vector) -> Matrix:
    """Return the direction (n, 3) of the first side, turned about the normal."""
    side = places[:, 1] - places[:, 0]
    third = places[:, 2] - places[:, 0]
    normal = np.cross(side, third)
    size = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(size > 0, size, 1.0)[:, None]
    return np.asarray(np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(unit, side))


_FULL = 1.01
"""Largest F1 with rods of an area from the panel's area (MSC's number)."""


def read_panel_sides(bulk: BulkData, first: int) -> list[Beam]:
    """Return massless rods along the sides of shear panels, numbered from ``first``.

    MSC Nastran Quick Reference Guide: up to F1 = 1.01 the rods on sides 1-2 and 3-4 have the area
    F1 T P / (L12 + L34) each, with the area P of the panel and the lengths L of the sides:
    with F1 = 1 they carry all normal stress of the panel along them. Above, F1 T² / 2, a width
    of F1 T in total. F2 is the same for sides 2-3 and 4-1.
    """
    rods: list[Beam] = []
    properties = by_id(bulk.cards, "PSHEAR")
    for card in bulk.cards.get("CSHEAR", ()):
        panel = properties[card.integer(1, card.integer(0))]
        factors = panel.real(4, 0.0), panel.real(5, 0.0)
        if any(factors):
            material, _ = bulk.material(panel, 1)
            rods += _sides(card, bulk.grids, factors, panel.real(2), material, first + len(rods))
    return rods


def _sides(
    card: Card,
    grids: Grids,
    factors: tuple[float, float],
    thickness: float,
    material: Material,
    first: int,
) -> list[Beam]:
    nodes = [grids.one(card, 2 + j) for j in range(4)]
    corners = grids.nodes[nodes]
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(sides, axis=1)
    panel = float(np.linalg.norm(np.cross(corners[2] - corners[0], corners[3] - corners[1])) / 2)
    areas = []
    for pair, factor in enumerate(factors):
        width = panel / float(lengths[pair] + lengths[pair + 2])
        areas.append(factor * thickness * (width if factor <= _FULL else thickness / 2))
    loaded = [side for side in (0, 2, 1, 3) if factors[side % 2] != 0]
    return [
        Beam(
            id=number,
            nodes=(nodes[side], nodes[(side + 1) % 4]),
            section=BeamSection(area=areas[side % 2], inertia_y=0.0, inertia_z=0.0, torsion=0.0),
            material=replace(material, density=0.0, expansion=None),
            orientation=any_across(sides[side]),
        )
        for number, side in enumerate(loaded, first)
    ]
