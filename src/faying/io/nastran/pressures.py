"""PLOAD4: pressure and traction on faces of solids as consistent nodal forces.

MSC Nastran Quick Reference Guide, PLOAD4, remarks 2, 3 and 6: pressure is positive inward; P1 acts
at G1, the others follow counter-clockwise seen from outside; intensities are interpolated
(bi)linearly and integrated with the shape functions of the face; a vector N gives the direction of
a load per unit of (not projected) area.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.interface.facets import area_vectors, gauss_rule, shape_functions
from faying.io.nastran.cards import Cards
from faying.io.nastran.faces import find_faces
from faying.io.nastran.grids import Grids
from faying.model.cells import CellBlock
from faying.model.elements import FACES
from faying.model.shells import ShellBlock
from faying.model.surface import rows_by_kind


def read_pressures(
    cards: Cards,
    grids: Grids,
    nodes: Matrix,
    blocks: Sequence[CellBlock],
    shells: Sequence[ShellBlock],
) -> tuple[Indices, Indices, Matrix]:
    """Return load set (m,), node index (m,) and force (m, 3) of all PLOAD4.

    On shells pressure acts along the normal of the element, and THRU names a range of them.

    Parameters
    ----------
    nodes : (n_node, 3) [length]
        Of the deck, and those of sides of shells without one.
    """
    of_shells = np.isin(cards.integers(1), [n for block in shells for n in block.ids.tolist()])
    of_shells |= np.array([word == "THRU" for word in cards.words(6)])
    solids = cards.take(~of_shells)
    parts = _on_shells(cards.take(of_shells), grids, nodes, shells) if of_shells.any() else []
    if len(solids):
        faces, first_corner = _faces(solids, grids, blocks)
        pressures, direction = _pressures(solids), _directions(solids)
        for kind, rows in rows_by_kind(faces).items():
            table = faces[rows, : FACES[kind].n_nodes]
            values = _turned(kind, pressures[rows], first_corner[rows])
            area = _Faces(kind, table, nodes[table], sense=-1.0)
            forces = _forces(area, grids, values, solids, rows, direction)
            parts.append((solids.integers(0)[rows], table, forces))
    return (
        np.concatenate([np.repeat(sets, nodes.shape[1]) for sets, nodes, _ in parts]),
        np.concatenate([nodes.ravel() for _, nodes, _ in parts]),
        np.concatenate([forces.reshape(-1, 3) for _, _, forces in parts]),
    )


def _on_shells(
    cards: Cards, grids: Grids, nodes: Matrix, shells: Sequence[ShellBlock]
) -> list[tuple[Indices, Indices, Matrix]]:
    """Load sets (n,), nodes (n, n_node) and forces (n, n_node, 3) on shells of each kind."""
    first = cards.integers(1)
    through = np.array([word == "THRU" for word in cards.words(6)])
    last = first.copy()
    last[through] = cards.take(through).integers(7)
    pressures, direction = _pressures(cards), _directions(cards)
    reached = np.zeros(len(cards), dtype=bool)
    parts = []
    for block in shells:
        if block.kind not in FACES:
            continue
        order = np.argsort(block.ids, kind="stable")
        low = np.searchsorted(block.ids, first, sorter=order)
        count = np.maximum(np.searchsorted(block.ids, last, "right", sorter=order) - low, 0)
        card_of = np.repeat(np.arange(len(cards)), count)
        within = np.arange(len(card_of)) - np.repeat(np.cumsum(count) - count, count)
        table = block.nodes[order[np.repeat(low, count) + within]]
        reached[card_of] = True
        if len(table):
            area = _Faces(block.kind, table, nodes[table], sense=1.0)
            values = pressures[card_of, : 3 if block.kind.startswith("tri") else 4]
            forces = _forces(area, grids, values, cards, card_of, direction)
            parts.append((cards.integers(0)[card_of], table, forces))
    if not reached.all():
        card = int(np.flatnonzero(~reached)[0])
        cards.refuse(
            card,
            f"no shell that takes a pressure is among elements {first[card]} to {last[card]}",
            1,
        )
    return parts


def _faces(cards: Cards, grids: Grids, blocks: Sequence[CellBlock]) -> tuple[Indices, Indices]:
    """Return the loaded faces (n, 8) and which of their corners is G1."""
    elements = cards.integers(1)
    first_grid = grids.of_column(cards, 6)
    second_grid = np.full(len(cards), -1, dtype=np.int64)
    with_second = np.flatnonzero(cards.given(7))
    second_grid[with_second] = grids.of_column(cards.take(with_second), 7)
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
    if not fitting.all():
        card = int(np.flatnonzero(~fitting)[0])
        cards.refuse(
            card, f"element {elements[card]} is no solid or shell of the deck; correct the id", 1
        )
    missing = np.flatnonzero(faces[:, 0] < 0)
    if missing.size:
        card = int(missing[0])
        cards.refuse(
            card,
            f"G1 and G3 (or G4) name no face of element {elements[card]}; give two opposite "
            "corners of a quadrilateral, one corner of a CPENTA's triangle, or a corner of the "
            "CTETRA's face and the grid off the face",
            6,
        )
    return faces, first_corner


def _pressures(cards: Cards) -> Matrix:
    """Intensities (n, 4), P1 where nothing else is given."""
    first = cards.reals(2)
    columns = [np.where(cards.given(j), cards.reals(j, 0.0), first) for j in (3, 4, 5)]
    return np.stack([first, *columns], axis=1)


def _turned(kind: str, pressures: Matrix, first_corner: Indices) -> Matrix:
    """Order intensities like the corners of the face, which begin elsewhere than at G1."""
    n = 3 if kind.startswith("tri") else 4
    order = (np.arange(n) - first_corner[:, None]) % n
    turned: Matrix = np.take_along_axis(pressures[:, :n], order, axis=1)
    return turned


def _directions(cards: Cards) -> Matrix:
    """Vectors (n, 3) in their coordinate systems; zero where the load is a normal pressure."""
    vectors = np.stack([cards.reals(j, 0.0) for j in (9, 10, 11)], axis=1)
    directed = cards.given(8) | cards.given(9) | cards.given(10) | cards.given(11)
    length = np.linalg.norm(vectors, axis=1)
    wrong = np.flatnonzero(directed & ~((length > 0) & np.isfinite(length)))
    if wrong.size:
        cards.refuse(
            int(wrong[0]),
            "the direction N1, N2, N3 has no length; give a vector, or leave CID and N blank",
            9,
        )
    unit: Matrix = vectors / np.where(length > 0, length, 1.0)[:, None]
    return unit


class _Faces(NamedTuple):
    """Faces of one kind: node indices and coordinates, and the sense of pressure: 1 outward."""

    kind: str
    nodes: Indices
    coordinates: Matrix
    sense: float


def _forces(
    faces: _Faces,
    grids: Grids,
    pressures: Matrix,
    cards: Cards,
    rows: Indices,
    direction: Matrix,
) -> Matrix:
    """Consistent forces (n_face, n_node, 3)."""
    kind, _, coordinates, sense = faces
    rule = gauss_rule(kind, FACES[kind].pressure_order)
    shape = shape_functions(kind, rule.points)
    intensity = pressures @ shape_functions(FACES[kind].linear, rule.points).T
    area = area_vectors(kind, coordinates, rule.points)
    traction = sense * area * intensity[:, :, None]
    vector = direction[rows]
    fixed = np.flatnonzero(vector.any(axis=1))
    if len(fixed):
        places = np.einsum("qa,fad->fqd", shape, coordinates[fixed])
        size = intensity[fixed] * np.linalg.norm(area[fixed], axis=2)
        turned = _basic(cards, grids, rows[fixed], vector[fixed], places)
        traction[fixed] = size[:, :, None] * turned
    forces: Matrix = np.einsum("qa,q,fqd->fad", shape, rule.weights, traction)
    return forces


def _basic(cards: Cards, grids: Grids, rows: Indices, vectors: Matrix, places: Matrix) -> Matrix:
    """Directions (n, n_q, 3) in the basic frame at places (n, n_q, 3)."""
    system = cards.integers(8, 0)[rows]
    result = np.repeat(vectors[:, None, :], places.shape[1], axis=1)
    for number in np.unique(system[system != 0]).tolist():
        these = np.flatnonzero(system == number)
        if number not in grids.systems.frames:
            cards.refuse(
                int(rows[these[0]]),
                f"coordinate system {number} is not in the deck; define it (CORD2R, ...)",
                8,
            )
        axes = grids.systems.frames[number].directions(places[these].reshape(-1, 3))
        axes = axes.reshape(len(these), -1, 3, 3)
        result[these] = np.einsum("fi,fqij->fqj", vectors[these], axes)
    return result
