"""BCTSET, BCTADD, BCTPARM, BCRPARA, BGSET, BGADD: contact and glue of Simcenter (NX) Nastran.

Fields as in the Simcenter Nastran Quick Reference Guide: BCTSET holds rows of source region, target
region, friction, and the least and largest search distance, BGSET of regions and search distance.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying.io.nastran.cards import Card, Cards, by_id, id_list
from faying.io.nastran.contact_pairs import Pair, region_of, rows
from faying.io.nastran.contact_parameters import (
    Parameters,
    friction_coefficient,
    read_parameters,
)
from faying.io.nastran.grids import BulkData, chosen_sets
from faying.io.nastran.regions import Region


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """Cards of contact or of glue: of a set, of a sum of sets, and what selects one."""

    what: str
    card: str
    sums: str
    word: str


_CONTACT = _Kind(what="contact", card="BCTSET", sums="BCTADD", word="BCSET")
_GLUE = _Kind(what="glue", card="BGSET", sums="BGADD", word="BGSET")
_GLUE_DISTANCE = 10.0
"""Search distance of BGSET where the deck gives none [length], in whatever unit."""


def read_simcenter_pairs(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> list[Pair]:
    """Read the pairs that BCSET and BGSET select; without a case control section, all of them."""
    chosen = _chosen(bulk, _CONTACT, ignored)
    parameters = {number: _parameters(bulk.cards, number, ignored) for number in chosen}
    pairs = [
        pair
        for number, cards_of_set in chosen.items()
        for card in cards_of_set
        for pair in _pairs(card, regions, parameters[number])
    ]
    glue = _chosen(bulk, _GLUE, ignored)
    pairs += [
        pair
        for cards_of_set in glue.values()
        for card in cards_of_set
        for pair in _glued(card, regions)
    ]
    for name in ("BGPARM", "BGPARA"):
        for card in bulk.cards.get(name, ()):
            card.integer(0)
            read_parameters(card, 1, ignored)
    _check_offsets(bulk.cards, pairs)
    return pairs


def _chosen(bulk: BulkData, kind: _Kind, ignored: dict[str, None]) -> dict[int, list[Card]]:
    """Cards of the sets that apply, by id: the selected one, or all without case control."""
    sets: dict[int, list[Card]] = {}
    for card in bulk.cards.get(kind.card, ()):
        sets.setdefault(card.integer(0), []).append(card)
    combined: dict[int, list[int]] = {}
    for number, card in by_id(bulk.cards, kind.sums).items():
        combined[number] = id_list(card, card.texts[1:])
        for part in combined[number]:
            card.find(sets, 0, f"{kind.what} set", kind.card, part)
    selected = bulk.control.contact if kind is _CONTACT else bulk.control.glue
    numbers, note = chosen_sets(
        bulk.control, selected, [*sets, *combined], f"{kind.what} sets", kind.word
    )
    if note:
        ignored[note] = None
    return {number: sets[number] for chosen in numbers for number in combined.get(chosen, [chosen])}


def _parameters(cards: Mapping[str, Cards], number: int, ignored: dict[str, None]) -> Parameters:
    """Read the parameters of a contact set."""
    parameters = Parameters()
    for name in ("BCTPARM", "BCTPARA"):
        for card in cards.get(name, ()):
            if card.integer(0) == number:
                parameters = read_parameters(card, 1, ignored)
    return parameters


def _source_rows(card: Card) -> Iterator[tuple[int, list[str]]]:
    """Yield the rows of a card that name a source region, with the number of their first field."""
    for first, texts in rows(card):
        if not any(texts[1:]):
            continue
        if first and texts[0]:
            card.refuse(
                f"'{texts[0]}' stands in front of a source region; leave that field blank", first
            )
        yield first, texts


def _pairs(card: Card, regions: dict[int, Region], parameters: Parameters) -> Iterator[Pair]:
    for first, texts in _source_rows(card):
        friction = friction_coefficient(card, first + 3)
        if card.real(first + 4, 0.0) > 0:
            card.refuse(
                f"MIND = {texts[4]}: contact that spares the closest faces is not supported; "
                "leave it blank",
                first + 4,
            )
        if any(texts[6:]):
            card.refuse(
                f"'{texts[6] or texts[7]}' stands behind MAXD, where nothing is expected", first + 6
            )
        distance = card.real(first + 5, 0.0) or np.inf
        pair = _pair(card, first, regions, distance, glued=parameters.glued)
        yield replace(pair, parameters=parameters, friction=friction)


def _glued(card: Card, regions: dict[int, Region]) -> Iterator[Pair]:
    for first, _ in _source_rows(card):
        distance = card.real(first + 3, 0.0) or _GLUE_DISTANCE
        yield _pair(card, first, regions, distance, glued=True)


def _pair(
    card: Card, first: int, regions: dict[int, Region], distance: float, *, glued: bool
) -> Pair:
    """Return the pair of two regions that a row of a card names."""
    kind = "glue" if glued else "contact"
    return Pair(
        name=f"{kind}-{card.text(first + 1)}-{card.text(first + 2)}",
        minus=region_of(regions, card, first + 1),
        plus=region_of(regions, card, first + 2),
        where=card.where(),
        search_distance=distance,
        glued=glued,
    )


def _check_offsets(cards: Mapping[str, Cards], pairs: list[Pair]) -> None:
    used = {region.card.integer(0) for pair in pairs for region in (pair.minus, pair.plus)}
    for card in cards.get("BCRPARA", ()):
        if card.integer(0) not in used:
            continue
        if card.real(2, 0.0):
            card.refuse(
                "OFFSET of a contact region is not supported; give 'initial_gap' in the study", 2
            )
        if card.text(3) not in ("", "FLEX"):
            card.refuse(f"TYPE = {card.text(3)} is not supported; contact regions must be FLEX", 3)
