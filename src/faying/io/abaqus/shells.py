"""``*SHELL SECTION``: shells of one isotropic layer, with six degrees of freedom a node."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Vector
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import only_line, positive, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.mesh import SHELL_TYPES
from faying.io.abaqus.solid_sections import find_isotropic
from faying.io.element_faces import shell_facets
from faying.model.assembly import Material
from faying.model.shells import ShellBlock, ShellSection, plane_stress

_SHEAR_FACTOR = 5 / 6
"""Shear area over thickness of one layer, for the work of a parabola of shear stress."""
_SIDES = {"SPOS": 0.5, "SNEG": -0.5}
"""Named offsets of the nodes from the middle of the shell, over its thickness."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shells:
    """Shells of a deck, their sections by number, and the thickness of each section."""

    blocks: tuple[ShellBlock, ...] = ()
    sections: Mapping[int, ShellSection] = field(default_factory=dict)
    thicknesses: Mapping[int, float] = field(default_factory=dict)

    def facets(self, ids: Indices, side: float) -> tuple[dict[str, Indices], Vector]:
        """Return facets (kind to nodes) of a side of shells, and how far it lies off their nodes.

        The side is 1 where the normal points, -1 on the other one.
        """
        facets: dict[str, list[Indices]] = {}
        heights = [np.empty(0)]
        for block in self.blocks:
            chosen = np.isin(block.ids, ids)
            thick = np.array([self.thicknesses[n] for n in block.properties[chosen].tolist()])
            heights.append(side * block.offsets[chosen] + thick / 2)
            if chosen.any():
                turned = np.full(int(chosen.sum()), side < 0)
                facets.setdefault(block.kind, []).append(shell_facets(block, chosen, turned))
        joined = {kind: np.concatenate(parts) for kind, parts in facets.items()}
        return joined, np.concatenate(heights)


def read_shells(data: DeckData, materials: Mapping[str, Material]) -> Shells:
    """Read all shells; their sections are numbered behind those of solids and beams."""
    deck, sets = data.deck, data.element_sets
    all_blocks = data.elements.of(*SHELL_TYPES)
    if not all_blocks:
        return Shells()
    ids = np.concatenate([block.ids for block in all_blocks])
    number = np.zeros(len(ids), dtype=np.int64)
    offset = np.zeros(len(ids))
    sections: dict[int, ShellSection] = {}
    thicknesses: dict[int, float] = {}
    others = deck.of("SOLID SECTION", "BEAM SECTION", "BEAM GENERAL SECTION")
    for section_number, keyword in enumerate(deck.of("SHELL SECTION"), start=len(others) + 1):
        chosen = np.isin(ids, sets.find(keyword, keyword.required("ELSET")))
        thickness = thicknesses[section_number] = positive(
            keyword, 0, only_line(keyword, range(1, 9), "the thickness")[0], "the thickness"
        )
        number[chosen] = section_number
        # Theirs is that of the nodes from the middle, ours that of the middle from the nodes.
        offset[chosen] = -_offset(keyword) * thickness
        sections[section_number] = _section(find_isotropic(materials, keyword), thickness)
    missing = np.flatnonzero(number == 0)
    start, blocks = 0, []
    for block in all_blocks:
        rows = slice(start, start + len(block.ids))
        start += len(block.ids)
        lost = missing[(missing >= rows.start) & (missing < rows.stop)]
        if lost.size:
            block.keyword.refuse(
                f"shell {ids[lost[0]]} has no *SHELL SECTION; give its set one",
                int(block.rows[lost[0] - rows.start]),
            )
        blocks.append(
            ShellBlock(
                kind=SHELL_TYPES[block.type][0],
                nodes=block.nodes,
                ids=block.ids,
                properties=number[rows],
                offsets=offset[rows],
                directions=np.zeros((len(block.ids), 3)),
            )
        )
    deck.ignored.append(
        f"{len(ids)} shells: surfaces with rotations at their nodes, as in Abaqus, with a drilling "
        "stiffness, shear and mass of their own; CalculiX makes solids of them, which differ where "
        "shells are thick, coarse or joined at angles"
    )
    return Shells(blocks=tuple(blocks), sections=sections, thicknesses=thicknesses)


def _offset(keyword: Keyword) -> float:
    text = keyword.choice("OFFSET", "0")
    return _SIDES[text] if text in _SIDES else real(keyword, None, text, "OFFSET")


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
