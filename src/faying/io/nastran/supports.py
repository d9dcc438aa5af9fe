"""SPC, SPC1, SPCD, SPCADD and permanent supports: components held at zero, or moved.

MSC Nastran Quick Reference Guide: SPC displaces in each subcase that selects it, SPCD as part of a
load set, instead of the value of SPC and only where a selected SPC or SPC1 holds the component.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import FormatError, refuse
from faying.io.moved_supports import Place, moved_note, with_moved_supports
from faying.io.nastran.cards import Cards
from faying.io.nastran.fields import components
from faying.io.nastran.grids import BulkData, Grids, selected_sets
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import Assembly, Support

ALWAYS = "spc"
"""Load of displacements by SPC if no load set is selected."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Moved:
    """Displacements by SPC and SPCD.

    Attributes
    ----------
    by_load
        Load sets to displacements by SPCD, by place; the first key, None, has those by SPC.
    unread
        Load sets to the reasons why they are left out.
    """

    by_load: Mapping[int | None, Mapping[Place, float]] = field(default_factory=lambda: {None: {}})
    unread: Mapping[int, str] = field(default_factory=dict)

    @property
    def places(self) -> list[Place]:
        """Return all moved places without duplicates."""
        return [*dict.fromkeys(dof for moved in self.by_load.values() for dof in moved)]

    def of_node(self, node: int, axes: Matrix | None) -> dict[str, Vector]:
        """Return the displacement (3,) of a node by load set and :data:`ALWAYS`.

        Components are along ``axes``; along the basic axes if None.
        """
        rows = np.eye(3) if axes is None else axes
        motions = {}
        for number, moved in self.by_load.items():
            along = np.array([moved.get((node, c), 0.0) for c in range(3)])
            if along.any():
                motions[ALWAYS if number is None else str(number)] = along @ rows
        return motions

    def without(self, nodes: Indices) -> "Moved":
        """Return the displacements of other nodes."""
        gone = set(nodes.tolist())
        by_load = {
            number: {dof: value for dof, value in moved.items() if dof[0] not in gone}
            for number, moved in self.by_load.items()
        }
        return replace(self, by_load=by_load)


def _displacements(bulk: BulkData, cards: Cards) -> Iterator[tuple[int, Place, float, str]]:
    """Yield set, component, value and position of SPCD and of nonzero displacements of SPC."""
    these = cards.groups(1, 3)
    if cards.name == "SPC":
        these = these.take(these.reals(2, 0.0) != 0)
    if len(these) and bulk.control.heat:
        these.refuse(
            0,
            "a temperature, as the analysis is heat transfer; no temperatures are computed here",
            2,
        )
    for i, (nodes, number, digits, value) in enumerate(
        zip(
            bulk.grids.of_column(these, 0)[:, None],
            these.whole.integers(0).tolist(),
            these.words(1),
            these.reals(2, 0.0).tolist(),
            strict=True,
        )
    ):
        for c in bulk.grids.components(nodes, digits, partial(these.error, i)):
            yield number, (int(nodes[0]), c), value, these.where(i)


def _moved(bulk: BulkData, single: Cards | None, fixed: Mask) -> Moved:
    """Return the displacements; load sets that move unsupported components are left out.

    The selected SPC (``single``) and SPC1 hold the components in ``fixed`` (n_node, 6).
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
    """Return the assembly with springs at moving supports, and the forces (n_node, 6) on them.

    Forces are by load set; the key None is for SPC.
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


def read_supports(bulk: BulkData) -> tuple[list[Support], Moved]:
    """Read the SPC sets selected by case control; all sets without case control.

    Nodes of one set with equal components and directions have one support. Permanent supports of
    GRID have the id 0. Returned are the fixed supports, and the displacements by SPC and SPCD.
    """
    spc, lists = bulk.cards.get("SPC"), bulk.cards.get("SPC1")
    present = [cards for cards in (spc, lists) if cards is not None]
    sets = selected_sets(bulk, "SPC", {n for cards in present for n in cards.integers(0).tolist()})
    spc, lists = (
        None if cards is None else cards.take(np.isin(cards.integers(0), list(sets)))
        for cards in (spc, lists)
    )
    fixed: dict[int, Mask] = {}
    place = "GRID or GRDSET: permanent support (PS)"
    permanent = (
        (0, components(digits, lambda text: FormatError(f"{place}: {text}")), nodes)
        for digits, nodes in bulk.grids.permanent.items()
    )
    shape = (len(bulk.grids.ids), 6)
    for number, chosen, nodes in (
        *permanent,
        *_singles(spc, bulk.grids),
        *_lists(lists, bulk.grids),
    ):
        fixed.setdefault(number, np.zeros(shape, dtype=bool))[nodes[:, None], list(chosen)] = True
    moved = _moved(bulk, spc, np.any([np.zeros(shape, dtype=bool), *fixed.values()], axis=0))
    moving = np.zeros(shape, dtype=bool)
    for dof in moved.places:
        moving[dof] = True
    supports = [
        support
        for number, mask in fixed.items()
        for support in bulk.grids.systems.supports(mask & ~moving, number)
    ]
    return supports, moved


_Fixed = Iterator[tuple[int, tuple[int, ...], Indices]]
"""Set, components 0..5 and nodes (n,)."""


def _singles(cards: Cards | None, grids: Grids) -> _Fixed:
    """Yield the components fixed by SPC, with nodes of equal set and components together."""
    if cards is None:
        return
    groups = cards.groups(1, 3)
    nodes = grids.of_column(groups, 0)
    rows: dict[tuple[int, str], list[int]] = {}
    for row, key in enumerate(zip(groups.whole.integers(0).tolist(), groups.words(1), strict=True)):
        rows.setdefault(key, []).append(row)
    for (number, digits), these in rows.items():
        error = partial(groups.error, these[0])
        yield number, grids.components(nodes[these], digits, error), nodes[these]


def _lists(cards: Cards | None, grids: Grids) -> _Fixed:
    """Yield the components fixed by SPC1."""
    for card in () if cards is None else cards:
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
        yield card.integer(0), grids.components(nodes, card.text(1), card.error), nodes
