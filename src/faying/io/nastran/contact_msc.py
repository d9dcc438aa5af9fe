"""BCTABLE, BCTABL1, BCONECT, BCBODY, BCBODY1, BCONPRG, BCONPRP, BCPARA: contact of MSC Nastran.

Fields as in the MSC Nastran 2022.4 Quick Reference Guide. SECNDRY and PRIMARY were called SLAVE and
MASTERS in earlier versions.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.nastran.cards import Card, Cards, by_id, id_list
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.contact_pairs import Pair, region_of, rows
from faying.io.nastran.contact_parameters import (
    ICOORD,
    Parameters,
    friction_coefficient,
    is_glued,
    note_friction,
    read_parameters,
    refuse_letting_go,
)
from faying.io.nastran.grids import BulkData, chosen_sets
from faying.io.nastran.regions import Region

_SECONDARY = frozenset(("SECNDRY", "SLAVE", "SLAVES"))
_PRIMARY = frozenset(("PRIMARY", "MASTERS", "MASTER"))
_SECTIONS = frozenset(("FBSH", "BKGL", "SEGS", "SEGTOSEG", "HHHB"))


@dataclass(kw_only=True)
class _Group:
    """Touching bodies, the bodies they touch, and their parameters."""

    card: Card
    secondary: list[int] = field(default_factory=list)
    primary: list[int] = field(default_factory=list)
    parameters: Parameters = field(default_factory=Parameters)


def read_msc_pairs(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> list[Pair]:
    """Read the pairs of the contact table that BCONTACT selects; without case control, of all.

    The same two bodies in opposite order are one contact.
    """
    groups = _selected_groups(bulk.cards, bulk.control, ignored)
    if not groups:
        return []
    error, slides = 0.0, False
    for card in bulk.cards.get("BCPARA", ()):
        card.integer(0, 0)
        common = read_parameters(card, 1, ignored)
        error, slides = common.error or error, slides or common.slides
    body = _body_reader(bulk, regions, ignored)
    pairs: dict[tuple[int, int], Pair] = {}
    for group in groups:
        for minus, plus in product(group.secondary, group.primary):
            if (plus, minus) in pairs and plus != minus:
                ignored[f"contact of bodies {minus} and {plus} listed in both orders"] = None
                continue
            if (minus, plus) in pairs:
                group.card.refuse(
                    f"contact of bodies {minus} and {plus} is already defined at "
                    f"{pairs[minus, plus].where} and would count twice; remove one"
                )
            (side, first), (opposite, second) = (body(group.card, n) for n in (minus, plus))
            friction = first if group.parameters.friction is None else group.parameters.friction
            if group.parameters.friction is None and first != second:
                group.card.refuse(
                    f"bodies {minus} and {plus} have coefficients of friction {first:g} and "
                    f"{second:g}; give the pair its own (FRIC of BCONPRP or BCTABLE)"
                )
            pairs[minus, plus] = Pair(
                name=f"{'glue' if group.parameters.glued else 'contact'}-{minus}-{plus}",
                minus=side,
                plus=opposite,
                where=group.card.where(),
                parameters=replace(group.parameters, error=group.parameters.error or error),
                friction=friction,
                glued=group.parameters.glued,
            )
    if slides and any(pair.friction > 0 for pair in pairs.values()):
        ignored["coefficients of friction (FTYPE = 0 on BCPARA switches friction off)"] = None
        return [replace(pair, friction=0.0) for pair in pairs.values()]
    return list(pairs.values())


def friction_of_all_bodies(
    bulk: BulkData, regions: dict[int, Region], elements: Indices, ignored: dict[str, None]
) -> float | None:
    """Return the friction where everything touches everything (BCONTACT = ALLBODY), else None.

    Elements (n,) are ids of all solids, which the contact bodies must comprise.
    """
    if bulk.control.bcontact != "ALLBODY":
        return None
    slides = False
    for card in bulk.cards.get("BCPARA", ()):
        card.integer(0, 0)
        slides = read_parameters(card, 1, ignored).slides or slides
    body = _body_reader(bulk, regions, ignored)
    bodies = [
        body(card, number) for number, card in by_id(bulk.cards, *_BODIES, what="body").items()
    ]
    named = [region.elements for region, _ in bodies if region.elements is not None]
    left = np.setdiff1d(elements, np.concatenate([elements[:0], *named]))
    if left.size:
        refuse(
            f"case control asks for BCONTACT = ALLBODY, but element {left[0]} belongs to no "
            "contact body; add it to a BCPROP or BSURF, or name the pairs by BCTABL1 and BCONECT"
        )
    friction = {coefficient for _, coefficient in bodies} or {0.0}
    if len(friction) > 1:
        refuse(
            "case control asks for BCONTACT = ALLBODY, but the bodies have different coefficients "
            "of friction; name the pairs by BCTABL1 and BCONECT with a BCONPRP of each"
        )
    coefficient = 0.0 if slides else friction.pop()
    if coefficient > 0:
        note_friction(ignored)
    return coefficient


def _selected_groups(
    cards: Mapping[str, Cards], control: CaseControl, ignored: dict[str, None]
) -> list[_Group]:
    tables, lists, pairs = (by_id(cards, name) for name in ("BCTABLE", "BCTABL1", "BCONECT"))
    for name, by_number in (("BCTABLE", tables), ("BCTABL1", lists)):
        if by_number.pop(0, None) is not None:
            ignored[f"{name} 0 (initial contact)"] = None
    chosen = control.bcontact
    numbers = [*tables, *(lists or pairs)]
    if chosen == "AUTO":
        refuse(
            "case control asks for BCONTACT = AUTO; name the pairs by BCTABL1 and BCONECT, or take "
            'it out and let the study find them (minus = plus = "auto")'
        )
    if chosen == "ALLBODY":
        return []
    if chosen in ("NONE", 0):
        control, chosen = replace(control, present=True), None
    number = chosen if isinstance(chosen, int) else None
    selected, note = chosen_sets(control, number, numbers, "contact tables", "BCONTACT")
    if note:
        ignored[note] = None
    groups: list[_Group] = []
    for number in selected:
        if number in tables:
            groups += _table_groups(tables[number], ignored)
        if number in lists:
            card = lists[number]
            for member in id_list(card, card.texts[1:]):
                connection = card.find(pairs, 0, "BCONECT", "contact pair", member)
                groups.append(_connection(cards, connection, ignored))
        elif not lists and number in pairs:
            groups.append(_connection(cards, pairs[number], ignored))
    return groups


def _table_groups(card: Card, ignored: dict[str, None]) -> list[_Group]:
    """Read the groups of a BCTABLE, or its short form with one pair."""
    if card.text(1):
        return [_Group(card=card, secondary=[card.integer(1)], primary=[card.integer(2)])]
    groups: list[_Group] = []
    section = ""
    for first, texts in list(rows(card))[1:]:
        word = texts[0]
        if word in _SECONDARY:
            section = "secondary"
            if card.real(first + 5, 0.0):
                card.refuse(
                    "CINTERF (interference) is not supported; give 'initial_gap' in the study",
                    first + 5,
                )
            has_friction = bool(card.text(first + 4))
            parameters = Parameters(
                error=card.real(first + 2, 0.0),
                friction=friction_coefficient(card, first + 4) if has_friction else None,
                glued=is_glued(card, first + 6),
            )
            secondary = [card.integer(first + 1)]
            groups.append(_Group(card=card, secondary=secondary, parameters=parameters))
        elif groups and (word in _PRIMARY or (not word and section == "primary")):
            section = "primary"
            groups[-1].primary += id_list(card, texts[1:])
        elif not word and section and texts[1] in _SECTIONS:
            section = "parameters"
            ignored[f"BCTABLE {texts[1]}"] = None
        elif not word and section == "secondary":
            card.integer(first + 1, 0)  # ISEARCH: which body is searched first
            refuse_letting_go(card, first + 3)
            chosen = card.integer(first + 2, 0)
            closes = ICOORD.get(str(chosen))
            if closes is None:
                card.refuse(f"ICOORD = {chosen} is not supported; give 0, 1, 2 or 3", first + 2)
            groups[-1].parameters = replace(groups[-1].parameters, within_error=closes)
        elif not word and section == "parameters" and not texts[1]:
            pass
        elif any(texts):
            card.refuse(f"'{word}' stands where SECNDRY or PRIMARY is expected", first)
    count = card.integer(3, 0)
    if (count and count != len(groups)) or any(not group.primary for group in groups):
        card.refuse(
            f"NGROUP = {count}, but it has {len(groups)} complete groups SECNDRY, PRIMARY", 3
        )
    return groups


def _connection(cards: Mapping[str, Cards], card: Card, ignored: dict[str, None]) -> _Group:
    """Bodies and parameters of a BCONECT."""
    group = _Group(card=card)
    for name, parameter_field in (("BCONPRG", 1), ("BCONPRP", 2)):
        number = card.integer(parameter_field, 0)
        if not number:
            continue
        parameters = card.find(by_id(cards, name), parameter_field, name, "parameters")
        read = read_parameters(parameters, 1, ignored)
        group.parameters = Parameters(
            within_error=read.within_error or group.parameters.within_error,
            error=read.error or group.parameters.error,
            friction=group.parameters.friction if read.friction is None else read.friction,
            glued=read.glued or group.parameters.glued,
        )
    members = {"secondary": group.secondary, "primary": group.primary}
    for name, parameter_field in (("secondary", 3), ("primary", 4)):
        if card.text(parameter_field):
            members[name].append(card.integer(parameter_field))
    listed = {name: bool(ids) for name, ids in members.items()}
    current = ""
    for first, texts in list(rows(card))[1:]:
        word = texts[0]
        if word and word not in _SECONDARY | _PRIMARY:
            card.refuse(f"'{word}' stands where SECNDRY or PRIMARY is expected", first)
        current = {True: "secondary", False: "primary"}[word in _SECONDARY] if word else current
        ids = texts[1:]
        if current and not listed[current]:
            members[current] += id_list(card, ids)
    if not group.secondary or not group.primary:
        card.refuse("it names no touching (SECNDRY) or no touched (PRIMARY) body")
    return group


_BODIES = ("BCBODY", "BCBODY1", "BCSURF")


def _body_reader(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> Callable[[Card, int], tuple[Region, float]]:
    """Return what reads region and friction of the body that a card names by its id."""
    bodies = by_id(bulk.cards, *_BODIES, what="body")
    properties = by_id(bulk.cards, "BCBDPRP")

    def body(user: Card, number: int) -> tuple[Region, float]:
        card = user.find(bodies, 0, "contact body", "BCBODY or BCBODY1", number)
        if card.cards.name == "BCSURF":
            return regions[-number], 0.0
        of_properties = card.cards.name == "BCBODY1"
        dimension, behaviour, region = (2, 3, 4) if of_properties else (1, 2, 3)
        if card.text(dimension) not in ("", "3D"):
            card.refuse(
                f"DIM = {card.text(dimension)} is not supported; contact bodies must be 3D",
                dimension,
            )
        if card.text(behaviour) not in ("", "DEFORM"):
            card.refuse(
                f"BEHAV = {card.text(behaviour)} is not supported; contact bodies must be "
                "deformable (DEFORM): mesh the rigid one with solids",
                behaviour,
            )
        if not of_properties:
            return region_of(regions, card, region), friction_coefficient(card, 5)
        friction = None
        if card.integer(1, 0):
            parameters = card.find(properties, 1, "BCBDPRP", "parameters")
            friction = read_parameters(parameters, 1, ignored).friction
        return region_of(regions, card, region), friction or 0.0

    return body
