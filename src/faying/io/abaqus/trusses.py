"""``T3D2`` with *SOLID SECTION: trusses as beams without bending stiffness."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import Elements
from faying.io.abaqus.fields import optional_real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.solid_sections import find_isotropic
from faying.model.assembly import Beam, BeamSection, Material

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
            row = int(block.rows[i])
            if element_id not in sections:
                block.keyword.refuse(
                    f"truss {element_id} has no *SOLID SECTION; give its set one", row
                )
            start, end = block.nodes[i].tolist()
            along = coordinates[end] - coordinates[start]
            if not along.any():
                block.keyword.refuse(f"truss {element_id} has no length; its nodes coincide", row)
            # Any direction that is not the truss's own.
            side = np.eye(3)[int(np.abs(along).argmin())]
            number, section, material = sections[element_id]
            yield Beam(
                id=element_id,
                nodes=(start, end),
                section=section,
                material=material,
                orientation=(float(side[0]), float(side[1]), float(side[2])),
                property=number,
            )


def _section(keyword: Keyword) -> BeamSection:
    rows = keyword.rows()
    area = optional_real(keyword, 0, rows[0], 0, 1.0, "an area") if rows else 1.0
    if not area > 0:
        keyword.refuse(f"the area is {area:g}; it must be positive", 0)
    return BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=0.0)
