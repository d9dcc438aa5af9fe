"""SET1: named sets of nodes and elements."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.id_lists import id_list


def read_sets(
    bulk: BulkData, elements: Mapping[str, Indices]
) -> tuple[dict[str, Indices], dict[str, Indices]]:
    """Return node sets (indices) and element sets (ids).

    ``set:<n>`` of a SET1 is a node set if all its ids are grids, an element set if all are solid
    elements, and both if both hold.
    """
    node_sets: dict[str, Indices] = {}
    element_sets: dict[str, Indices] = {}
    element_ids = np.concatenate(list(elements.values()) or [np.zeros(0, dtype=np.int64)])
    for card in bulk.cards.get("SET1", ()):
        _set1(bulk, card, element_ids, node_sets, element_sets)
    return node_sets, element_sets


def _extend(sets: dict[str, Indices], name: str, ids: Indices) -> None:
    sets[name] = np.unique(np.concatenate([sets.get(name, ids[:0]), ids])).astype(np.int64)


def _set1(
    bulk: BulkData,
    card: Card,
    element_ids: Indices,
    node_sets: dict[str, Indices],
    element_sets: dict[str, Indices],
) -> None:
    texts = card.texts[1:]
    name = f"set:{card.integer(0)}"
    if "SKIN" in texts:
        bulk.ignored.append(f"SET1 {card.integer(0)} (SKIN is not supported)")
        return
    ids = np.unique(np.array(id_list(card, texts), dtype=np.int64))
    index = bulk.grids.index(ids)
    if len(ids) and (index >= 0).all():
        _extend(node_sets, name, index)
    if len(ids) and np.isin(ids, element_ids).all():
        _extend(element_sets, name, ids)
