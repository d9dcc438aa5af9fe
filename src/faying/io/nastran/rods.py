"""CROD, CTUBE, CONROD with PROD, PTUBE: straight members of axial and torsional stiffness."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, by_id, property_of
from faying.io.nastran.grids import Grids
from faying.io.nastran.sections import with_shear
from faying.io.nastran.solids import material_of
from faying.model.assembly import Beam, BeamSection, Material
from faying.model.axes import any_across

Member = tuple[BeamSection, Material]


def read_rods(
    bulk: BulkData, materials: Mapping[int, Material], factors: Mapping[int, float]
) -> list[Beam]:
    """Read rods as beams without bending stiffness, whose mass lies along a straight line.

    Non-structural mass is added to the density.
    """
    rods: list[Beam] = []
    for name, family, read in (("CROD", "PROD", _bar), ("CTUBE", "PTUBE", _tube)):
        members: dict[int, Member] = {}
        for number, card in by_id(bulk.cards, family, what="property").items():
            section, heavy = read(card, material_of(card, 1, materials), bulk.mass_factor)
            members[number] = with_shear(section, factors.get(card.integer(1), 1.0)), heavy
        for card in bulk.cards.get(name, ()):
            member = property_of(card, members, family)
            rods.append(_rod(card, bulk.grids, (2, 3), member, card.integer(1, card.integer(0))))
    for card in bulk.cards.get("CONROD", ()):
        material = material_of(card, 3, materials)
        section, heavy = _member(card, 4, material, bulk.mass_factor)
        member = (with_shear(section, factors.get(card.integer(3), 1.0)), heavy)
        rods.append(_rod(card, bulk.grids, (1, 2), member, 0))
    return rods


def _bar(card: Card, material: Material, mass_factor: float) -> Member:
    return _member(card, 2, material, mass_factor)


def _member(card: Card, first: int, material: Material, mass_factor: float) -> Member:
    """Section from A, J, C, NSM; C serves stresses only."""
    line_mass = card.real(first + 3, 0.0) * mass_factor
    return _heavy(card.real(first), card.real(first + 1, 0.0), line_mass, material)


def _tube(card: Card, material: Material, mass_factor: float) -> Member:
    """Section from outer diameter, wall (none is a solid rod), NSM, diameter at the other end."""
    outer = card.real(2)
    wall = card.real(3, 0.0) or outer / 2
    end = card.real(5, outer)
    if wall > outer / 2:
        card.refuse(f"OD = {outer:g} with T = {wall:g} is no tube; T is at most half of OD", 3)
    if not math.isclose(end, outer, rel_tol=1e-3):
        card.refuse(
            f"OD2 = {end:g} differs from OD = {outer:g}; divide the tube into constant pieces", 5
        )
    inner = outer - 2 * wall
    area = math.pi / 4 * (outer**2 - inner**2)
    polar = math.pi / 32 * (outer**4 - inner**4)
    return _heavy(area, polar, card.real(4, 0.0) * mass_factor, material)


def _heavy(area: float, torsion: float, line_mass: float, material: Material) -> Member:
    heavy = replace(material, density=material.density + line_mass / area)
    section = BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=torsion)
    return section, heavy


def _rod(card: Card, grids: Grids, ends: tuple[int, int], member: Member, number: int) -> Beam:
    start, end = (grids.one(card, field) for field in ends)
    with np.errstate(over="ignore"):
        axis = np.abs(grids.nodes[end] - grids.nodes[start])
        length = float(np.linalg.norm(axis))
    if not 0 < length < math.inf:
        card.refuse("the rod has no length; its two nodes coincide")
    return Beam(
        id=card.integer(0),
        nodes=(start, end),
        section=member[0],
        material=member[1],
        orientation=any_across(axis),
        property=number,
    )
