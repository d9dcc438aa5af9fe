"""FORCE1, MOMENT1, FORCE2, MOMENT2, PLOAD, PLOAD2: loads whose direction grids or shells give.

MSC Nastran Quick Reference Guide: FORCE1 acts from G1 to G2, FORCE2 along the product of G1 to G2
and G3 to G4; PLOAD acts along the normal of its grids, PLOAD2 along that of its shells, both by the
right-hand rule.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from faying._typing import Matrix
from faying.io.element_faces import face_areas, nodal_forces, on_blocks
from faying.io.nastran.cards import Cards
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.pressures import Part, part_of_faces
from faying.model.assembly import Assembly
from faying.model.elements import FACES


def read_directed_loads(
    cards: Mapping[str, Cards], grids: Grids, structure: Assembly
) -> Iterator[Part]:
    """Yield load sets (n,), nodes (n,) and forces and moments (n, 6)."""
    for name, first in (("FORCE1", 0), ("MOMENT1", 3), ("FORCE2", 0), ("MOMENT2", 3)):
        if name in cards:
            vectors = np.zeros((len(cards[name]), 6))
            vectors[:, first : first + 3] = _along_grids(cards[name], grids)
            cards[name].check_finite(vectors)
            yield cards[name].integers(0), grids.of_column(cards[name], 1), vectors
    if "PLOAD" in cards:
        yield from _on_grids(cards["PLOAD"], grids)
    if "PLOAD2" in cards:
        yield from _on_shells(cards["PLOAD2"], structure)


def _along_grids(cards: Cards, grids: Grids) -> Matrix:
    """Vectors (n, 3) along one line between grids, or across two."""
    points = [grids.nodes[grids.of_column(cards, field)] for field in (3, 4)]
    vectors = points[1] - points[0]
    if cards.name.endswith("2"):
        points = [grids.nodes[grids.of_column(cards, field)] for field in (5, 6)]
        vectors = np.cross(vectors, points[1] - points[0])
    length = np.linalg.norm(vectors, axis=1)
    wrong = np.flatnonzero(~(length > 0))
    if wrong.size:
        cards.refuse(
            int(wrong[0]),
            "its grids give no direction: they coincide, or their lines are parallel",
            3,
        )
    directed: Matrix = cards.reals(2)[:, None] * vectors / length[:, None]
    return directed


def _on_grids(cards: Cards, grids: Grids) -> Iterator[Part]:
    square = cards.given(5)
    for kind, chosen in (("tri3", np.flatnonzero(~square)), ("quad4", np.flatnonzero(square))):
        these = cards.take(chosen)
        if len(these):
            count = FACES[kind].n_nodes
            table = np.stack([grids.of_column(these, 2 + j) for j in range(count)], axis=1)
            pressures = these.reals(1)[:, None]
            area = face_areas(kind, grids.nodes[table])
            forces = nodal_forces(kind, area * pressures[:, :, None])
            yield part_of_faces(these, np.arange(len(these)), table, forces)


def _on_shells(cards: Cards, structure: Assembly) -> Iterator[Part]:
    shell_ids = np.sort(np.concatenate([cards.index[:0], *(b.ids for b in structure.shells)]))
    pairs = []
    for card in cards:
        listed = id_list(card, card.texts[2:], shell_ids if "THRU" in card.texts[2:] else None)
        missing = sorted(set(listed) - set(shell_ids.tolist()))
        if missing or not listed:
            shown = missing[0] if missing else card.texts[2:]
            card.refuse(f"element {shown} is no shell of the deck", 2)
        pairs += [(card.number, number) for number in listed]
    which, ids = np.array(pairs, dtype=np.int64).T
    pressures = cards.reals(1)[which]
    for block, members, table in on_blocks(structure.shells, ids):
        if block.kind not in FACES:
            cards.refuse(
                int(which[members[0]]),
                f"element {ids[members[0]]} takes no pressure; correct the id",
                2,
            )
        area = face_areas(block.kind, structure.mesh.nodes[table])
        forces = nodal_forces(block.kind, area * pressures[members, None, None])
        yield part_of_faces(cards, which[members], table, forces)
