"""SET1, BSURF, BSURFS, BCPROP: named sets of nodes and elements."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.couplings import id_list
from faying.io.nastran.grids import Grids


def read_sets(
    cards: Mapping[str, Cards], grids: Grids, elements: Mapping[str, Indices], ignored: list[str]
) -> tuple[dict[str, Indices], dict[str, Indices]]:
    """Return node sets (indices) and element sets (ids).

    ``set:<n>`` of a SET1 is a node set if all its ids are grids, an element set if all are solid
    elements, and both if both hold. ``bsurf:<n>``, ``bsurfs:<n>`` and ``bcprop:<n>`` are element
    sets.
    """
    node_sets: dict[str, Indices] = {}
    element_sets: dict[str, Indices] = {}
    known = np.concatenate(list(elements.values()) or [np.zeros(0, dtype=np.int64)])
    for card in cards.get("SET1", ()):
        _set1(card, grids, known, node_sets, element_sets, ignored)
    for card in cards.get("BSURF", ()):
        ids = np.array(id_list(card, [t for t in card.texts[1:] if t and t != "BY"]))
        _extend(element_sets, f"bsurf:{card.integer(0)}", ids[np.isin(ids, known)])
    for card in cards.get("BSURFS", ()):
        # Behind a row of blanks, groups of an element and three grids of its face.
        texts = [card.text(j) for j in range(4, len(card), 4)]
        ids = np.array([numbers.integer(t) or 0 for t in texts if t])
        _extend(element_sets, f"bsurfs:{card.integer(0)}", ids[np.isin(ids, known)])
    for card in cards.get("BCPROP", ()):
        for number in id_list(card, [t for t in card.texts[1:] if t]):
            _extend(
                element_sets, f"bcprop:{card.integer(0)}", elements.get(f"pid:{number}", known[:0])
            )
    return node_sets, element_sets


def _extend(sets: dict[str, Indices], name: str, ids: Indices) -> None:
    sets[name] = np.unique(np.concatenate([sets.get(name, ids[:0]), ids])).astype(np.int64)


def _set1(
    card: Card,
    grids: Grids,
    known: Indices,
    node_sets: dict[str, Indices],
    element_sets: dict[str, Indices],
    ignored: list[str],
) -> None:
    texts = [text for text in card.texts[1:] if text]
    name = f"set:{card.integer(0)}"
    if "SKIN" in texts:
        ignored.append(f"SET1 {card.integer(0)} (SKIN is not supported)")
        return
    excluded = texts.index("EXCEPT") if "EXCEPT" in texts else len(texts)
    ids = np.setdiff1d(
        np.array(id_list(card, texts[:excluded]), dtype=np.int64),
        np.array(id_list(card, texts[excluded + 1 :]), dtype=np.int64),
    )
    index = grids.index(ids)
    if len(ids) and (index >= 0).all():
        _extend(node_sets, name, index)
    if len(ids) and np.isin(ids, known).all():
        _extend(element_sets, name, ids)
