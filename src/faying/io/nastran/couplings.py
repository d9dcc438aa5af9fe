"""RBE2, RBE3: rigid and averaging couplings."""

from collections.abc import Mapping
from itertools import zip_longest

import numpy as np

from faying._typing import Indices
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.components import components, frame_independent
from faying.io.nastran.grids import Grids
from faying.model.assembly import AverageCoupling, RigidCoupling

# A range of ids that must all exist is spelled out; a longer one is a slip of the pen.
_LONGEST = 10_000_000


def read_rigid_couplings(cards: Mapping[str, Cards], grids: Grids) -> list[RigidCoupling]:
    """Read RBE2; the thermal coefficient at its end is left out.

    Raises
    ------
    FormatError
        If a node is missing or tied to itself, or single components are tied in a displacement
        coordinate system that is not the basic one.
    """
    return [_rigid(card, grids) for card in cards.get("RBE2", ())]


def _rigid(card: Card, grids: Grids) -> RigidCoupling:
    reference = grids.one(card, 1)
    tied = components(card.text(2), card.error)
    texts = [text for text in card.texts[3:] if text]
    if texts and "." in texts[-1]:
        texts.pop()  # ALPHA: thermal expansion, no load for it is read
    nodes = np.unique(grids.several(card, id_list(card, texts)))
    if not len(nodes) or reference in nodes:
        text = "it needs dependent nodes other than its independent one"
        raise card.error(text)
    _check_frames(card, grids, nodes, tied)
    return RigidCoupling(id=card.integer(0), reference=reference, nodes=nodes, components=tied)


def id_list(card: Card, texts: list[str], known: Indices | None = None) -> list[int]:
    """Return ids from fields with single numbers and ranges ``a THRU b``, with BY and EXCEPT.

    ``a THRU b BY n`` takes every n-th id; EXCEPT takes those behind it out of the range before it,
    up to the first one that lies outside. Ranges keep their known ids only, if those are given.
    """
    ids: list[int] = []
    i = 0
    while i < len(texts):
        value = numbers.integer(texts[i])
        if texts[i] == "THRU" and ids and i + 1 < len(texts):
            first, last = ids.pop(), numbers.integer(texts[i + 1]) or 0
            inside = [first, *_range(card, first, texts[i:], known)]
            i += 4 if texts[i + 2 : i + 3] == ["BY"] else 2
            if texts[i : i + 1] == ["EXCEPT"]:
                out = _exceptions(card, texts[i + 1 :], first, last)
                inside = [number for number in inside if number not in set(out)]
                i += 1 + len(out)
            ids += inside
            continue
        if value is None:
            text = f"'{texts[i]}' stands where an id is expected"
            raise card.error(text)
        ids.append(value)
        i += 1
    return ids


def _exceptions(card: Card, texts: list[str], low: int, high: int) -> list[int]:
    """Ids behind EXCEPT that lie in the range before it."""
    out: list[int] = []
    for text, following in zip_longest(texts, texts[1:]):
        value = numbers.integer(text)
        if value is None or not low <= value <= high:
            break
        if following == "THRU":
            message = f"EXCEPT {value} THRU is not supported; list the ids"
            raise card.error(message)
        out.append(value)
    if not out:
        message = f"EXCEPT names no id of the range {low} THRU {high} before it"
        raise card.error(message)
    return out


def _range(card: Card, first: int, texts: list[str], known: Indices | None) -> list[int]:
    """Ids behind ``first`` of a range; ``texts`` begin with THRU."""
    last, step = numbers.integer(texts[1]), 1
    if texts[2:3] == ["BY"]:
        step = numbers.integer(texts[3]) or 0 if len(texts) > 3 else 0
        if step < 1:
            text = f"'BY {' '.join(texts[3:4])}' is no positive step between ids"
            raise card.error(text)
    longest = _LONGEST if known is None else 10**18
    if last is None or not first <= last <= first + longest:
        text = f"'{first} THRU {texts[1]}' is not an ascending range of ids"
        raise card.error(text)
    if known is None:
        return list(range(first + step, last + 1, step))
    inside = (known > first) & (known <= last) & ((known - first) % step == 0)
    return [int(number) for number in known[inside]]


def _check_frames(card: Card, grids: Grids, nodes: Indices, tied: tuple[int, ...]) -> None:
    if frame_independent(tied):
        return
    for node in np.asarray(nodes)[grids.systems.displacement[nodes] != 0].tolist():
        if grids.systems.axes(node) is not None:
            text = (
                f"single components of GRID {grids.ids[node]} are coupled in its displacement "
                "coordinate system; couple 123, 456 or 123456, or use MPCs"
            )
            raise card.error(text)


def read_average_couplings(cards: Mapping[str, Cards], grids: Grids) -> list[AverageCoupling]:
    """Read RBE3 with one set of components for all averaged nodes.

    Raises
    ------
    FormatError
        If a UM set is given, nodes of different groups have different components, or single
        components are averaged in a displacement coordinate system that is not the basic one.
    """
    return [_average(card, grids) for card in cards.get("RBE3", ())]


def _average(card: Card, grids: Grids) -> AverageCoupling:
    card.refuse_given([1])
    reference = grids.one(card, 2)
    tied = components(card.text(3), card.error)
    texts = [text for text in card.texts[4:] if text]
    if "UM" in texts:
        text = (
            "a UM set (other dependent components than those of the reference node) is not "
            "supported; remove it and make the reference node the dependent one"
        )
        raise card.error(text)
    if "ALPHA" in texts:
        texts = texts[: texts.index("ALPHA")]
    averaged, ids, weights = _groups(card, texts)
    nodes = grids.several(card, ids)
    if reference in nodes or len(np.unique(nodes)) < len(nodes):
        text = "a node is averaged twice or is the reference node itself; remove it"
        raise card.error(text)
    _check_frames(card, grids, nodes, averaged)
    _check_frames(card, grids, np.array([reference]), tied)
    return AverageCoupling(
        id=card.integer(0),
        reference=reference,
        nodes=nodes,
        weights=np.array(weights),
        components=averaged,
        reference_components=tied,
    )


def _groups(card: Card, texts: list[str]) -> tuple[tuple[int, ...], list[int], list[float]]:
    """Components, node ids and weights from WT, C, G, G, ..., WT, C, G, ...; weights are reals."""
    averaged: set[tuple[int, ...]] = set()
    ids: list[int] = []
    weights: list[float] = []
    i = 0
    while i < len(texts):
        weight = numbers.real(texts[i])
        if weight is None or numbers.integer(texts[i]) is not None or not weight > 0:
            text = f"'{texts[i]}' stands where a positive real weight is expected"
            raise card.error(text)
        averaged.add(components(texts[i + 1] if i + 1 < len(texts) else "", card.error))
        last = i + 2
        while last < len(texts) and (
            texts[last] == "THRU" or numbers.integer(texts[last]) is not None
        ):
            last += 1
        group = id_list(card, texts[i + 2 : last])
        ids += group
        weights += [weight] * len(group)
        i = last
    if not ids or len(averaged) > 1:
        text = (
            "groups of nodes with different components are not supported; give one set of "
            "components for all averaged nodes"
            if ids
            else "it averages no nodes"
        )
        raise card.error(text)
    return averaged.pop(), ids, weights
