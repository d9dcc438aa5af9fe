"""``*MODEL CHANGE`` of the first step: elements and contact pairs that are removed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.contact import Pair
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import lines
from faying.io.abaqus.keyword import Keyword


def is_from_the_start(keyword: Keyword) -> bool:
    """Return whether a *MODEL CHANGE applies to all steps.

    Elements removed in the first step were never loaded, and contact it adds exists anyway.
    """
    if keyword.name != "MODEL CHANGE" or keyword.step != 1:
        return False
    kind = keyword.choice("TYPE")
    return (kind == "ELEMENT" and keyword.has("REMOVE")) or kind == "CONTACT PAIR"


def without_removed(data: DeckData) -> DeckData:
    """Return the data without elements that *MODEL CHANGE, TYPE=ELEMENT removes."""
    deck, elements, sets = data.deck, data.elements, data.element_sets
    parts: list[Indices] = []
    all_ids = np.concatenate([block.ids for block in elements.blocks])
    for keyword in (
        change for change in deck.of("MODEL CHANGE") if change.choice("TYPE") == "ELEMENT"
    ):
        for line in lines(keyword):
            for label in filter(None, line.texts):
                ids = sets.members(keyword, label, line.row)
                if not np.isin(ids, all_ids).all():
                    line.refuse(f"there is no element {label}; correct the id")
                parts.append(ids)
        if np.isin(all_ids, np.concatenate([np.empty(0, dtype=np.int64), *parts])).all():
            keyword.refuse("it removes all elements; nothing remains")
    if not parts:
        return data
    gone = np.unique(np.concatenate(parts))
    deck.ignored.append(f"*MODEL CHANGE in step 1: {len(gone)} elements are removed in all steps")
    left = {name: np.setdiff1d(ids, gone) for name, ids in sets.ids.items()}
    remaining = replace(sets, ids=left, absent=gone)
    return replace(data, elements=elements.without(gone), element_sets=remaining)


def without_removed_pairs(deck: Deck, pairs: Sequence[Pair]) -> tuple[Deck, list[Pair]]:
    """Return deck and contact pairs without those that *MODEL CHANGE removes."""
    remaining = list(pairs)
    for keyword in (
        change for change in deck.of("MODEL CHANGE") if change.choice("TYPE") != "ELEMENT"
    ):
        for line in lines(keyword):
            named = [pair for pair in pairs if pair.is_of(line.texts)]
            if not named:
                line.refuse("no *CONTACT PAIR has these surfaces as slave and master")
            if keyword.has("REMOVE"):
                remaining = [pair for pair in remaining if pair not in named]
                deck.ignored.append(
                    f"*MODEL CHANGE in step 1: the contact pair {', '.join(line.texts)} is removed "
                    "in all steps"
                )
    gone = [pair for pair in pairs if pair not in remaining]
    left = [
        change
        for change in deck.keywords
        if change.name != "CLEARANCE"
        or not any(pair.is_of([change.value("SLAVE"), change.value("MASTER")]) for pair in gone)
    ]
    return replace(deck, keywords=left), remaining
