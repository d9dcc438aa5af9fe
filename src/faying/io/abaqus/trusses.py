"""``T3D2`` with *SOLID SECTION: trusses as beams without bending stiffness."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import Elements
from faying.io.abaqus.fields import positive
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.solid_sections import find_isotropic
from faying.model.assembly import Beam, BeamSection, Material
from faying.model.axes import any_across

TYPES = ("T3D2",)


def read_trusses(
    deck: Deck,
    elements: Elements,
    sets: NamedSets,
    materials: Mapping[str, Material],
    coordinates: Matrix,
) -> Iterator[Beam]:
    """Read trusses; their area is 1 where the section gives none, as in both programs."""
    blocks = elements.of(*TYPES)
    if not blocks:
        return
    truss_ids = np.concatenate([block.ids for block in blocks])
    sections: dict[int, tuple[int, BeamSection, Material]] = {}
    for number, keyword in enumerate(deck.of("SOLID SECTION"), start=1):
        ids = sets.find(keyword, keyword.required("ELSET"))
        members = ids[np.isin(ids, truss_ids)].tolist()
        if members:
            member = number, _section(keyword), find_isotropic(materials, keyword)
            sections.update(dict.fromkeys(members, member))
    for block in blocks:
        for i, element_id in enumerate(block.ids.tolist()):
            number, section, material = block.section(i, sections, "SOLID SECTION")
            start, end = block.nodes[i].tolist()
            along = coordinates[end] - coordinates[start]
            if not along.any():
                message = f"truss {element_id} has no length; its nodes coincide"
                block.keyword.refuse(message, int(block.rows[i]))
            yield Beam(
                id=element_id,
                nodes=(start, end),
                section=section,
                material=material,
                orientation=any_across(along),
                property=number,
            )


def _section(keyword: Keyword) -> BeamSection:
    rows = keyword.rows()
    area = positive(keyword, 0, rows[0][0], "an area") if rows and rows[0][0] else 1.0
    return BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=0.0)
