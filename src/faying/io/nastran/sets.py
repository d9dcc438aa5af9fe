"""SET1, SPCADD, MPCADD: named sets, and sets of constraints that apply."""

from collections.abc import Collection, Mapping

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.nastran.cards import Card, id_list
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.grids import BulkData


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


def selected_sets(bulk: BulkData, kind: str, members: set[int]) -> set[int]:
    """Return the ids of the constraint sets that apply: in a deck without case control all.

    The kind is ``"SPC"`` or ``"MPC"``; members are ids of the sets that hold constraints.
    """
    combined: dict[int, list[int]] = {}
    for card in bulk.cards.get(f"{kind}ADD", ()):
        number = card.integer(0)
        parts = id_list(card, card.texts[1:])
        unknown = [str(part) for part in parts if part not in members]
        if unknown:
            # As in Nastran, whose own examples name such sets.
            bulk.ignored.append(
                f"{card.where()}: sets that are not in the deck: {', '.join(unknown)}"
            )
        combined.setdefault(number, []).extend(parts)
    chosen = bulk.control.spc if kind == "SPC" else bulk.control.mpc
    if chosen is None:
        if members:
            shown = ", ".join(map(str, sorted(members)))
            said = (
                f"case control selects none by {kind}, so that they constrain nothing"
                if bulk.control.present
                else "the deck has no case control that would select, so that all apply"
            )
            bulk.ignored.append(f"{kind} sets {shown}: {said}")
        return set() if bulk.control.present else set(members)
    if kind == "MPC" and not members and not combined:
        bulk.ignored.append(f"case control selects MPC = {chosen}, of which the deck has none")
        return set()
    if chosen not in members and chosen not in combined:
        refuse(
            f"case control selects {kind} = {chosen}, but the bulk data have no such set; "
            f"sets are {', '.join(map(str, sorted(members | set(combined)))) or 'none'}"
        )
    return ({chosen} | set(combined.get(chosen, []))) & members


def chosen_sets(
    control: CaseControl, chosen: int | None, sets: Collection[int], what: str, word: str
) -> tuple[list[int], str]:
    """Return the sets that case control selects by a word, without a section of it all.

    Also returned is what is said of sets that nothing selects.
    """
    shown = ", ".join(map(str, sets)) or "none"
    if chosen is not None and chosen not in sets:
        refuse(f"case control selects {word} = {chosen}, but the {what} are {shown}")
    if chosen is not None or not control.present:
        return [*sets] if chosen is None else [chosen], ""
    return [], f"{what} {shown} (case control selects none by {word})" if sets else ""
