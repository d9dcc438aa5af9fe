"""PLOAD4, PLOAD, PLOAD2 and FORCE, FORCE1, FORCE2, MOMENT, ...: pressures, directed forces.

MSC Nastran Quick Reference Guide, PLOAD4, remarks 2, 3 and 6: pressure is positive inward; P1 acts
at G1, the others follow counter-clockwise seen from outside; intensities are interpolated
(bi)linearly and integrated with the shape functions of the face; a vector N gives the direction of
a load per unit of (not projected) area. FORCE1 acts from G1 to G2, FORCE2 along the cross product
of G1-G2 and G3-G4; PLOAD acts along the normal of its grids, PLOAD2 along the normal of its shells,
both by the right-hand rule.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.interface.facets import gauss_rule, shape_functions
from faying.io.element_faces import face_areas, find_faces, nodal_forces, on_blocks
from faying.io.nastran.cards import Cards
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.id_lists import element_list
from faying.model.assembly import Assembly
from faying.model.cells import CellBlock
from faying.model.elements import FACES
from faying.model.surface import rows_by_kind

Part = tuple[Indices, Indices, Matrix]
"""Load sets (n,) or a common one (1,), nodes (n,), forces and moments (n, 6)."""


def part_of_faces(cards: Cards, rows: Indices, table: Indices, forces: Matrix) -> Part:
    """Return the forces on faces (n, n_node) of cards (n,) as nodal loads."""
    cards = cards.take(rows)
    cards.check_finite(forces)
    sets = np.repeat(cards.integers(0), table.shape[1])
    return sets, table.ravel(), np.hstack([forces.reshape(-1, 3), np.zeros((table.size, 3))])


def read_pressures(bulk: BulkData, structure: Assembly) -> Iterator[Part]:
    """Yield the forces of all PLOAD4.

    On shells pressure acts along the normal of the element, and THRU is a range of elements.
    """
    if "PLOAD4" not in bulk.cards:
        return
    loads, mesh = bulk.cards["PLOAD4"], structure.mesh
    shell_ids = np.sort(np.concatenate([loads.index[:0], *(b.ids for b in structure.shells)]))
    of_shells = np.isin(loads.integers(1), shell_ids)
    of_shells |= np.array([word == "THRU" for word in loads.words(6)])
    if of_shells.any():
        yield from _on_shells(loads.take(of_shells), bulk.grids, structure)
    solids = loads.take(~of_shells)
    if not len(solids):
        return
    faces, first_corner = _faces(solids, bulk.grids, mesh.blocks)
    pressures = _pressures(solids)
    for kind, rows in rows_by_kind(faces).items():
        table = faces[rows, : FACES[kind].n_nodes]
        values = _turned(kind, pressures[rows], first_corner[rows])
        forces = _forces(kind, mesh.nodes[table], values, -1.0, solids, rows, bulk.grids)
        yield part_of_faces(solids, rows, table, forces)


def _on_shells(cards: Cards, grids: Grids, structure: Assembly) -> Iterator[Part]:
    blocks = [block for block in structure.shells if block.kind in FACES]
    ids = np.sort(np.concatenate([cards.index[:0], *(block.ids for block in blocks)]))
    first, through = cards.integers(1), np.array([word == "THRU" for word in cards.words(6)])
    last = first.copy()
    last[through] = cards.take(through).integers(7)
    low = np.searchsorted(ids, first)
    count = np.maximum(np.searchsorted(ids, last, "right") - low, 0)
    cards.refuse_where(
        count == 0,
        lambda i: f"no shell that takes a pressure is among elements {first[i]} to {last[i]}",
        1,
    )
    card_of = np.repeat(np.arange(len(cards)), count)
    within = np.arange(len(card_of)) - np.repeat(np.cumsum(count) - count, count)
    pressures = _pressures(cards)
    for block, members, table in on_blocks(blocks, ids[np.repeat(low, count) + within]):
        rows, n_corners = card_of[members], FACES[block.kind].n_corners
        places, values = structure.mesh.nodes[table], pressures[rows, :n_corners]
        forces = _forces(block.kind, places, values, 1.0, cards, rows, grids)
        yield part_of_faces(cards, rows, table, forces)


def _faces(cards: Cards, grids: Grids, blocks: Sequence[CellBlock]) -> tuple[Indices, Indices]:
    """Return the loaded faces (n, 8) and the index of the corner G1 in each."""
    elements = cards.integers(1)
    first_grid, second_grid = grids.of_column(cards, 6), grids.of_column(cards, 7, blank=True)
    first_corner = np.zeros(len(cards), dtype=np.int64)

    def fits(rows: Indices, element: str, _: str, corners: Indices) -> Mask:
        is_first = corners == first_grid[rows, None]
        hit = is_first.any(axis=1)
        second = second_grid[rows]
        if element.startswith("tet"):
            chosen = hit & (second >= 0) & (corners != second[:, None]).all(axis=1)
        elif corners.shape[1] == 3:
            chosen = hit & (second < 0)
        else:
            opposite = np.take_along_axis(
                corners, (is_first.argmax(axis=1)[:, None] + 2) % 4, axis=1
            )
            chosen = hit & (opposite[:, 0] == second)
        first_corner[rows[chosen]] = is_first.argmax(axis=1)[chosen]
        return np.asarray(chosen)

    faces, fitting = find_faces(blocks, elements, fits)
    cards.refuse_where(
        ~fitting,
        lambda i: f"element {elements[i]} is not a solid or shell of the deck; correct the id",
        1,
    )
    cards.refuse_where(
        faces[:, 0] < 0,
        lambda i: (
            f"G1 and G3 (or G4) name no face of element {elements[i]}; give two opposite corners "
            "of a quadrilateral, one corner of a CPENTA's triangle, or a corner of the CTETRA's "
            "face and the grid off the face"
        ),
        6,
    )
    return faces, first_corner


def _pressures(cards: Cards) -> Matrix:
    """Return intensities (n, 4); blanks are P1."""
    first = cards.reals(2)
    columns = [np.where(cards.given(j), cards.reals(j, 0.0), first) for j in (3, 4, 5)]
    return np.stack([first, *columns], axis=1)


def _turned(kind: str, pressures: Matrix, first_corner: Indices) -> Matrix:
    """Return intensities, given from G1 on, in the order of the corners of the face."""
    n = FACES[kind].n_corners
    order = (np.arange(n) - first_corner[:, None]) % n
    return np.take_along_axis(pressures[:, :n], order, axis=1)


def _directions(cards: Cards) -> Matrix:
    """Return vectors (n, 3) in their coordinate systems; zero for normal pressures."""
    vectors = cards.vectors((9, 10, 11))
    directed = cards.given(8) | cards.given(9) | cards.given(10) | cards.given(11)
    length = np.linalg.norm(vectors, axis=1)
    cards.refuse_where(
        directed & ~((length > 0) & np.isfinite(length)),
        lambda _: "the direction N1, N2, N3 has no length; give a vector, or leave CID and N blank",
        9,
    )
    return vectors / np.where(length > 0, length, 1.0)[:, None]


def _forces(
    kind: str,
    places: Matrix,
    pressures: Matrix,
    sense: float,
    cards: Cards,
    rows: Indices,
    grids: Grids,
) -> Matrix:
    """Return consistent forces (n_face, n_node, 3) of pressures along normals or vectors.

    ``sense`` is 1 if pressure acts along the normal, -1 if against it.
    """
    rule = gauss_rule(kind, FACES[kind].pressure_order)
    intensity = pressures @ shape_functions(FACES[kind].linear, rule.points).T
    area = face_areas(kind, places)
    traction = sense * area * intensity[:, :, None]
    vector = _directions(cards)[rows]
    fixed = np.flatnonzero(vector.any(axis=1))
    if len(fixed):
        points = np.einsum("qa,fad->fqd", shape_functions(kind, rule.points), places[fixed])
        owners = np.repeat(rows[fixed], len(rule.points))
        axes = grids.systems.directions_at(cards, 8, owners, points.reshape(-1, 3))
        turned = np.einsum("fi,fqij->fqj", vector[fixed], axes.reshape(*points.shape, 3))
        size = intensity[fixed] * np.linalg.norm(area[fixed], axis=2)
        traction[fixed] = size[:, :, None] * turned
    return nodal_forces(kind, traction)


def read_directed_loads(bulk: BulkData, structure: Assembly) -> Iterator[Part]:
    """Yield load sets (n,), nodes (n,) and forces and moments (n, 6)."""
    for name, first in ((f"{kind}{n}", j) for n in ("", 1, 2) for j, kind in _VECTORS):
        if cards := bulk.cards.get(name):
            directed = _along_grids if name[-1].isdigit() else _along_system
            vectors = np.zeros((len(cards), 6))
            vectors[:, first : first + 3] = directed(cards, bulk.grids)
            cards.check_finite(vectors)
            yield cards.integers(0), bulk.grids.of_column(cards, 1), vectors
    if "PLOAD" in bulk.cards:
        yield from _on_grids(bulk.cards["PLOAD"], bulk.grids)
    if "PLOAD2" in bulk.cards:
        yield from _along_shells(bulk.cards["PLOAD2"], structure)


_VECTORS = ((0, "FORCE"), (3, "MOMENT"))
"""First component of forces (0) and of moments (3)."""


def _along_system(cards: Cards, grids: Grids) -> Matrix:
    """Return vectors (n, 3): magnitude times a vector in a coordinate system at the grid."""
    nodes, rows = grids.of_column(cards, 1), np.arange(len(cards))
    vectors = cards.vectors((4, 5, 6))
    axes = grids.systems.directions_at(cards, 2, rows, grids.nodes[nodes])
    return np.asarray(np.einsum("ni,nij->nj", vectors * cards.reals(3)[:, None], axes))


def _along_grids(cards: Cards, grids: Grids) -> Matrix:
    """Return vectors (n, 3) along a line between grids, or normal to two lines."""
    points = [grids.nodes[grids.of_column(cards, field)] for field in (3, 4)]
    vectors = points[1] - points[0]
    if cards.name.endswith("2"):
        points = [grids.nodes[grids.of_column(cards, field)] for field in (5, 6)]
        vectors = np.cross(vectors, points[1] - points[0])
    length = np.linalg.norm(vectors, axis=1)
    cards.refuse_where(
        ~(length > 0),
        lambda _: "its grids give no direction: they coincide, or their lines are parallel",
        3,
    )
    return np.asarray(cards.reals(2)[:, None] * vectors / length[:, None])


def _on_grids(cards: Cards, grids: Grids) -> Iterator[Part]:
    corners = np.stack([grids.of_column(cards, 2 + j, blank=j == 3) for j in range(4)], axis=1)
    square = corners[:, 3] >= 0
    for kind, rows in (("tri3", np.flatnonzero(~square)), ("quad4", np.flatnonzero(square))):
        if len(rows):
            table = corners[rows, : FACES[kind].n_nodes]
            yield _normal_to(kind, cards, rows, table, grids.nodes)


def _along_shells(cards: Cards, structure: Assembly) -> Iterator[Part]:
    shell_ids = np.sort(np.concatenate([cards.index[:0], *(b.ids for b in structure.shells)]))
    pairs = []
    for card in cards:
        listed = element_list(card, 2, shell_ids, "shell", "list shells, or correct the ids")
        pairs += [(card.number, number) for number in listed]
    which, ids = np.array(pairs, dtype=np.int64).T
    for block, members, table in on_blocks(structure.shells, ids):
        rows, first = which[members], ids[members[0]]
        if block.kind not in FACES:
            cards.refuse(int(rows[0]), f"element {first} takes no pressure; correct the id", 2)
        yield _normal_to(block.kind, cards, rows, table, structure.mesh.nodes)


def _normal_to(kind: str, cards: Cards, rows: Indices, table: Indices, nodes: Matrix) -> Part:
    """Return nodal loads of the pressures of cards (n,) along normals of faces (n, n_node)."""
    area = face_areas(kind, nodes[table])
    forces = nodal_forces(kind, area * cards.reals(1)[rows, None, None])
    return part_of_faces(cards, rows, table, forces)
