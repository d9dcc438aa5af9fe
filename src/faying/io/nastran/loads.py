"""FORCE, MOMENT, PLOAD4, GRAV, RFORCE, LOAD and others: nodal loads by load set."""

from collections.abc import Iterator, Mapping, Sequence
from math import pi

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.fields import SHORT_DIGITS
from faying.io.nastran.grids import Grids
from faying.io.nastran.line_loads import read_line_loads
from faying.io.nastran.moved_supports import ALWAYS, Moving
from faying.io.nastran.pressures import Part, read_directed_loads, read_pressures
from faying.model.assembly import Assembly, NodalLoads, PointMass
from faying.model.body_forces import body_forces, centrifugal

UNSUPPORTED = (*("ACCEL", "ACCEL1", "GMLOAD", "LSEQ", "QVOL", "SPCR"),)
"""Static loads that are not read; sets that use them are left out."""

_Load = tuple[int, Indices, Matrix]
"""Load set, nodes (n,), forces and moments (n, 6)."""


def read_loads(bulk: BulkData, structure: Assembly, moving: Moving) -> dict[str, NodalLoads]:
    """Read load sets; the one case control selects comes first.

    A set that uses a kind of load that is not supported is left out, with a note. The structure has
    all elements, whose mass GRAV and RFORCE act on; ``moving`` moves supports.
    """
    places, chosen = structure.mesh.nodes, bulk.control.load
    spoiled = {**moving.unread, **_unsupported(bulk.cards)}
    nodal = [*_on_grids(bulk), *_on_scalar_points(bulk, spoiled)]
    nodal += read_pressures(bulk, structure)
    nodal += read_directed_loads(bulk, structure)
    loads = [load for part in nodal for load in _by_set(*part)]
    loads += [(number, *_loaded(forces)) for number, forces in moving.by_load.items()]
    along = read_line_loads(bulk.cards, places, structure.beams, spoiled)
    loads += [load for part in along for load in _by_set(*part)]
    accelerations = read_accelerations(bulk, places, structure.masses, spoiled)
    loads += [(n, *_loaded(body_forces(structure, motion))) for n, motion in accelerations]
    parts: dict[int, list[tuple[Indices, Matrix]]] = {}
    for number, nodes, forces in loads:
        parts.setdefault(number, []).append((nodes, forces))
    for card in bulk.cards.get("LOAD", ()):
        number = card.integer(0)
        combined: list[tuple[Indices, Matrix]] = []
        for factor, member, field in card.combination():
            if member in spoiled:
                spoiled.setdefault(number, spoiled[member])
            elif member not in parts or member == number:
                card.refuse(
                    f"load set {member} is not in the deck; define it (FORCE, MOMENT)", field
                )
            combined += [(nodes, factor * forces) for nodes, forces in parts.get(member, [])]
        if number in parts:
            card.refuse(f"load set {number} also has cards of its own; give the LOAD another id")
        parts[number] = combined
    for number, reason in spoiled.items():
        bulk.ignored.append(f"load set {number} ({reason} is not supported)")
        parts.pop(number, None)
    if chosen is not None and chosen not in parts and chosen not in spoiled:
        bulk.ignored.append(
            f"case control LOAD = {chosen} (no load of the deck that is read has it)"
        )
    always = [_loaded(moving.always)] if moving.always.any() else []
    if chosen in parts:
        parts[chosen] += always
    order = sorted(parts, key=lambda number: (number != chosen, number))
    named = {str(number): parts[number] for number in order}
    if always and chosen not in parts:
        named = {ALWAYS: always, **named}
    return {name: _merged(of_load) for name, of_load in named.items()}


def _loaded(forces: Matrix) -> tuple[Indices, Matrix]:
    """Return nodes with forces, and these."""
    loaded = np.flatnonzero((forces != 0).any(axis=1))
    return loaded, forces[loaded]


def _by_set(sets: Indices, nodes: Indices, forces: Matrix) -> Iterator[_Load]:
    for number in np.unique(sets).tolist():
        yield number, nodes[sets == number], forces[sets == number]


