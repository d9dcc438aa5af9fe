"""BCTABLE, BCTABL1, BCONECT, BCBODY, BCBODY1, BCONPRG, BCONPRP, BCPARA: contact of MSC Nastran.

Fields as in the MSC Nastran 2022.4 Quick Reference Guide. SECNDRY and PRIMARY are SLAVE and
MASTERS in earlier versions.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.nastran.cards import Card, Cards, by_id
from faying.io.nastran.contact_pairs import Pair, region_of
from faying.io.nastran.contact_parameters import (
    NO_PARAMETERS,
    Parameters,
    friction_coefficient,
    note_friction,
    read_parameters,
    with_parameter,
)
from faying.io.nastran.fields import ROW
from faying.io.nastran.grids import BulkData, chosen_sets
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.regions import Region

_SIDES = {
    **dict.fromkeys(("SECNDRY", "SLAVE", "SLAVES"), "secondary"),
    **dict.fromkeys(("PRIMARY", "MASTERS", "MASTER"), "primary"),
}
_HARMLESS_ROWS = frozenset(("FBSH", "BKGL", "SEGS", "SEGTOSEG", "HHHB"))


class _Group(NamedTuple):
    """Secondary bodies, the primary bodies they touch, and contact parameters."""

    card: Card
    secondary: list[int]
    primary: list[int]
    parameters: Parameters


def read_msc_pairs(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> list[Pair]:
    """Read the pairs of the contact table selected by BCONTACT; of all without case control.

    The same two bodies in opposite order are one contact.
    """
    groups = _selected_groups(bulk, ignored)
    if not groups:
        return []
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
            if group.parameters.slides and friction > 0:
                ignored[_SLIDING] = None
                friction = 0.0
            pairs[minus, plus] = Pair(
                name=f"{'glue' if group.parameters.glued else 'contact'}-{minus}-{plus}",
                minus=side,
                plus=opposite,
                where=group.card.where(),
                parameters=replace(group.parameters, friction=friction),
            )
    return list(pairs.values())


_SLIDING = "coefficients of friction (FTYPE = 0 on BCPARA switches friction off)"


def _common(bulk: BulkData, ignored: dict[str, None]) -> Parameters:
    """Return the parameters of all pairs."""
    parameters = NO_PARAMETERS
    for card in bulk.cards.get("BCPARA", ()):
        parameters = read_parameters(card, ignored, parameters)
    return parameters


def friction_of_all_bodies(
    bulk: BulkData, regions: dict[int, Region], elements: Indices, ignored: dict[str, None]
) -> float | None:
    """Return the friction coefficient of BCONTACT = ALLBODY; None without it.

    Elements (n,) are ids of all solids, which the contact bodies must comprise.
    """
    if bulk.control.chosen.get("BCONTACT") != "ALLBODY":
        return None
    slides = _common(bulk, ignored).slides
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


def _selected_groups(bulk: BulkData, ignored: dict[str, None]) -> list[_Group]:
    cards = bulk.cards
    tables, lists, pairs = (by_id(cards, name) for name in ("BCTABLE", "BCTABL1", "BCONECT"))
    for name, by_number in (("BCTABLE", tables), ("BCTABL1", lists)):
        if by_number.pop(0, None) is not None:
            ignored[f"{name} 0 (initial contact)"] = None
    chosen = bulk.control.chosen.get("BCONTACT")
    if chosen == "AUTO":
        refuse(
            "case control asks for BCONTACT = AUTO; name the pairs by BCTABL1 and BCONECT, or take "
            'it out and let the study find the pairs (minus = plus = "auto")'
        )
    if chosen == "ALLBODY":
        return []
    control = replace(bulk.control, chosen={}) if chosen == 0 else bulk.control
    numbers = [*tables, *(lists or pairs)]
    selected, note = chosen_sets(control, "BCONTACT", numbers, "contact tables")
    if note:
        ignored[note] = None
    groups: list[_Group] = []
    common = _common(bulk, ignored) if selected else NO_PARAMETERS
    for number in selected:
        if number in tables:
            groups += _table_groups(tables[number], common, ignored)
        if number in lists:
            card = lists[number]
            for member in id_list(card, card.texts[1:]):
                connection = card.find(pairs, 0, "BCONECT", "contact pair", member)
                groups.append(_connection(cards, connection, common, ignored))
        elif not lists and number in pairs:
            groups.append(_connection(cards, pairs[number], common, ignored))
    return groups


def _sections(card: Card) -> list[tuple[str, list[Card]]]:
    """Return the rows of each side after the first row of a card, in order."""
    sections: list[tuple[str, list[Card]]] = []
    for row in card.groups(ROW, ROW):
        word = row.text(0)
        if word not in _SIDES and (word or not sections):
            row.refuse(f"'{word}' occurs where SECNDRY or PRIMARY is expected")
        if word:
            sections.append((_SIDES[word], []))
        sections[-1][1].append(row)
    return sections


def _bodies(rows: list[Card]) -> list[int]:
    return [number for row in rows for number in id_list(row, row.texts[1:])]


def _table_groups(card: Card, common: Parameters, ignored: dict[str, None]) -> list[_Group]:
    """Read the groups of a BCTABLE, or its short form with one pair."""
    if card.text(1):
        return [_Group(card, [card.integer(1)], [card.integer(2)], common)]
    groups: list[_Group] = []
    for side, rows in _sections(card):
        if side == "secondary":
            parameters = _of_table(rows, common, ignored)
            groups.append(_Group(card, [rows[0].integer(1)], [], parameters))
        elif not groups:
            rows[0].refuse(f"'{rows[0].text(0)}' occurs where SECNDRY is expected")
        else:
            groups[-1].primary.extend(_bodies(rows))
    count = card.integer(3, 0)
    if (count and count != len(groups)) or any(not group.primary for group in groups):
        card.refuse(
            f"NGROUP = {count}, but it has {len(groups)} complete groups SECNDRY, PRIMARY", 3
        )
    return groups


def _of_table(rows: list[Card], parameters: Parameters, ignored: dict[str, None]) -> Parameters:
    """Return the parameters of a secondary body in a BCTABLE, from its row and the next ones."""
    for name, field in (("ERROR", 2), ("FRIC", 4), ("CINTERF", 5), ("IGLUE", 6)):
        parameters = with_parameter(parameters, name, rows[0], field)
    harmless = False
    for row in rows[1:]:
        if row.text(1) in _HARMLESS_ROWS:
            harmless, ignored[f"BCTABLE {row.text(1)}"] = True, None
        elif harmless and row.text(1):
            row.refuse("'' occurs where SECNDRY or PRIMARY is expected")
        elif not harmless:
            row.integer(1, 0)  # ISEARCH: the body searched first
            parameters = with_parameter(parameters, "ICOORD", row, 2)
            parameters = with_parameter(parameters, "JGLUE", row, 3)
    return parameters


def _connection(
    cards: Mapping[str, Cards], card: Card, parameters: Parameters, ignored: dict[str, None]
) -> _Group:
    """Return bodies and parameters of a BCONECT."""
    for name, field in (("BCONPRG", 1), ("BCONPRP", 2)):
        if card.integer(field, 0):
            named = card.find(by_id(cards, name), field, name, "parameters")
            parameters = read_parameters(named, ignored, parameters)
    sides = ("secondary", "primary")
    given = {
        side: [card.integer(field)] if card.text(field) else []
        for side, field in zip(sides, (3, 4), strict=True)
    }
    listed: dict[str, list[int]] = {side: [] for side in sides}
    for side, rows in _sections(card):
        listed[side] += [] if given[side] else _bodies(rows)
    secondary, primary = (given[side] or listed[side] for side in sides)
    if not secondary or not primary:
        card.refuse("it names no secondary (SECNDRY) or no primary (PRIMARY) body")
    return _Group(card, secondary, primary, parameters)


_BODIES = ("BCBODY", "BCBODY1", "BCSURF")


def _body_reader(
    bulk: BulkData, regions: dict[int, Region], ignored: dict[str, None]
) -> Callable[[Card, int], tuple[Region, float]]:
    """Return a function that reads region and friction of a body named on a card."""
    bodies = by_id(bulk.cards, *_BODIES, what="body")
    properties = by_id(bulk.cards, "BCBDPRP")

    def body(user: Card, number: int) -> tuple[Region, float]:
        card = user.find(bodies, 0, "contact body", "BCBODY or BCBODY1", number)
        if card.cards.name == "BCSURF":
            return regions[-number], 0.0
        of_properties = card.cards.name == "BCBODY1"
        dimension = 2 if of_properties else 1
        card.choice(dimension, ("", "3D"), "contact bodies must be 3D")
        card.choice(
            dimension + 1,
            ("", "DEFORM"),
            "contact bodies must be deformable (DEFORM): mesh the rigid one with solids",
        )
        region = region_of(regions, card, dimension + 2)
        if not of_properties:
            return region, friction_coefficient(card, 5)
        parameters = NO_PARAMETERS
        if card.integer(1, 0):
            named = card.find(properties, 1, "BCBDPRP", "parameters")
            parameters = read_parameters(named, ignored)
        return region, parameters.friction or 0.0

    return body
