"""``*SHELL SECTION``: shells of one isotropic layer, with six degrees of freedom per node."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Vector
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import only_line, parameter
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.mesh import SHELL_TYPES
from faying.io.abaqus.sets import section_numbers
from faying.io.abaqus.solid_sections import find_isotropic
from faying.io.element_faces import shell_facets
from faying.model.assembly import Material
from faying.model.shells import ShellBlock, ShellSection, plane_stress
from faying.model.surface import WIDTH, padded

_SHEAR_FACTOR = 5 / 6
"""Shear area over thickness of one layer, for parabolic shear stress."""
_SIDES = {"SPOS": 0.5, "SNEG": -0.5}
"""Named offsets of the nodes from the mid-surface, over the thickness."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shells:
    """The shells of a deck, with sections and thicknesses by section number."""

    blocks: tuple[ShellBlock, ...] = ()
    sections: Mapping[int, ShellSection] = field(default_factory=dict)
    thicknesses: Mapping[int, float] = field(default_factory=dict)

    def facets(self, ids: Indices, side: float) -> tuple[Indices, Vector]:
        """Return the facets (n, 8) of a side of shells, and its distance from their nodes.

        ``side`` is 1 along the normal, -1 against it.
        """
        tables, heights = [np.empty((0, WIDTH), dtype=np.int64)], [np.empty(0)]
        for block in self.blocks:
            chosen = np.isin(block.ids, ids)
            thick = np.array([self.thicknesses[n] for n in block.properties[chosen].tolist()])
            heights.append(side * block.offsets[chosen] + thick / 2)
            turned = np.full(int(chosen.sum()), side < 0)
            tables.append(padded(shell_facets(block, chosen, turned)))
        return np.concatenate(tables), np.concatenate(heights)


def read_shells(data: DeckData, materials: Mapping[str, Material]) -> Shells:
    """Read all shells; their sections are numbered after those of solids and beams."""
    deck, sets = data.deck, data.element_sets
    all_blocks = data.elements.of(*SHELL_TYPES)
    if not all_blocks:
        return Shells()
    keywords = deck.of("SHELL SECTION")
    first = len(deck.of("SOLID SECTION", "BEAM SECTION", "BEAM GENERAL SECTION")) + 1
    thicknesses = [
        only_line(keyword, range(1, 9), "the thickness").positive(0, "the thickness")
        for keyword in keywords
    ]
    # The deck offsets nodes from the mid-surface, faying the mid-surface from nodes.
    offsets = np.array([-_offset(k) * t for k, t in zip(keywords, thicknesses, strict=True)])
    numbers = section_numbers("SHELL SECTION", keywords, all_blocks, sets, deck.ignored)
    blocks = tuple(
        ShellBlock(
            kind=SHELL_TYPES[block.type][0],
            nodes=block.nodes,
            ids=block.ids,
            properties=first + number,
            offsets=offsets[number],
            directions=np.zeros((len(block.ids), 3)),
        )
        for block, number in zip(all_blocks, numbers, strict=True)
    )
    deck.ignored.append(
        f"{sum(map(len, numbers))} shells: surfaces with rotations at their nodes, as in Abaqus, "
        "with faying's drilling stiffness, shear and mass; CalculiX expands them to solids, "
        "which differ where shells are thick, coarse or joined at angles"
    )
    sections = [
        _section(find_isotropic(materials, keyword), thickness)
        for keyword, thickness in zip(keywords, thicknesses, strict=True)
    ]
    return Shells(
        blocks=blocks,
        sections=dict(enumerate(sections, start=first)),
        thicknesses=dict(enumerate(thicknesses, start=first)),
    )


def _offset(keyword: Keyword) -> float:
    side = _SIDES.get(keyword.choice("OFFSET"))
    return parameter(keyword, "OFFSET", 0.0) if side is None else side


def _section(material: Material, thickness: float) -> ShellSection:
    law = np.zeros((6, 6))
    plane = plane_stress(material.youngs_modulus, material.poissons_ratio)
    law[:3, :3] = thickness * plane
    law[3:, 3:] = thickness**3 / 12 * plane
    shear = material.youngs_modulus / (2 * (1 + material.poissons_ratio))
    return ShellSection(
        stiffness=law,
        shear=_SHEAR_FACTOR * thickness * shear * np.eye(2),
        mass=material.density * thickness,
        inertia=material.density * thickness**3 / 12,
        materials=(material.name,),
    )
