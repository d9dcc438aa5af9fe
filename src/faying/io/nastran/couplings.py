"""RBE3: averaging couplings."""

import numpy as np

from faying._typing import Indices
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card
from faying.io.nastran.components import components, frame_independent
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import AverageCoupling


def _check_frames(card: Card, grids: Grids, nodes: Indices, tied: tuple[int, ...]) -> None:
    if frame_independent(tied):
        return
    for node in np.asarray(nodes)[grids.systems.displacement[nodes] != 0].tolist():
        if grids.systems.axes(node) is not None:
            card.refuse(
                f"single components of GRID {grids.ids[node]} are coupled in its displacement "
                "coordinate system; couple 123, 456 or 123456, or use MPCs"
            )


def read_average_coupling(card: Card, grids: Grids) -> AverageCoupling:
    """Read an RBE3."""
    card.refuse_given([1])
    reference = grids.one(card, 2)
    tied = components(card.text(3), card.error)
    texts = [text for text in card.texts[4:] if text]
    if "UM" in texts:
        card.refuse(
            "a UM set (other dependent components than those of the reference node) is not "
            "supported; remove it and make the reference node the dependent one"
        )
    if "ALPHA" in texts:
        texts = texts[: texts.index("ALPHA")]
    chosen, ids, weights = _groups(card, texts)
    nodes = grids.several(card, ids)
    if reference in nodes or len(np.unique(nodes)) < len(nodes):
        card.refuse("a node is averaged twice or is the reference node itself; remove it")
    union = tuple(sorted({c for tied_here in chosen for c in tied_here}))
    apart = len(set(chosen)) > 1
    for tied_here in set(chosen):
        _check_frames(
            card, grids, nodes[[tied_here == components_of for components_of in chosen]], tied_here
        )
    _check_frames(card, grids, np.array([reference]), tied)
    return AverageCoupling(
        id=card.integer(0),
        reference=reference,
        nodes=nodes,
        weights=np.array(weights),
        components=union if apart else chosen[0],
        reference_components=tied,
        entering=np.array([[c in tied_here for c in range(6)] for tied_here in chosen])
        if apart
        else None,
    )


def _groups(card: Card, texts: list[str]) -> tuple[list[tuple[int, ...]], list[int], list[float]]:
    """Components, ids and weights of nodes from WT, C, G, G, ..., WT, C, G, ..."""
    averaged: list[tuple[int, ...]] = []
    ids: list[int] = []
    weights: list[float] = []
    i = 0
    while i < len(texts):
        weight = numbers.real(texts[i])
        if weight is None or numbers.integer(texts[i]) is not None or not weight > 0:
            card.refuse(f"'{texts[i]}' stands where a positive real weight is expected")
        tied = components(texts[i + 1] if i + 1 < len(texts) else "", card.error)
        last = i + 2
        while last < len(texts) and (
            texts[last] == "THRU" or numbers.integer(texts[last]) is not None
        ):
            last += 1
        group = id_list(card, texts[i + 2 : last])
        ids += group
        averaged += [tied] * len(group)
        weights += [weight] * len(group)
        i = last
    if not ids:
        card.refuse("it averages no nodes")
    return averaged, ids, weights
