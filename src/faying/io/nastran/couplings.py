"""RBE3, MPC and MPCADD: averages, and linear equations between components."""

import numpy as np

from faying._typing import Indices
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card
from faying.io.nastran.fields import ROW, components, frame_independent
from faying.io.nastran.grids import BulkData, Grids, selected_sets
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import AverageCoupling, Equation


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
            "a UM set (dependent components of other nodes than the reference node) is not "
            "supported; remove it and make the reference node the dependent one"
        )
    if "ALPHA" in texts:
        texts = texts[: texts.index("ALPHA")]
    chosen, ids, weights = _groups(card, texts)
    nodes = grids.several(card, ids)
    if reference in nodes or len(np.unique(nodes)) < len(nodes):
        card.refuse("a node occurs twice in the average or is the reference node; remove it")
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
    """Return components, ids and weights of nodes from WT, C, G, G, ..., WT, C, G, ..."""
    averaged: list[tuple[int, ...]] = []
    ids: list[int] = []
    weights: list[float] = []
    i = 0
    while i < len(texts):
        weight = numbers.real(texts[i])
        if weight is None or numbers.integer(texts[i]) is not None or not weight > 0:
            card.refuse(f"'{texts[i]}' occurs where a positive real weight is expected")
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
        card.refuse("it has no nodes to average")
    return averaged, ids, weights


def read_equations(bulk: BulkData) -> list[Equation]:
    """Read the selected MPC sets.

    A component in a displacement coordinate system becomes up to three basic components. The
    dependent term is the largest of these that is not dependent in an earlier equation.
    """
    mpc = [*bulk.cards.get("MPC", ())]
    sets = selected_sets(bulk, "MPC", {card.integer(0) for card in mpc})
    dependent: set[tuple[int, int]] = set()
    return [_equation(card, bulk.grids, dependent) for card in mpc if card.integer(0) in sets]


def _equation(card: Card, grids: Grids, dependent: set[tuple[int, int]]) -> Equation:
    # Each row has two terms G, C, A after its first field.
    rows = card.groups(0, ROW)
    for row in rows:
        row.refuse_given([0, 7] if row.first else [7])
    groups = [_term(term, grids) for row in rows for term in row.groups(1, 3)]
    if not groups:
        card.refuse("it has no terms")
    total: dict[tuple[int, int], float] = {}
    for group in groups:
        for dof, coefficient in group.items():
            total[dof] = total.get(dof, 0.0) + coefficient
    candidates = sorted(groups[0], key=lambda dof: -abs(groups[0][dof]))
    first = next((p for p in candidates if p not in dependent and total[p] != 0.0), None)
    if first is None:
        card.refuse(
            "its first (dependent) component has coefficient zero or is already dependent in "
            "another MPC; put another component first"
        )
    dependent.add(first)
    order = [first, *(dof for dof in total if dof != first)]
    return Equation(
        id=card.integer(0),
        terms=tuple((node, component, total[node, component]) for node, component in order),
    )


def _term(fields: Card, grids: Grids) -> dict[tuple[int, int], float]:
    node = grids.one(fields, 0)
    chosen = grids.components(np.array([node]), fields.text(1), fields.error)
    if len(chosen) != 1:
        fields.refuse(f"expected one component in a term; found '{fields.text(1)}'", 1)
    coefficient = fields.real(2, 0.0)
    parts = grids.systems.basic_parts(node, chosen[0])
    return {(node, c): coefficient * factor for c, factor in parts}
