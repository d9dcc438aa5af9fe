"""MPC: linear equations between displacement components."""

from collections.abc import Mapping

import numpy as np

from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.grids import Grids
from faying.io.nastran.selection import selected_sets
from faying.model.assembly import Equation


def read_equations(
    cards: Mapping[str, Cards], grids: Grids, control: CaseControl, ignored: list[str]
) -> list[Equation]:
    """Read the selected MPC sets.

    A component in a displacement coordinate system becomes up to three basic ones. The dependent
    term is then the largest of these that no earlier equation depends on.
    """
    mpc = cards.get("MPC")
    if mpc is None:
        selected_sets(cards, "MPC", set(), control, ignored)
        return []
    sets = selected_sets(cards, "MPC", set(mpc.integers(0).tolist()), control, ignored)
    dependent: set[tuple[int, int]] = set()
    return [_equation(card, grids, dependent) for card in mpc if card.integer(0) in sets]


def _equation(card: Card, grids: Grids, dependent: set[tuple[int, int]]) -> Equation:
    # Each row of eight fields holds two terms G, C, A behind its first field.
    rows = range(0, len(card), 8)
    card.refuse_given([*(row for row in rows if row), *(row + 7 for row in rows)])
    places = [row + j for row in rows for j in (1, 4)]
    groups = [_term(card, grids, field) for field in places if any(card.texts[field : field + 3])]
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
            "its first (dependent) component has coefficient zero or is already the dependent "
            "one of another MPC; put another component first"
        )
    dependent.add(first)
    order = [first, *(dof for dof in total if dof != first)]
    return Equation(
        id=card.integer(0),
        terms=tuple((node, component, total[node, component]) for node, component in order),
    )


def _term(card: Card, grids: Grids, field: int) -> dict[tuple[int, int], float]:
    node = grids.one(card, field)
    chosen = grids.components(np.array([node]), card.text(field + 1), card.error)
    if len(chosen) != 1:
        card.refuse(f"a term has one component; found '{card.text(field + 1)}'", field + 1)
    coefficient = card.real(field + 2, 0.0)
    parts = grids.systems.basic_parts(node, chosen[0])
    return {(node, c): coefficient * factor for c, factor in parts}
