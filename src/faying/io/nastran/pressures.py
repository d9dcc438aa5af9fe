"""PLOAD4: pressure and traction on faces of solids as consistent nodal forces.

MSC Nastran Quick Reference Guide, PLOAD4, remarks 2, 3 and 6: pressure is positive inward; P1 acts
at G1, the others follow counter-clockwise seen from outside; intensities are interpolated
(bi)linearly and integrated with the shape functions of the face; a vector N gives the direction of
a load per unit of (not projected) area.
"""

from collections.abc import Sequence

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.interface.facets import area_vectors, gauss_rule, shape_functions
from faying.io.nastran.cards import Cards
from faying.io.nastran.faces import find_faces
from faying.io.nastran.grids import Grids
from faying.model.mesh import CellBlock
from faying.model.surface import LINEAR, N_NODES

# N times p times the area vector: degree 3 per direction on quad4 (two points), 6 on quad8 (four);
# on triangles 2 and 5 in all.
_ORDERS = {"tri3": 2, "tri6": 6, "quad4": 2, "quad8": 4}


def read_pressures(
    cards: Cards, grids: Grids, blocks: Sequence[CellBlock]
) -> tuple[Indices, Indices, Matrix]:
    """Return load set (m,), node index (m,) and force (m, 3) of all PLOAD4.

    Raises
    ------
    FormatError
        If an element is no solid, the grids name no face of it, or a direction has no length.
    """
    for card in np.flatnonzero(np.array(cards.words(6)) == "THRU")[:1].tolist():
        text = "THRU is for shells, which are not supported; write one PLOAD4 per face"
        raise cards.error(card, text, 6)
    faces, first_corner = _faces(cards, grids, blocks)
    pressures = _pressures(cards)
    direction = _directions(cards)
    sets: list[Indices] = []
    nodes: list[Indices] = []
    forces: list[Matrix] = []
    counts = (faces >= 0).sum(axis=1)
    for kind, n in N_NODES.items():
        here = np.flatnonzero(counts == n)
        if not len(here):
            continue
        table = faces[here, :n]
        parts = _forces(
            kind, grids, table, _turned(kind, pressures[here], first_corner[here]), cards,
            here, direction,
        )  # fmt: skip
        sets.append(np.repeat(cards.integers(0)[here], n))
        nodes.append(table.ravel())
        forces.append(parts.reshape(-1, 3))
    return np.concatenate(sets), np.concatenate(nodes), np.concatenate(forces)


def _faces(cards: Cards, grids: Grids, blocks: Sequence[CellBlock]) -> tuple[Indices, Indices]:
    """Return the loaded faces (n, 8) and which of their corners is G1."""
    elements = cards.integers(1)
    one = grids.of_column(cards, 6)
    other = np.full(len(cards), -1, dtype=np.int64)
    given = np.flatnonzero(cards.given(7))
    other[given] = grids.of_column(cards.take(given), 7)
    first_corner = np.zeros(len(cards), dtype=np.int64)

    def fits(here: Indices, element: str, _: str, corners: Indices) -> Mask:
        at = corners == one[here, None]
        hit = at.any(axis=1)
        second = other[here]
        if element.startswith("tet"):
            chosen = hit & (second >= 0) & (corners != second[:, None]).all(axis=1)
        elif corners.shape[1] == 3:
            chosen = hit & (second < 0)
        else:
            opposite = np.take_along_axis(corners, (at.argmax(axis=1)[:, None] + 2) % 4, axis=1)
            chosen = hit & (opposite[:, 0] == second)
        first_corner[here[chosen]] = at.argmax(axis=1)[chosen]
        return np.asarray(chosen)

    faces, known = find_faces(blocks, elements, fits)
    if not known.all():
        card = int(np.flatnonzero(~known)[0])
        text = f"element {elements[card]} is no solid of the deck; correct the id"
        raise cards.error(card, text, 1)
    missing = np.flatnonzero(faces[:, 0] < 0)
    if missing.size:
        card = int(missing[0])
        text = (
            f"G1 and G3 (or G4) name no face of element {elements[card]}; give two opposite "
            "corners of a quadrilateral, one corner of a CPENTA's triangle, or a corner of the "
            "CTETRA's face and the grid off the face"
        )
        raise cards.error(card, text, 6)
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
    wanted = cards.given(8) | cards.given(9) | cards.given(10) | cards.given(11)
    length = np.linalg.norm(vectors, axis=1)
    wrong = np.flatnonzero(wanted & ~((length > 0) & np.isfinite(length)))
    if wrong.size:
        text = "the direction N1, N2, N3 has no length; give a vector, or leave CID and N blank"
        raise cards.error(int(wrong[0]), text, 9)
    unit: Matrix = vectors / np.where(length > 0, length, 1.0)[:, None]
    return unit


def _forces(
    kind: str,
    grids: Grids,
    table: Indices,
    pressures: Matrix,
    cards: Cards,
    here: Indices,
    direction: Matrix,
) -> Matrix:
    """Consistent forces (n_face, n_node, 3)."""
    rule = gauss_rule(kind, _ORDERS[kind])
    coordinates = grids.nodes[table]
    shape = shape_functions(kind, rule.points)
    intensity = pressures @ shape_functions(LINEAR[kind], rule.points).T
    area = area_vectors(kind, coordinates, rule.points)
    traction = -area * intensity[:, :, None]
    vector = direction[here]
    fixed = np.flatnonzero(vector.any(axis=1))
    if len(fixed):
        places = np.einsum("qa,fad->fqd", shape, coordinates[fixed])
        size = intensity[fixed] * np.linalg.norm(area[fixed], axis=2)
        turned = _basic(cards, grids, here[fixed], vector[fixed], places)
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
            text = f"coordinate system {number} is not in the deck; define it (CORD2R, ...)"
            raise cards.error(int(rows[these[0]]), text, 8)
        axes = grids.systems.frames[number].directions(places[these].reshape(-1, 3))
        axes = axes.reshape(len(these), -1, 3, 3)
        result[these] = np.einsum("fi,fqij->fqj", vectors[these], axes)
    return result
