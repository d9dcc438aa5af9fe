"""SPC, SPC1, SPCD, SPCADD and permanent supports: components held at zero, or moved.

MSC Nastran Quick Reference Guide: SPC displaces in every subcase that selects it, SPCD as part of a
load set, in place of what SPC says and where a selected SPC or SPC1 holds the component.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import FormatError, refuse
from faying.io.moved_supports import Place, moved_note, with_moved_supports
from faying.io.nastran.cards import Cards, id_list
from faying.io.nastran.fields import components
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.sets import selected_sets
from faying.model.assembly import Assembly, Support

ALWAYS = "spc"
"""Load of what SPC moves where no load set is selected that would take it along."""


class Displacement(NamedTuple):
    """A component that moves, by which set and where that is said."""

    number: int
    dof: Place
    value: float
    where: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Moved:
    """What SPC and SPCD displace.

    Attributes
    ----------
    always
        Places to displacements by SPC.
    by_load
        Load sets to displacements by SPCD.
    unread
        Load sets to why they are left out.
    """

    always: Mapping[Place, float] = field(default_factory=dict)
    by_load: Mapping[int, Mapping[Place, float]] = field(default_factory=dict)
    unread: Mapping[int, str] = field(default_factory=dict)

    @property
    def places(self) -> list[Place]:
        """All that moves, each once."""
        every = [dof for displaced in self.by_load.values() for dof in displaced]
        return [*dict.fromkeys([*self.always, *every])]

    def mask(self, n_node: int) -> Mask:
        """Components (n_node, 6) that move."""
        result = np.zeros((n_node, 6), dtype=bool)
        places = self.places
        if places:
            result[tuple(np.array(places).T)] = True
        return result

    def of_node(self, node: int, axes: Matrix | None) -> dict[str, Vector]:
        """Return how far a node is moved (3,), by load set and :data:`ALWAYS`.

        Its components are along axes; the basic ones if None.
        """
        rows = np.eye(3) if axes is None else axes
        motions = {}
        for name, moved in ((ALWAYS, self.always), *self.by_load.items()):
            along = np.array([moved.get((node, c), 0.0) for c in range(3)])
            if along.any():
                motions[str(name)] = along @ rows
        return motions

    def without(self, nodes: Indices) -> "Moved":
        """Return what moves at other nodes."""
        gone = set(nodes.tolist())

        def others(moved: Mapping[Place, float]) -> dict[Place, float]:
            return {dof: value for dof, value in moved.items() if dof[0] not in gone}

        by_load = {number: others(moved) for number, moved in self.by_load.items()}
        return replace(self, always=others(self.always), by_load=by_load)


class Moving(NamedTuple):
    """Forces (n_node, 6) that move supports: of SPC, of each load set, and sets left out."""

    always: Matrix
    by_load: Mapping[int, Matrix]
    unread: Mapping[int, str]


def displacements(bulk: BulkData, cards: Cards) -> list[Displacement]:
    """Return the displacements other than zero of SPC, and all of SPCD."""
    moves = []
    for first in (1, 4):
        these = cards.take(cards.given(first))
        values = these.reals(first + 2, 0.0)
        if cards.name == "SPC":
            these, values = these.take(values != 0), values[values != 0]
        if len(these) and bulk.control.heat:
            these.refuse(
                0,
                "a temperature, for the analysis is one of heat transfer; no temperatures are "
                "computed here",
                first + 2,
            )
        nodes, sets, digits = (
            bulk.grids.of_column(these, first),
            these.integers(0),
            these.words(first + 1),
        )
        for i, node in enumerate(nodes.tolist()):
            chosen = bulk.grids.components(
                nodes[i : i + 1],
                digits[i],
                lambda text, i=i: these.error(i, text, first + 1),  # type: ignore[misc]  # noqa: B023
            )
            where = these.where(i)
            moves += [
                Displacement(int(sets[i]), (node, c), float(values[i]), where) for c in chosen
            ]
    return moves


def read_moved(bulk: BulkData, by_support: Sequence[Displacement], fixed: Mask) -> Moved:
    """Return what moves; load sets that move what nothing holds belong to other supports.

    The selected SPC displace ``by_support``, and hold with SPC1 what is fixed (n_node, 6).
    """
    always: dict[Place, float] = {}
    for move in by_support:
        if always.setdefault(move.dof, move.value) != move.value:
            refuse(
                f"{move.where}: GRID {bulk.grids.ids[move.dof[0]]} is moved along component "
                f"{move.dof[1] + 1} by another SPC too; remove one"
            )
    by_load: dict[int, dict[Place, float]] = {}
    unread: dict[int, str] = {}
    for move in displacements(bulk, bulk.cards["SPCD"]) if "SPCD" in bulk.cards else ():
        node, component = move.dof
        location = f"GRID {bulk.grids.ids[node]} along component {component + 1}"
        if not fixed[move.dof]:
            unread.setdefault(
                move.number, f"{move.where} moves {location}, where no selected SPC holds it; that"
            )
        elif move.dof in always:
            unread.setdefault(move.number, f"{move.where} moves {location}, as SPC does; that")
        by_load.setdefault(move.number, {})[move.dof] = move.value
    return Moved(
        always=always,
        by_load={number: move for number, move in by_load.items() if number not in unread},
        unread=unread,
    )


def with_moving(bulk: BulkData, assembly: Assembly, moved: Moved) -> tuple[Assembly, Moving]:
    """Return the assembly with springs where supports move, and what moves them.

    Raises
    ------
    FormatError
        If a displacement is too large.
    ModelError
        If something else holds what is to be moved.
    """
    numbers = [*moved.by_load]
    courses = {
        dof: (
            moved.always.get(dof, 0.0),
            *(moved.by_load[number].get(dof, 0.0) for number in numbers),
        )
        for dof in moved.places
    }
    nodes = sorted({node for node, _ in courses})
    axes = {
        node: axes_of_node
        for node in nodes
        if (axes_of_node := bulk.grids.systems.axes(node)) is not None
    }
    assembly, forces = with_moved_supports(assembly, courses, len(numbers) + 1, axes)
    if not np.isfinite(forces).all():
        refuse("SPC or SPCD: a displacement is too large for a number; check the units")
    every = [*moved.by_load.values()]
    always = f"the selected load set, or load '{ALWAYS}' without one that is read,"
    for moving, cause, loads in (([moved.always], "SPC", always), (every, "SPCD", "load sets")):
        if count := len({dof for displaced in moving for dof in displaced}):
            bulk.ignored.append(moved_note(count, cause, loads))
    by_load = dict(zip(numbers, forces[1:], strict=True))
    return assembly, Moving(always=forces[0], by_load=by_load, unread=moved.unread)


_Held = dict[tuple[int, tuple[int, ...]], list[Indices]]
"""Set id and components to node indices."""


def read_supports(bulk: BulkData) -> tuple[list[Support], Moved]:
    """Read the SPC sets that case control selects; without case control all of them.

    Supports of one set with the same components are joined. Where a displacement coordinate system
    makes their directions differ from the basic ones, nodes with equal directions are joined.
    Permanent supports of GRID have the id 0. Returned is what stands still, and what SPC and SPCD
    displace.
    """
    constrained: _Held = {}
    members: set[int] = set()
    for name in ("SPC", "SPC1"):
        if name in bulk.cards:
            members |= set(bulk.cards[name].integers(0).tolist())
    sets = selected_sets(bulk, "SPC", members)
    for digits, nodes in bulk.grids.permanent.items():
        constrained.setdefault((0, components(digits, _permanent_error)), []).append(nodes)
    single = bulk.cards.get("SPC")
    if single is not None:
        single = single.take(np.isin(single.integers(0), list(sets)))
        for first in (1, 4):
            these = single.take(single.given(first))
            _collect(these, bulk.grids.of_column(these, first), first + 1, constrained, bulk.grids)
    if "SPC1" in bulk.cards:
        _lists(bulk.cards["SPC1"], bulk.grids, sets, constrained)
    joined = {key: np.unique(np.concatenate(parts)) for key, parts in constrained.items()}
    fixed = np.zeros((len(bulk.grids.ids), 6), dtype=bool)
    for (_, numbers), nodes in joined.items():
        fixed[nodes[:, None], list(numbers)] = True
    by_support = [] if single is None else displacements(bulk, single)
    moved = read_moved(bulk, by_support, fixed)
    moving = moved.mask(len(bulk.grids.ids))
    supports: list[Support] = []
    for (number, numbers), nodes in joined.items():
        for standing, remaining in _standing(nodes, numbers, moving):
            supports += _supports(number, remaining, standing, bulk.grids)
    return supports, moved


def _standing(
    nodes: Indices, numbers: tuple[int, ...], moving: Mask
) -> list[tuple[Indices, tuple[int, ...]]]:
    """Part nodes by which of the components do not move."""
    still = ~moving[nodes[:, None], list(numbers)]
    patterns, which = np.unique(still, axis=0, return_inverse=True)
    which = which.ravel()
    return [
        (nodes[which == i], tuple(np.array(numbers)[pattern].tolist()))
        for i, pattern in enumerate(patterns)
        if pattern.any()
    ]


def _permanent_error(text: str) -> FormatError:
    return FormatError(f"GRID or GRDSET: permanent support (PS): {text}")


def _collect(cards: Cards, nodes: Indices, field: int, fixed: _Held, grids: Grids) -> None:
    """Add one node per card, grouped by set and components."""
    if not len(cards):
        return
    keys = np.array(
        [
            f"{number} {digits}"
            for number, digits in zip(cards.integers(0).tolist(), cards.words(field), strict=True)
        ]
    )
    names, first, which = np.unique(keys, return_index=True, return_inverse=True)
    for i, name in enumerate(names.tolist()):
        card = int(first[i])
        number, _, digits = name.partition(" ")
        chosen = grids.components(
            nodes[which == i],
            digits,
            lambda text, card=card: cards.error(card, text, field),  # type: ignore[misc]
        )
        fixed.setdefault((int(number), chosen), []).append(nodes[which == i])


def _lists(cards: Cards, grids: Grids, sets: set[int], fixed: _Held) -> None:
    for card in cards.take(np.isin(cards.integers(0), list(sets))):
        texts = card.texts[2:]
        ids = id_list(card, texts, grids.ids)
        if "THRU" in texts:
            # The reference guide: points of a range need not exist.
            indices = grids.index(np.array(ids, dtype=np.int64))
            nodes = indices[indices >= 0]
        else:
            nodes = grids.several(card, ids)
        if not len(nodes):
            card.refuse("none of its GRIDs is in the deck; define them or remove the card")
        chosen = grids.components(nodes, card.text(1), card.error)
        fixed.setdefault((card.integer(0), chosen), []).append(nodes)


def _supports(number: int, numbers: tuple[int, ...], nodes: Indices, grids: Grids) -> list[Support]:
    axes = grids.systems.axes_of(nodes)
    basic = np.isclose(axes, np.eye(3), rtol=0, atol=1e-14).all(axis=(1, 2))
    result = []
    if basic.any():
        result.append(Support(id=number, nodes=nodes[basic], components=numbers))
    turned, axes = nodes[~basic], axes[~basic]
    # Rounding at 1e-12 joins nodes whose directions differ by arithmetic only.
    keys = np.round(axes.reshape(-1, 9), 12)
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    which = which.ravel()
    for i, row in enumerate(first.tolist()):
        result.append(
            Support(id=number, nodes=turned[which == i], components=numbers, axes=axes[row])
        )
    return result
