"""SPC, SPC1, SPCD, SPCADD and permanent supports: components held at zero, or moved.

MSC Nastran Quick Reference Guide: SPC displaces in every subcase that selects it, SPCD as part of a
load set, in place of what SPC says and where a selected SPC or SPC1 holds the component.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import FormatError, refuse
from faying.io.moved_supports import Place, moved_note, with_moved_supports
from faying.io.nastran.cards import Cards, id_list
from faying.io.nastran.fields import components
from faying.io.nastran.grids import BulkData, Grids, selected_sets
from faying.model.assembly import Assembly, Support

ALWAYS = "spc"
"""Load of what SPC moves where no load set is selected that would take it along."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Moved:
    """What SPC and SPCD displace.

    Attributes
    ----------
    by_load
        Load sets to places and displacements by SPCD; None, the first, is of those by SPC.
    unread
        Load sets to why they are left out.
    """

    by_load: Mapping[int | None, Mapping[Place, float]] = field(default_factory=lambda: {None: {}})
    unread: Mapping[int, str] = field(default_factory=dict)

    @property
    def places(self) -> list[Place]:
        """All that moves, each once."""
        return [*dict.fromkeys(dof for moved in self.by_load.values() for dof in moved)]

    def of_node(self, node: int, axes: Matrix | None) -> dict[str, Vector]:
        """Return how far a node is moved (3,), by load set and :data:`ALWAYS`.

        Its components are along axes; the basic ones if None.
        """
        rows = np.eye(3) if axes is None else axes
        motions = {}
        for number, moved in self.by_load.items():
            along = np.array([moved.get((node, c), 0.0) for c in range(3)])
            if along.any():
                motions[ALWAYS if number is None else str(number)] = along @ rows
        return motions

    def without(self, nodes: Indices) -> "Moved":
        """Return what moves at other nodes."""
        gone = set(nodes.tolist())
        by_load = {
            number: {dof: value for dof, value in moved.items() if dof[0] not in gone}
            for number, moved in self.by_load.items()
        }
        return replace(self, by_load=by_load)


def _displacements(bulk: BulkData, cards: Cards) -> Iterator[tuple[int, Place, float, str]]:
    """Yield set, component, value and place of displacements: of SPC those other than zero."""
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
            for c in chosen:
                yield int(sets[i]), (node, c), float(values[i]), these.where(i)


def _moved(bulk: BulkData, single: Cards | None, fixed: Mask) -> Moved:
    """Return what moves; load sets that move what nothing holds belong to other supports.

    The selected SPC (``single``) hold with SPC1 what is fixed (n_node, 6).
    """
    always: dict[Place, float] = {}
    for _, dof, value, where in () if single is None else _displacements(bulk, single):
        if always.setdefault(dof, value) != value:
            refuse(
                f"{where}: GRID {bulk.grids.ids[dof[0]]} is moved along component {dof[1] + 1} by "
                "another SPC too; remove one"
            )
    by_load: dict[int | None, dict[Place, float]] = {None: always}
    unread: dict[int, str] = {}
    spcd = bulk.cards.get("SPCD")
    for number, dof, value, where in () if spcd is None else _displacements(bulk, spcd):
        location = f"{where} moves GRID {bulk.grids.ids[dof[0]]} along component {dof[1] + 1}"
        if not fixed[dof]:
            unread.setdefault(number, f"{location}, where no selected SPC holds it; that")
        elif dof in always:
            unread.setdefault(number, f"{location}, as SPC does; that")
        by_load.setdefault(number, {})[dof] = value
    readable = {number: moves for number, moves in by_load.items() if number not in unread}
    return Moved(by_load=readable, unread=unread)


def with_moving(
    bulk: BulkData, assembly: Assembly, moved: Moved
) -> tuple[Assembly, dict[int | None, Matrix]]:
    """Return the assembly with springs where supports move, and the forces (n_node, 6) on these.

    Forces are by load set, those of SPC by None.

    Raises
    ------
    FormatError
        If a displacement is too large.
    ModelError
        If something else holds what is to be moved.
    """
    sets = moved.by_load
    courses = {dof: tuple(moves.get(dof, 0.0) for moves in sets.values()) for dof in moved.places}
    nodes = sorted({node for node, _ in courses})
    turned = {node: bulk.grids.systems.axes(node) for node in nodes}
    axes = {node: rows for node, rows in turned.items() if rows is not None}
    assembly, forces = with_moved_supports(assembly, courses, len(sets), axes)
    if not np.isfinite(forces).all():
        refuse("SPC or SPCD: a displacement is too large for a number; check the units")
    always = f"the selected load set, or load '{ALWAYS}' without one that is read,"
    by_loads = {dof for number, moves in sets.items() if number is not None for dof in moves}
    for count, cause, loads in (
        (len(sets[None]), "SPC", always),
        (len(by_loads), "SPCD", "load sets"),
    ):
        if count:
            bulk.ignored.append(moved_note(count, cause, loads))
    return assembly, dict(zip(sets, forces, strict=True))


_Constrained = dict[tuple[int, tuple[int, ...]], list[Indices]]
"""Set id and components to node indices."""


def read_supports(bulk: BulkData) -> tuple[list[Support], Moved]:
    """Read the SPC sets that case control selects; without case control all of them.

    Supports of one set with the same components are joined. Where a displacement coordinate system
    makes their directions differ from the basic ones, nodes with equal directions are joined.
    Permanent supports of GRID have the id 0. Returned is what stands still, and what SPC and SPCD
    displace.
    """
    constrained: _Constrained = {}
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
    moved = _moved(bulk, single, fixed)
    moving = np.zeros_like(fixed)
    for dof in moved.places:
        moving[dof] = True
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


def _collect(cards: Cards, nodes: Indices, field: int, fixed: _Constrained, grids: Grids) -> None:
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


def _lists(cards: Cards, grids: Grids, sets: set[int], fixed: _Constrained) -> None:
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
