"""FORCE1, MOMENT1, FORCE2, MOMENT2, PLOAD, PLOAD2: loads whose direction grids or shells give.

MSC Nastran Quick Reference Guide: FORCE1 acts from G1 to G2, FORCE2 along the product of G1 to G2
and G3 to G4; PLOAD acts along the normal of its grids, PLOAD2 along that of its shells, both by the
right-hand rule.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.interface.facets import area_vectors, gauss_rule, shape_functions
from faying.io.nastran.cards import Cards
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.model.elements import FACES
from faying.model.shells import ShellBlock

DIRECTED = ("FORCE1", "MOMENT1", "FORCE2", "MOMENT2", "PLOAD", "PLOAD2")

Part = tuple[Indices, Indices, Matrix]


def read_directed_loads(
    cards: Mapping[str, Cards], grids: Grids, nodes: Matrix, shells: Sequence[ShellBlock]
) -> list[Part]:
    """Return load sets (n,), nodes (n,) and forces and moments (n, 6).

    Parameters
    ----------
    nodes : (n_node, 3) [length]
        Of the deck, and those of sides of shells without one.
    """
    parts: list[Part] = []
    for name, first in (("FORCE1", 0), ("MOMENT1", 3), ("FORCE2", 0), ("MOMENT2", 3)):
        if name in cards:
            vectors = np.zeros((len(cards[name]), 6))
            vectors[:, first : first + 3] = _along_grids(cards[name], grids)
            parts.append(
                (
                    cards[name].integers(0),
                    grids.of_column(cards[name], 1),
                    _checked(cards[name], vectors),
                )
            )
    if "PLOAD" in cards:
        parts += _on_grids(cards["PLOAD"], grids)
    if "PLOAD2" in cards:
        parts += _on_shells(cards["PLOAD2"], nodes, shells)
    return parts


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


def _on_grids(cards: Cards, grids: Grids) -> list[Part]:
    parts = []
    square = cards.given(5)
    for kind, chosen in (("tri3", ~square), ("quad4", square)):
        these = cards.take(chosen)
        if len(these):
            count = FACES[kind].n_nodes
            table = np.stack([grids.of_column(these, 2 + j) for j in range(count)], axis=1)
            parts.append(
                _pressed(these, these.integers(0), kind, table, grids.nodes, these.reals(1))
            )
    return parts


def _on_shells(cards: Cards, nodes: Matrix, shells: Sequence[ShellBlock]) -> list[Part]:
    shell_ids = np.sort(np.concatenate([cards.index[:0], *(block.ids for block in shells)]))
    pairs = []
    for card in cards:
        texts = [text for text in card.texts[2:] if text]
        listed = id_list(card, texts, shell_ids if "THRU" in texts else None)
        missing = sorted(set(listed) - set(shell_ids.tolist()))
        if missing or not listed:
            card.refuse(f"element {missing[0] if missing else texts} is no shell of the deck", 2)
        pairs += [(card.number, number) for number in listed]
    which, ids = np.array(pairs, dtype=np.int64).T
    sets, pressures = cards.integers(0)[which], cards.reals(1)[which]
    parts = []
    for block in shells:
        order = np.argsort(block.ids, kind="stable")
        positions = np.minimum(np.searchsorted(block.ids, ids, sorter=order), len(order) - 1)
        members = np.flatnonzero(block.ids[order[positions]] == ids)
        if not len(members):
            continue
        if block.kind not in FACES:
            cards.refuse(
                int(which[members[0]]),
                f"element {ids[members[0]]} takes no pressure; correct the id",
                2,
            )
        table = block.nodes[order[positions[members]]]
        parts.append(_pressed(cards, sets[members], block.kind, table, nodes, pressures[members]))
    return parts


def _pressed(
    cards: Cards, sets: Indices, kind: str, table: Indices, nodes: Matrix, pressures: Vector
) -> Part:
    """Consistent forces of uniform pressures along the normals of facets (n, n_node)."""
    rule = gauss_rule(kind, FACES[kind].pressure_order)
    shape = shape_functions(kind, rule.points)
    area = area_vectors(kind, nodes[table], rule.points)
    forces = np.einsum("f,qa,q,fqd->fad", pressures, shape, rule.weights, area).reshape(-1, 3)
    vectors = _checked(cards, np.hstack([forces, np.zeros_like(forces)]))
    return np.repeat(sets, table.shape[1]), table.ravel(), vectors


def _checked(cards: Cards, vectors: Matrix) -> Matrix:
    if not np.isfinite(vectors).all():
        cards.refuse(0, "the load is too large for a number")
    return vectors
