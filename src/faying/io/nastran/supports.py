"""SPC, SPC1, SPCADD and permanent supports: components held at zero, or moved."""

import numpy as np

from faying._typing import Indices, Mask
from faying.exceptions import FormatError
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Cards
from faying.io.nastran.components import components
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.moved_supports import Moved, displacements, read_moved
from faying.io.nastran.selection import selected_sets
from faying.model.assembly import Support

_Held = dict[tuple[int, tuple[int, ...]], list[Indices]]
"""Set id and components to node indices."""


def read_supports(bulk: BulkData) -> tuple[list[Support], Moved]:
    """Read the SPC sets that case control selects; without case control all of them.

    Supports of one set with the same components are joined. Where a displacement coordinate system
    makes their directions differ from the basic ones, nodes with equal directions are joined.
    Permanent supports of GRID have the id 0. Returned is what stands still, and what SPC and SPCD
    displace.
    """
    constrained: _Held = {}
    members: set[int] = set()
    for name in ("SPC", "SPC1"):
        if name in bulk.cards:
            members |= set(bulk.cards[name].integers(0).tolist())
    sets = selected_sets(bulk, "SPC", members)
    for digits, nodes in bulk.grids.permanent.items():
        constrained.setdefault((0, components(digits, _permanent_error)), []).append(nodes)
    single = bulk.cards.get("SPC")
    if single is not None:
        single = single.take(np.isin(single.integers(0), list(sets)))
        for first in (1, 4):
            these = single.take(single.given(first))
            _collect(these, bulk.grids.of_column(these, first), first + 1, constrained, bulk.grids)
    if "SPC1" in bulk.cards:
        _lists(bulk.cards["SPC1"], bulk.grids, sets, constrained)
    joined = {key: np.unique(np.concatenate(parts)) for key, parts in constrained.items()}
    fixed = np.zeros((len(bulk.grids.ids), 6), dtype=bool)
    for (_, numbers), nodes in joined.items():
        fixed[nodes[:, None], list(numbers)] = True
    by_support = [] if single is None else displacements(bulk, single)
    moved = read_moved(bulk, by_support, fixed)
    moving = moved.mask(len(bulk.grids.ids))
    supports: list[Support] = []
    for (number, numbers), nodes in joined.items():
        for standing, remaining in _standing(nodes, numbers, moving):
            supports += _supports(number, remaining, standing, bulk.grids)
    return supports, moved


def _standing(
    nodes: Indices, numbers: tuple[int, ...], moving: Mask
) -> list[tuple[Indices, tuple[int, ...]]]:
    """Part nodes by which of the components do not move."""
    still = ~moving[nodes[:, None], list(numbers)]
    patterns, which = np.unique(still, axis=0, return_inverse=True)
    which = which.ravel()
    return [
        (nodes[which == i], tuple(np.array(numbers)[pattern].tolist()))
        for i, pattern in enumerate(patterns)
        if pattern.any()
    ]


def _permanent_error(text: str) -> FormatError:
    return FormatError(f"GRID or GRDSET: permanent support (PS): {text}")


def _collect(cards: Cards, nodes: Indices, field: int, fixed: _Held, grids: Grids) -> None:
    """Add one node per card, grouped by set and components."""
    if not len(cards):
        return
    keys = np.array(
        [
            f"{number} {digits}"
            for number, digits in zip(cards.integers(0).tolist(), cards.words(field), strict=True)
        ]
    )
    names, first, which = np.unique(keys, return_index=True, return_inverse=True)
    for i, name in enumerate(names.tolist()):
        card = int(first[i])
        number, _, digits = name.partition(" ")
        chosen = grids.components(
            nodes[which == i],
            digits,
            lambda text, card=card: cards.error(card, text, field),  # type: ignore[misc]
        )
        fixed.setdefault((int(number), chosen), []).append(nodes[which == i])


def _lists(cards: Cards, grids: Grids, sets: set[int], fixed: _Held) -> None:
    for card in cards.take(np.isin(cards.integers(0), list(sets))):
        texts = card.texts[2:]
        ids = id_list(card, texts, grids.ids)
        if "THRU" in texts:
            # The reference guide: points of a range need not exist.
            indices = grids.index(np.array(ids, dtype=np.int64))
            nodes = indices[indices >= 0]
        else:
            nodes = grids.several(card, ids)
        if not len(nodes):
            card.refuse("none of its GRIDs is in the deck; define them or remove the card")
        chosen = grids.components(nodes, card.text(1), card.error)
        fixed.setdefault((card.integer(0), chosen), []).append(nodes)


def _supports(number: int, numbers: tuple[int, ...], nodes: Indices, grids: Grids) -> list[Support]:
    axes = grids.systems.axes_of(nodes)
    basic = np.isclose(axes, np.eye(3), rtol=0, atol=1e-14).all(axis=(1, 2))
    result = []
    if basic.any():
        result.append(Support(id=number, nodes=nodes[basic], components=numbers))
    turned, axes = nodes[~basic], axes[~basic]
    # Rounding at 1e-12 joins nodes whose directions differ by arithmetic only.
    keys = np.round(axes.reshape(-1, 9), 12)
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    which = which.ravel()
    for i, row in enumerate(first.tolist()):
        result.append(
            Support(id=number, nodes=turned[which == i], components=numbers, axes=axes[row])
        )
    return result