def _on_grids(bulk: BulkData) -> Iterator[Part]:
    """FORCE and MOMENT: a size times a vector along a coordinate system."""
    for loads, first in (
        (bulk.cards[n], j) for n, j in (("FORCE", 0), ("MOMENT", 3)) if n in bulk.cards
    ):
        nodes = bulk.grids.of_column(loads, 1)
        vectors = np.stack([loads.reals(j, 0.0) for j in (4, 5, 6)], axis=1)
        axes = bulk.grids.systems.directions_at(
            loads, 2, np.arange(len(loads)), bulk.grids.nodes[nodes]
        )
        forces = np.zeros((len(loads), 6))
        forces[:, first : first + 3] = np.einsum(
            "ni,nij->nj", vectors * loads.reals(3)[:, None], axes
        )
        loads.check_finite(forces)
        yield loads.integers(0), nodes, forces


def _on_scalar_points(bulk: BulkData, unread: dict[int, str]) -> Iterator[Part]:
    """SLOAD: pairs of a scalar point and its load."""
    for first in (1, 3, 5) if "SLOAD" in bulk.cards else ():
        these = bulk.cards["SLOAD"].take(bulk.cards["SLOAD"].given(first))
        nodes = bulk.grids.of_column(these, first)
        for i in np.flatnonzero(nodes < len(bulk.grids.ids) - bulk.grids.n_scalar).tolist():
            reason = f"{these.where(i)} on GRID {bulk.grids.ids[nodes[i]]}, which is no SPOINT,"
            unread.setdefault(int(these.integers(0)[i]), reason)
        forces = np.zeros((len(these), 6))
        forces[:, 0] = these.reals(first + 1)
        yield these.integers(0), nodes, forces


def _unsupported(cards: Mapping[str, Cards]) -> dict[int, str]:
    """Load set to the place of its first load that is not supported."""
    unsupported: dict[int, str] = {}
    for name in UNSUPPORTED:
        if name in cards:
            numbers, first = np.unique(cards[name].integers(0), return_index=True)
            for number, card in zip(numbers.tolist(), first.tolist(), strict=True):
                unsupported.setdefault(number, cards[name].where(card))
    return unsupported


def _merged(parts: list[tuple[Indices, Matrix]]) -> NodalLoads:
    """Sum the loads at each node."""
    nodes = np.concatenate([np.empty(0, dtype=np.int64), *(n for n, _ in parts)])
    forces = np.concatenate([np.empty((0, 6)), *(f for _, f in parts)])
    unique, which = np.unique(nodes, return_inverse=True)
    total = np.zeros((len(unique), 6))
    np.add.at(total, which, forces)
    return NodalLoads(nodes=unique, forces=total)


def read_accelerations(
    bulk: BulkData, nodes: Matrix, masses: Sequence[PointMass], unread: dict[int, str]
) -> Iterator[tuple[int, Matrix]]:
    """Yield load set and accelerations (n_node, 3) of each card.

    MSC Nastran Quick Reference Guide: GRAV accelerates by A N; RFORCE turns with A revolutions per
    unit of time about R through grid G, or the origin. Nodes (n_node, 3) [length] are all that have
    mass. Load sets of cards that are not represented are added to ``unread``, with what is not read
    of them.
    """
    for card in bulk.cards.get("GRAV", ()):
        vector = _basic(card, 1, [card.real(j, 0.0) for j in (3, 4, 5)], bulk.grids)
        if vector is None:
            reason = f"{card.where()} in a system that turns"
            unread.setdefault(card.integer(0), reason)
        else:
            yield card.integer(0), np.tile(card.real(2) * vector, (len(nodes), 1))
    for card in bulk.cards.get("RFORCE", ()):
        number, speed = card.integer(0), 2 * pi * card.real(3, 0.0)
        axis = _basic(card, 2, [card.real(j, 0.0) for j in (4, 5, 6)], bulk.grids)
        point = bulk.grids.nodes[bulk.grids.one(card, 1)] if card.integer(1, 0) else np.zeros(3)
        if any(any(mass.offset) for mass in masses):
            unread.setdefault(number, f"{card.where()} of CONM2 that are offset")
        elif (
            axis is None or abs(float(np.linalg.norm(axis)) - 1) > SHORT_DIGITS or card.real(8, 0.0)
        ):
            reason = (
                f"{card.where()} with RACC, or a direction that is turning or not of length one"
            )
            unread.setdefault(number, reason)
        else:
            yield number, centrifugal(speed**2, point, axis / np.linalg.norm(axis), nodes)


def _basic(card: Card, field: int, values: list[float], grids: Grids) -> Vector | None:
    """Turn a vector to the basic frame; None if its system has other directions elsewhere."""
    if card.integer(field, 0) == 0:
        return np.array(values)
    frame = grids.systems.frame_of(card, field)
    return np.asarray(np.array(values) @ frame.axes) if frame.kind == "R" else None
