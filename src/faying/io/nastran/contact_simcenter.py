"""BCTSET, BCTADD, BCTPARM, BCRPARA, BGSET, BGADD: contact and glue of Simcenter (NX) Nastran.

Fields as in the Simcenter Nastran Quick Reference Guide: BCTSET holds rows of source region, target
region, friction, and the least and largest search distance, BGSET of regions and search distance.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying.io.nastran.cards import Card, Cards, by_id, each
from faying.io.nastran.contact_pairs import Pair, region_of
from faying.io.nastran.contact_parameters import (
    NO_PARAMETERS,
    Parameters,
    friction_coefficient,
    read_parameters,
)
from faying.io.nastran.fields import ROW
from faying.io.nastran.grids import BulkData, chosen_sets
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.regions import Region


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """Names of contact or glue cards: of a set, of a sum of sets, and the command that selects."""

    what: str
    card: str
    sums: str
    word: str


_CONTACT = _Kind(what="contact", card="BCTSET", sums="BCTADD", word="BCSET")
_GLUE = _Kind(what="glue", card="BGSET", sums="BGADD", word="BGSET")
_GLUE_DISTANCE = 10.0
"""Default search distance of BGSET [length], whatever the unit of the deck."""


def read_simcenter_pairs(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> list[Pair]:
    """Read the pairs selected by BCSET and BGSET; without case control, all pairs."""
    chosen = _chosen(bulk, _CONTACT, ignored)
    parameters = {number: _parameters(bulk.cards, number, ignored) for number in chosen}
    glue = {number: Parameters(glued=True) for number in _chosen(bulk, _GLUE, ignored)}
    for card in each(bulk.cards, "BGPARM", "BGPARA"):
        read_parameters(card, ignored)
    pairs = [
        pair
        for kind, of_sets in ((_CONTACT, parameters), (_GLUE, glue))
        for card in bulk.cards.get(kind.card, ())
        if card.integer(0) in of_sets
        for pair in _pairs(card, kind, regions, of_sets[card.integer(0)])
    ]
    _check_offsets(bulk.cards, pairs)
    return pairs


def _chosen(bulk: BulkData, kind: _Kind, ignored: dict[str, None]) -> list[int]:
    """Return the active sets: the selected one, or all without case control."""
    sets = dict.fromkeys(card.integer(0) for card in bulk.cards.get(kind.card, ()))
    combined: dict[int, list[int]] = {}
    for number, card in by_id(bulk.cards, kind.sums).items():
        combined[number] = id_list(card, card.texts[1:])
        for part in combined[number]:
            card.find(sets, 0, f"{kind.what} set", kind.card, part)
    available = [*sets, *combined]
    numbers, note = chosen_sets(bulk.control, kind.word, available, f"{kind.what} sets")
    if note:
        ignored[note] = None
    return [number for chosen in numbers for number in combined.get(chosen, [chosen])]


def _parameters(cards: Mapping[str, Cards], number: int, ignored: dict[str, None]) -> Parameters:
    """Read the parameters of a contact set."""
    parameters = NO_PARAMETERS
    for card in each(cards, "BCTPARM", "BCTPARA"):
        if card.integer(0) == number:
            parameters = read_parameters(card, ignored, parameters)
    return parameters


def _pairs(
    card: Card, kind: _Kind, regions: dict[int, Region], parameters: Parameters
) -> Iterator[Pair]:
    """Yield the pairs of a card, one per row: source, target, and friction or distance."""
    for row in card.groups(0, ROW):
        if not any(row.texts[1:]):
            continue
        if row.first and row.text(0):
            row.refuse(f"'{row.text(0)}' precedes a source region; leave that field blank")
        if kind is _GLUE:
            friction, distance = 0.0, row.real(3, 0.0) or _GLUE_DISTANCE
        else:
            friction, distance = friction_coefficient(row, 3), row.real(5, 0.0) or np.inf
            _check_nothing_else(row)
        yield Pair(
            name=f"{'glue' if parameters.glued else 'contact'}-{row.text(1)}-{row.text(2)}",
            minus=region_of(regions, row, 1),
            plus=region_of(regions, row, 2),
            where=card.where(),
            parameters=replace(parameters, friction=friction, search_distance=distance),
        )


def _check_nothing_else(row: Card) -> None:
    if row.real(4, 0.0) > 0:
        row.refuse(
            f"MIND = {row.text(4)}: contact that skips the closest faces is not supported; leave "
            "it blank",
            4,
        )
    if any(row.texts[6:]):
        row.refuse(f"'{row.text(6) or row.text(7)}' follows MAXD, where nothing is expected", 6)


def _check_offsets(cards: Mapping[str, Cards], pairs: list[Pair]) -> None:
    used = {region.card.integer(0) for pair in pairs for region in (pair.minus, pair.plus)}
    for card in cards.get("BCRPARA", ()):
        if card.integer(0) not in used:
            continue
        if card.real(2, 0.0):
            card.refuse(
                "OFFSET of a contact region is not supported; give 'initial_gap' in the study", 2
            )
        card.choice(3, ("", "FLEX"), "contact regions must be FLEX")
