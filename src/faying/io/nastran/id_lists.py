"""Lists of ids on cards: single ids, and ranges with THRU, BY and EXCEPT."""

from itertools import zip_longest

from faying._typing import Indices
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card


def id_list(card: Card, fields: list[str], known_ids: Indices | None = None) -> list[int]:
    """Return ids from fields with single numbers and ranges ``a THRU b``, with BY and EXCEPT.

    ``a THRU b BY n`` takes every n-th id. EXCEPT removes the ids after it from the range before it,
    up to the first id outside. If known ids are given, ranges keep only these.
    """
    texts = [text for text in fields if text]
    ids: list[int] = []
    i = 0
    while i < len(texts):
        first, behind = numbers.integer(texts[i]), texts[i + 1 : i + 5]
        if first is None:
            card.refuse(f"'{texts[i]}' occurs where an id is expected")
        if behind[:1] != ["THRU"] or len(behind) == 1:
            ids.append(first)
            i += 1
            continue
        inside, last = _range(card, first, behind, known_ids), numbers.integer(behind[1]) or 0
        i += 5 if behind[2:3] == ["BY"] else 3
        if texts[i : i + 1] == ["EXCEPT"]:
            out = _exceptions(card, texts[i + 1 :], first, last)
            inside = [number for number in inside if number not in out]
            i += 1 + len(out)
        ids += inside
    return ids


def element_list(card: Card, field: int, known_ids: Indices, kind: str, remedy: str) -> list[int]:
    """Return unique ids of elements of a kind from a field on; ``known_ids`` are sorted."""
    ids = id_list(card, card.texts[field:], known_ids)
    unknown = sorted(set(ids) - set(known_ids.tolist()))
    if unknown or not ids:
        what = f"element {unknown[0]} is not a {kind} of the deck" if unknown else "no elements"
        card.refuse(f"{what}; {remedy}", field)
    return list(dict.fromkeys(ids))


def _exceptions(card: Card, texts: list[str], low: int, high: int) -> list[int]:
    """Return the ids after EXCEPT that lie in the range before it."""
    out: list[int] = []
    for text, following in zip_longest(texts, texts[1:]):
        value = numbers.integer(text)
        if value is None or not low <= value <= high:
            break
        if following == "THRU":
            card.refuse(f"EXCEPT {value} THRU is not supported; list the ids")
        out.append(value)
    if not out:
        card.refuse(f"EXCEPT names no id of the range {low} THRU {high} before it")
    return out


def _range(card: Card, first: int, texts: list[str], known_ids: Indices | None) -> list[int]:
    """Return the ids of a range from ``first`` on; ``texts`` begin with THRU."""
    last, step = numbers.integer(texts[1]), 1
    if texts[2:3] == ["BY"]:
        step = numbers.integer("".join(texts[3:])) or 0
        if step < 1:
            card.refuse(f"'BY {' '.join(texts[3:])}' is not a positive step between ids")
    longest = numbers.LONGEST_RANGE if known_ids is None else 10**18
    if last is None or not first <= last <= first + longest:
        card.refuse(f"'{first} THRU {texts[1]}' is not an ascending range of ids")
    if known_ids is None:
        return list(range(first, last + 1, step))
    inside = (known_ids > first) & (known_ids <= last) & ((known_ids - first) % step == 0)
    return [first, *known_ids[inside].tolist()]
