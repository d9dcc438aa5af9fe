"""BSURF, BSURFS, BCPROP, BCPROPS: contact regions on solids.

Simcenter Nastran Quick Reference Guide, BSURFS: an element and three corner grids of its face;
BSURF and BCPROP(S) list elements and properties, whose exterior faces are the region.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Mask
from faying.io.element_faces import find_faces, numbered_faces
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, by_id
from faying.io.nastran.fields import ROW
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.solids import SOLID_CARDS
from faying.io.solid_cuts import Cut, on_their_sides
from faying.model.cells import CellBlock
from faying.model.mesh import Mesh


@dataclass(frozen=True, eq=False, kw_only=True)
class Region:
    """A contact region: its card and the selected faces or elements.

    Attributes
    ----------
    name
        Name of the face set or element set of the assembly.
    facets : (n_facet, 8)
        Node indices of the faces of BSURFS, padded with -1; several kinds may be mixed.
    elements : (n,)
        Element ids of the other cards.
    shells : (n,)
        Element ids of BSURF of shells; ``facets`` are then the touching side.
    """

    card: Card
    name: str
    facets: Indices | None = None
    elements: Indices | None = None
    shells: Indices | None = None

    def on_sides_of(self, mesh: Mesh, cuts: Sequence[Cut]) -> "Region":
        """Return the region on a mesh with cuts."""
        if self.facets is None or not cuts:
            return self
        return replace(self, facets=on_their_sides(mesh, cuts, self.facets))


_SIDES = {f"S{number}": number for number in range(1, 7)}
"""Sides of CHEXA on BCSURF."""


def read_regions(bulk: BulkData, solids: Sequence[CellBlock], shells: Indices) -> dict[int, Region]:
    """Read contact regions by id; BCSURF, which are contact bodies, by negative id."""
    ids = np.concatenate([np.zeros(0, dtype=np.int64), *(block.ids for block in solids)])
    properties = np.concatenate([ids[:0], *(block.properties for block in solids)])
    regions = {
        number: _region(card, bulk.grids, solids, ids, properties, shells)
        for number, card in by_id(bulk.cards, *_REGIONS, what="contact region").items()
    }
    for number, card in by_id(bulk.cards, "BCSURF").items():
        facets = _sides(card, solids)
        regions[-number] = Region(card=card, name=f"bcsurf:{number}", facets=facets)
    return regions


_REGIONS = ("BSURF", "BCPROP", "BCPROPS", "BSURFS")


def _region(
    card: Card,
    grids: Grids,
    solids: Sequence[CellBlock],
    ids: Indices,
    properties: Indices,
    shells: Indices,
) -> Region:
    """Return the region of a card, given ids and properties (n,) of all solids."""
    kind = card.cards.name
    region = Region(card=card, name=f"{kind.lower().replace('props', 'prop')}:{card.integer(0)}")
    if kind == "BSURFS":
        return replace(region, facets=_facets(card, grids, solids))
    if kind != "BSURF":
        chosen = id_list(card, card.texts[1:], np.unique(properties))
        return replace(region, elements=ids[np.isin(properties, chosen)])
    listed = np.array(
        id_list(card, card.texts[1:], np.sort(np.append(ids, shells))), dtype=np.int64
    )
    solid, thin = (listed[np.isin(listed, of_kind)] for of_kind in (ids, shells))
    if len(thin) and len(solid):
        card.refuse("a contact region of shells and solids; give each its own region")
    return replace(region, shells=thin) if len(thin) else replace(region, elements=solid)


def _sides(card: Card, solids: Sequence[CellBlock]) -> Indices:
    """Return the faces (n, 8) of rows with an element, its side, and ELEM."""
    rows = card.groups(ROW, ROW)
    for row in rows:
        odd = numbers.integer(row.text(0)) is None or row.text(1) not in _SIDES
        if odd or [text for text in row.texts[2:] if text] != ["ELEM"] or card.text(4) != "FACE":
            row.refuse(
                f"'{', '.join(filter(None, row.texts))}'; supported are rows of a CHEXA, its side "
                "S1 to S6 and ELEM, after FACE; name faces by BSURFS"
            )
    elements = np.array([row.integer(0) for row in rows], dtype=np.int64)
    numbers_of = np.array([_SIDES[row.text(1)] for row in rows], dtype=np.int64)
    bricks = [block for block in solids if block.kind in ("hex8", "hex20")]
    faces = numbered_faces(bricks, elements, numbers_of)
    missing = np.flatnonzero(faces[:, 0] < 0)
    if missing.size:
        row = rows[missing[0]]
        row.refuse(f"element {row.text(0)} is not a CHEXA of the deck; name faces by BSURFS")
    return np.unique(faces, axis=0)


def _facets(card: Card, grids: Grids, solids: Sequence[CellBlock]) -> Indices:
    if any(card.texts[1:4]):
        card.refuse("fields 3 to 5 must be blank; the first element id belongs in field 6", 1)
    # After three blanks, groups of an element and three grids of its face.
    groups = card.groups(4, 4)
    for group in groups:
        if None in [numbers.integer(text) for text in group.texts]:
            shown = ", ".join(group.texts)
            group.refuse(f"'{shown}' is not an element id with three grid ids of its face")
    values = [[group.integer(j) for j in range(4)] for group in groups]
    table = np.array(values, dtype=np.int64).reshape(-1, 4)
    nodes = grids.several(card, table[:, 1:].ravel().tolist()).reshape(-1, 3)

    def fits(rows: Indices, _: str, kind: str, corners: Indices) -> Mask:
        del kind
        corners_of = nodes[rows]
        distinct = (corners_of != np.roll(corners_of, 1, axis=1)).all(axis=1)
        among = (corners_of[:, :, None] == corners[:, None, :]).any(axis=2).all(axis=1)
        return np.asarray(distinct & among)

    faces, fitting = find_faces(solids, table[:, 0], fits)
    if not fitting.all():
        solids_are = ", ".join(SOLID_CARDS)
        card.refuse(f"element {table[~fitting, 0][0]} is not a solid here; name {solids_are}")
    wrong = np.flatnonzero(faces[:, 0] < 0)
    if wrong.size:
        element, *corners = table[wrong[0]].tolist()
        card.refuse(
            f"grids {', '.join(map(str, corners))} are not three corners of one face of element "
            f"{element}; correct them"
        )
    return np.unique(faces, axis=0)
