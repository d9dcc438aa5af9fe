"""BSURF, BSURFS, BCPROP, BCPROPS: contact regions on solids.

Simcenter Nastran Quick Reference Guide, BSURFS: an element and three corner grids of its face;
BSURF and BCPROP(S) name elements and properties, whose exterior faces are the region.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Mask
from faying.io.element_faces import find_faces, numbered_faces
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, id_list
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.solids import SOLID_CARDS
from faying.io.solid_cuts import Cut, on_their_sides
from faying.model.assembly import FaceSet
from faying.model.cells import CellBlock
from faying.model.elements import FACES
from faying.model.mesh import Mesh
from faying.model.surface import rows_by_kind


@dataclass(frozen=True, eq=False, kw_only=True)
class Region:
    """A contact region: the card and what it selects.

    Attributes
    ----------
    name
        Face set or element set of the assembly.
    facets : (n_facet, 8)
        Of BSURFS: node indices, -1 behind the last; of several kinds perhaps.
    elements : (n,)
        Of the other cards: element ids.
    shells : (n,)
        Of BSURF of shells: element ids; ``facets`` are then those of the side that touches.
    """

    card: Card
    name: str
    facets: Indices | None = None
    elements: Indices | None = None
    shells: Indices | None = None

    def on_sides_of(self, mesh: Mesh, cuts: Sequence[Cut]) -> "Region":
        """Return the region on a mesh that was cut."""
        if self.facets is None or not cuts:
            return self
        return replace(self, facets=on_their_sides(mesh, cuts, self.facets))

    @property
    def face_set(self) -> FaceSet | None:
        """The faces of BSURFS if they are of one kind."""
        if self.facets is None or not len(self.facets):
            return None
        kinds = list(rows_by_kind(self.facets))
        if len(kinds) > 1:
            return None
        return FaceSet(kind=kinds[0], nodes=self.facets[:, : FACES[kinds[0]].n_nodes])


_SIDES = {f"S{number}": number for number in range(1, 7)}
"""Sides of CHEXA that BCSURF names."""


def read_regions(bulk: BulkData, solids: Sequence[CellBlock], shells: Indices) -> dict[int, Region]:
    """Read contact regions by id, BCSURF, which are contact bodies, by the negative of theirs."""
    regions: dict[int, Region] = {}
    ids = np.concatenate([np.zeros(0, dtype=np.int64), *(block.ids for block in solids)])
    properties = np.concatenate([ids[:0], *(block.properties for block in solids)])
    for card in bulk.cards.get("BSURF", ()):
        both = np.sort(np.concatenate([ids, shells]))
        listed = np.array(id_list(card, card.texts[1:], both), dtype=np.int64)
        region = Region(card=card, name=f"bsurf:{card.integer(0)}")
        solid, thin = (listed[np.isin(listed, ids_of_kind)] for ids_of_kind in (ids, shells))
        region = replace(region, shells=thin) if len(thin) else replace(region, elements=solid)
        if len(thin) and len(solid):
            card.refuse("a contact region of shells and solids; give each its own region")
        _add(regions, card, region)
    for name in ("BCPROP", "BCPROPS"):
        for card in bulk.cards.get(name, ()):
            listed = np.array(id_list(card, card.texts[1:], np.unique(properties)), dtype=np.int64)
            chosen = ids[np.isin(properties, listed)]
            _add(
                regions, card, Region(card=card, name=f"bcprop:{card.integer(0)}", elements=chosen)
            )
    for card in bulk.cards.get("BSURFS", ()):
        facets = _facets(card, bulk.grids, solids)
        _add(regions, card, Region(card=card, name=f"bsurfs:{card.integer(0)}", facets=facets))
    for card in bulk.cards.get("BCSURF", ()):
        facets = _sides(card, solids)
        regions[-card.integer(0)] = Region(
            card=card, name=f"bcsurf:{card.integer(0)}", facets=facets
        )
    return regions


def _sides(card: Card, solids: Sequence[CellBlock]) -> Indices:
    """Faces (n, 8) of rows with an element, the side of it, and ELEM."""
    rows = [[card.text(j + k) for k in range(8)] for j in range(8, len(card), 8)]
    named = [row for row in rows if any(row)]
    bricks = [block for block in solids if block.kind in ("hex8", "hex20")]
    element_ids = [numbers.integer(row[0]) for row in named]
    for row, element in zip(named, element_ids, strict=True):
        odd = element is None or row[1] not in _SIDES or row[2:] != ["ELEM", *[""] * 5]
        if odd or card.text(4) != "FACE":
            card.refuse(
                f"'{', '.join(filter(None, row))}'; supported are rows of a CHEXA, its side S1 to "
                "S6 and ELEM, behind FACE; name faces by BSURFS",
                8,
            )
    elements = np.array(element_ids, dtype=np.int64)
    numbers_of = np.array([_SIDES[row[1]] for row in named], dtype=np.int64)
    faces = numbered_faces(bricks, elements, numbers_of)
    missing = np.flatnonzero(faces[:, 0] < 0)
    if missing.size:
        card.refuse(
            f"element {elements[missing[0]]} is no CHEXA of the deck; name faces by BSURFS", 8
        )
    return np.unique(faces, axis=0)


def _add(regions: dict[int, Region], card: Card, region: Region) -> None:
    number = card.integer(0)
    if number in regions:
        card.refuse(
            f"contact region {number} is already defined at {regions[number].card.where()}; give "
            "each BSURF, BSURFS and BCPROP its own id"
        )
    regions[number] = region


def _facets(card: Card, grids: Grids, solids: Sequence[CellBlock]) -> Indices:
    # Behind three blanks, groups of an element and three grids of its face.
    texts = [card.text(j) for j in range(4, 4 + 4 * ((len(card) - 1) // 4))]
    groups = [texts[i : i + 4] for i in range(0, len(texts), 4) if any(texts[i : i + 4])]
    values = [[numbers.integer(text) for text in group] for group in groups]
    for i, group in enumerate(values):
        if None in group:
            shown = ", ".join(groups[i])
            card.refuse(f"'{shown}' is no element id with three grid ids of its face")
    if any(card.texts[1:4]):
        card.refuse("fields 3 to 5 must be blank; the first element id belongs in field 6", 1)
    table = np.array(values, dtype=np.int64).reshape(-1, 4)
    nodes = grids.several(card, table[:, 1:].ravel().tolist()).reshape(-1, 3)

    def fits(rows: Indices, _: str, kind: str, corners: Indices) -> Mask:
        del kind
        corners_of = nodes[rows]
        distinct = (corners_of != np.roll(corners_of, 1, axis=1)).all(axis=1)
        among = (corners_of[:, :, None] == corners[:, None, :]).any(axis=2).all(axis=1)
        chosen: Mask = distinct & among
        return chosen

    faces, fitting = find_faces(solids, table[:, 0], fits)
    if not fitting.all():
        solids_are = ", ".join(SOLID_CARDS)
        card.refuse(f"element {table[~fitting, 0][0]} is no solid of the deck; name {solids_are}")
    wrong = np.flatnonzero(faces[:, 0] < 0)
    if wrong.size:
        element, *corners = table[wrong[0]].tolist()
        card.refuse(
            f"grids {', '.join(map(str, corners))} are no three corners of one face of element "
            f"{element}; correct them"
        )
    return np.unique(faces, axis=0)
