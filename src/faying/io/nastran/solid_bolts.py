"""BOLT with ETYPE = 2 and 3: shanks of solids, as sections to cut.

Simcenter Nastran Quick Reference Guide, BOLT: ETYPE = 2 lists the grid points of a cross-section of
the shank, ETYPE = 3 its elements and a grid point at the height of the section. CSID and IDIR are
the axis. A section between elements below and above that height need not be flat.
"""

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.io.nastran.cards import Card, by_id
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.id_lists import element_list, id_list
from faying.io.solid_cuts import Section, faces_of
from faying.model.mesh import Mesh
from faying.model.surface import corner_keys, corner_nodes, unique_rows

OF_GRIDS, OF_ELEMENTS = 2, 3


def read_solid_bolts(bulk: BulkData, mesh: Mesh) -> dict[int, Section]:
    """Return the sections of all bolts of solids by id."""
    sections = {}
    for number, card in by_id(bulk.cards, "BOLT").items():
        if is_split(card) or card.integer(1) not in (OF_GRIDS, OF_ELEMENTS):
            continue
        sections[number] = (
            _of_grids(number, card, bulk.grids, mesh)
            if card.integer(1) == OF_GRIDS
            else _of_elements(number, card, bulk.grids, mesh)
        )
    return sections


def is_split(card: Card) -> bool:
    """Return whether a bolt is MSC's, with a control grid and pairs of grids."""
    return "TOP" in card.texts or "BOTTOM" in card.texts


def control_grids(bulk: BulkData) -> Indices:
    """Return the nodes that tighten MSC's bolts."""
    controls = [bulk.grids.one(card, 1) for card in bulk.cards.get("BOLT", ()) if is_split(card)]
    return np.array(controls, dtype=np.int64)


def _of_grids(number: int, card: Card, grids: Grids, mesh: Mesh) -> Section:
    texts = [text for text in card.texts[4:] if text]
    nodes = grids.several(card, id_list(card, texts, np.sort(grids.ids)))
    inside = np.zeros(len(mesh.nodes) + 1, dtype=bool)
    inside[nodes] = True
    direction = _axis(card, grids, grids.nodes[nodes].mean(axis=0) if len(nodes) else np.zeros(3))
    axis = _normal(grids.nodes[nodes]) if direction is None else direction
    touching = [inside[block.nodes].sum(axis=1) > 2 for block in mesh.blocks]
    faces, ids, _ = _between(mesh, touching, axis)
    across: Mask = np.asarray(inside[corner_nodes(faces)].all(axis=1))
    return _section(number, card, faces[across], ids[across], direction)


def _of_elements(number: int, card: Card, grids: Grids, mesh: Mesh) -> Section:
    listed = element_list(
        card, 5, np.sort(mesh.element_ids), "solid", "list the solids of the shank"
    )
    ids = np.array(listed, dtype=np.int64)
    nodes = mesh.nodes[mesh.element_nodes(ids)]
    axis = _axis(card, grids, nodes.mean(axis=0))
    if axis is None:
        card.refuse("the axis is blank; give CSID and IDIR", 2)
    grid_text = card.text(4)
    heights = nodes @ axis
    level = float(heights.min() + heights.max()) / 2
    if grid_text and grid_text != "0":
        level = float(grids.nodes[grids.several(card, [card.integer(4)])[0]] @ axis)
    chosen = [np.isin(block.ids, ids) for block in mesh.blocks]
    faces, owners, (low, high) = _between(mesh, chosen, axis)
    across = (low < level) & (high >= level)
    return _section(number, card, faces[across], owners[across], axis)


def _axis(card: Card, grids: Grids, point: Vector) -> Vector | None:
    """Return the unit vector of CSID and IDIR at a point; None if they are blank."""
    if not card.text(3) or card.text(3) == "0":
        return None
    direction = card.integer(3)
    if direction not in (1, 2, 3):
        card.refuse(f"IDIR = {direction}; expected 1, 2 or 3", 3)
    axes: Matrix = grids.systems.frame_of(card, 2).directions(point[None])[0]
    return np.array(axes[direction - 1])


def _normal(points: Matrix) -> Vector:
    """Return the direction of the smallest spread of points."""
    _, _, directions = np.linalg.svd(points - points.mean(axis=0))
    return np.array(directions[-1])


def _between(
    mesh: Mesh, chosen: list[Mask], axis: Vector
) -> tuple[Indices, Indices, tuple[Vector, Vector]]:
    """Return the faces (n, 8) between chosen elements, seen from the lower one.

    Also returned are the ids of the lower elements, and the heights of lower and upper elements.
    """
    faces, ids, centres = faces_of(mesh, chosen)
    heights = centres @ axis
    _, group, size = unique_rows(corner_keys(faces))
    shared = np.flatnonzero(size[group] == 2)
    order = shared[np.lexsort((heights[shared], group[shared]))]
    low, high = order[::2], order[1::2]
    return faces[low], ids[low], (heights[low], heights[high])


def _section(number: int, card: Card, faces: Indices, ids: Indices, axis: Vector | None) -> Section:
    if not len(faces):
        card.refuse(
            "no faces between solids of the shank lie in this cross-section; give all grids of a "
            "layer of faces (ETYPE = 2), or elements on both sides of the grid (ETYPE = 3)"
        )
    return Section(
        name=f"bolt-{number}",
        shown="the cross-section of the bolt",
        facets=faces,
        elements=np.unique(ids),
        refuse=card.refuse,
        direction=None if axis is None else tuple(axis.tolist()),
    )
