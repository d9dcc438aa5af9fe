"""F1 and F2 of PSHEAR: what shear panels carry along their sides, as rods.

MSC Nastran Quick Reference Guide: up to F1 = 1.01 the rods on sides 1-2 and 3-4 have the area
F1 T P / (L12 + L34) each, with the area P of the panel and the lengths L of the sides, so that
F1 = 1 is a panel that carries all of its normal stress along them; beyond, F1 T² / 2, a width of
F1 T in all. F2 is the same of sides 2-3 and 4-1.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying.io.nastran.cards import Card, Cards, by_id
from faying.io.nastran.grids import Grids
from faying.io.nastran.solids import material_of
from faying.model.assembly import Beam, BeamSection, Material
from faying.model.axes import any_across

_FULL = 1.01


def read_panel_sides(
    cards: Mapping[str, Cards], grids: Grids, materials: Mapping[int, Material], first: int
) -> list[Beam]:
    """Return rods without mass, numbered from ``first`` on."""
    rods: list[Beam] = []
    properties = by_id(cards, "PSHEAR")
    for card in cards.get("CSHEAR", ()):
        panel = properties[card.integer(1, card.integer(0))]
        factors = panel.real(4, 0.0), panel.real(5, 0.0)
        if any(factors):
            material = material_of(panel, 1, materials)
            rods += _sides(card, grids, factors, panel.real(2), material, first + len(rods))
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
    rods: list[Beam] = []
    for pair, factor in ((0, factors[0]), (1, factors[1])):
        if factor == 0:
            continue
        width = panel / float(lengths[pair] + lengths[pair + 2])
        area = factor * thickness * (width if factor <= _FULL else thickness / 2)
        for side in (pair, pair + 2):
            rods.append(
                Beam(
                    id=first + len(rods),
                    nodes=(nodes[side], nodes[(side + 1) % 4]),
                    section=BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=0.0),
                    material=replace(material, density=0.0, expansion=None),
                    orientation=any_across(sides[side]),
                )
            )
    return rods
