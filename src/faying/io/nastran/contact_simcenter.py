"""BCTSET, BCTADD, BCTPARM, BCRPARA: surface contact of Simcenter (NX) Nastran, SOL 101.

Fields as in the Simcenter Nastran Quick Reference Guide: BCTSET holds rows of source region, target
region, friction, and the least and largest search distance.
"""

from collections.abc import Mapping

import numpy as np

from faying.exceptions import FormatError
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.contact_pairs import Pair, region_of, rows
from faying.io.nastran.contact_parameters import (
    GLUE_REMEDY,
    Parameters,
    by_id,
    friction_coefficient,
    read_parameters,
)
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.regions import Region

GLUE = ("BGSET", "BGADD", "BGPARM", "BGPARA")


def read_simcenter_pairs(
    cards: Mapping[str, Cards],
    control: CaseControl,
    regions: dict[int, Region],
    ignored: dict[str, None],
) -> list[Pair]:
    """Read the contact pairs that BCSET selects; without a case control section, all of them.

    Raises
    ------
    FormatError
        If a set or region is missing, or the contact has glue, offsets, friction that is not
        Coulomb's, or another feature that is not represented.
    """
    _refuse_glue(cards, control, ignored)
    sets: dict[int, list[Card]] = {}
    for card in cards.get("BCTSET", ()):
        sets.setdefault(card.integer(0), []).append(card)
    chosen = _selected(cards, control, sets, ignored)
    parameters = {number: _parameters(cards, number, ignored) for number in chosen}
    pairs = [
        pair
        for number in chosen
        for card in sets[number]
        for pair in _pairs(card, regions, parameters[number])
    ]
    _check_offsets(cards, pairs)
    return pairs


def _refuse_glue(
    cards: Mapping[str, Cards], control: CaseControl, ignored: dict[str, None]
) -> None:
    for name in GLUE:
        for card in cards.get(name, ()):
            if control.glue is not None or not control.present:
                text = f"glued surfaces are not supported; {GLUE_REMEDY}"
                raise card.error(text)
            ignored[f"{name} (not selected by case control)"] = None


def _selected(
    cards: Mapping[str, Cards],
    control: CaseControl,
    sets: dict[int, list[Card]],
    ignored: dict[str, None],
) -> list[int]:
    """Ids of the BCTSETs that apply."""
    combined: dict[int, list[int]] = {}
    for number, card in by_id(cards, "BCTADD").items():
        combined[number] = id_list(card, [text for text in card.texts[1:] if text])
        for part in combined[number]:
            if part not in sets:
                text = f"contact set {part} is not a BCTSET of the deck; define it"
                raise card.error(text)
    chosen = control.contact
    if chosen is None and not control.present:
        return list(sets)
    if chosen is None:
        if sets:
            shown = ", ".join(map(str, sets))
            ignored[f"contact sets {shown} (case control selects none by BCSET)"] = None
        return []
    if chosen not in sets and chosen not in combined:
        known = ", ".join(map(str, [*sets, *combined])) or "none"
        message = f"case control selects BCSET = {chosen}, but the contact sets are {known}"
        raise FormatError(message)
    return list(dict.fromkeys(combined.get(chosen, [chosen])))


def _parameters(cards: Mapping[str, Cards], number: int, ignored: dict[str, None]) -> Parameters:
    """Read the parameters of a contact set."""
    found = Parameters()
    for name in ("BCTPARM", "BCTPARA"):
        for card in cards.get(name, ()):
            if card.integer(0) == number:
                found = read_parameters(card, 1, ignored)
    return found


def _pairs(card: Card, regions: dict[int, Region], parameters: Parameters) -> list[Pair]:
    found = []
    for first, texts in rows(card):
        if not any(texts[1:]):
            continue
        if first and texts[0]:
            text = f"'{texts[0]}' stands in front of a source region; leave that field blank"
            raise card.error(text, first)
        friction = friction_coefficient(card, first + 3)
        if card.real(first + 4, 0.0) > 0:
            text = (
                f"MIND = {texts[4]}: contact that spares the closest faces is not supported; "
                "leave it blank"
            )
            raise card.error(text, first + 4)
        if any(texts[6:]):
            text = f"'{texts[6] or texts[7]}' stands behind MAXD, where nothing is expected"
            raise card.error(text, first + 6)
        sides = [region_of(regions, card, first + j) for j in (1, 2)]
        found.append(
            Pair(
                name=f"contact-{texts[1]}-{texts[2]}",
                minus=sides[0],
                plus=sides[1],
                where=card.where(),
                parameters=parameters,
                search_distance=card.real(first + 5, 0.0) or np.inf,
                friction=friction,
            )
        )
    return found


def _check_offsets(cards: Mapping[str, Cards], pairs: list[Pair]) -> None:
    used = {region.card.integer(0) for pair in pairs for region in (pair.minus, pair.plus)}
    for card in cards.get("BCRPARA", ()):
        if card.integer(0) not in used:
            continue
        if card.real(2, 0.0):
            text = "OFFSET of a contact region is not supported; give 'initial_gap' in the study"
            raise card.error(text, 2)
        if card.text(3) not in ("", "FLEX"):
            text = f"TYPE = {card.text(3)} is not supported; contact regions must be FLEX"
            raise card.error(text, 3)
