"""FORCE, MOMENT, PLOAD4, GRAV, RFORCE, LOAD and others: nodal loads by load set."""

from collections.abc import Mapping, Sequence

import numpy as np

from faying._typing import Indices, Matrix
from faying.io.nastran.body_loads import read_accelerations
from faying.io.nastran.cards import Cards
from faying.io.nastran.directed_loads import read_directed_loads
from faying.io.nastran.grids import Grids
from faying.io.nastran.line_loads import read_line_loads
from faying.io.nastran.moved_supports import ALWAYS, Moving
from faying.io.nastran.pressures import read_pressures
from faying.model.assembly import Assembly, NodalLoads
from faying.model.body_forces import body_forces
from faying.model.mesh import Mesh
from faying.model.shells import ShellBlock

UNSUPPORTED = (*("ACCEL", "ACCEL1", "GMLOAD", "LSEQ", "QVOL", "SPCR"),)
"""Static loads that are not read; sets that use them are left out."""

_Part = tuple[Indices, Matrix]


def read_loads(
    cards: Mapping[str, Cards],
    grids: Grids,
    structure: Assembly,
    chosen: int | None,
    moving: Moving,
    ignored: list[str],
) -> dict[str, NodalLoads]:
    """Read load sets; the one case control selects comes first.

    A set that uses a kind of load that is not supported is left out, with a note.

    Parameters
    ----------
    structure
        With all elements, whose mass GRAV and RFORCE act on.
    moving
        What moves supports.
    """
    parts: dict[int, list[_Part]] = {}
    spoiled = {**moving.unread, **_unsupported(cards)}
    for name, first in (("FORCE", 0), ("MOMENT", 3)):
        if name in cards:
            _add(cards[name], grids, first, parts)
    if "SLOAD" in cards:
        _add_scalar(cards["SLOAD"], grids, parts, spoiled)
    if "PLOAD4" in cards:
        _add_pressures(cards["PLOAD4"], grids, structure.mesh, structure.shells, parts)
    for sets, nodes, forces in read_directed_loads(
        cards, grids, structure.mesh.nodes, structure.shells
    ):
        for number in np.unique(sets).tolist():
            parts.setdefault(number, []).append((nodes[sets == number], forces[sets == number]))
    for number, forces in moving.by_load.items():
        parts.setdefault(number, []).append(_part(forces))
    for sets, nodes, forces in read_line_loads(
        cards, structure.mesh.nodes, structure.beams, spoiled
    ):
        for number in np.unique(sets).tolist():
            parts.setdefault(number, []).append((nodes[sets == number], forces[sets == number]))
    for number, acceleration in read_accelerations(
        cards, grids, structure.mesh.nodes, structure.masses, spoiled
    ):
        parts.setdefault(number, []).append(_part(body_forces(structure, acceleration)))
    for card in cards.get("LOAD", ()):
        number = card.integer(0)
        overall = card.real(1, 1.0)
        combined: list[_Part] = []
        for field in range(2, len(card), 2):
            if not card.text(field) and not card.text(field + 1):
                continue
            factor, member = overall * card.real(field), card.integer(field + 1)
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
        ignored.append(f"load set {number} ({reason} is not supported)")
        parts.pop(number, None)
    if chosen is not None and chosen not in parts and chosen not in spoiled:
        ignored.append(f"case control LOAD = {chosen} (no load of the deck that is read has it)")
    always = [_part(moving.always)] if moving.always.any() else []
    if chosen in parts:
        parts[chosen] += always
    order = sorted(parts, key=lambda number: (number != chosen, number))
    named = {str(number): parts[number] for number in order}
    if always and chosen not in parts:
        named = {ALWAYS: always, **named}
    return {name: _merged(of_load) for name, of_load in named.items()}


def _part(forces: Matrix) -> _Part:
    """Return nodes with forces, and these."""
    loaded = np.flatnonzero((forces != 0).any(axis=1))
    return loaded, forces[loaded]


def _add(cards: Cards, grids: Grids, first: int, parts: dict[int, list[_Part]]) -> None:
    sets = cards.integers(0)
    nodes = grids.of_column(cards, 1)
    system = cards.integers(2, 0)
    vectors = np.stack([cards.reals(j, 0.0) for j in (4, 5, 6)], axis=1)
    vectors = vectors * cards.reals(3)[:, None]
    for number in np.unique(system[system != 0]).tolist():
        rows = np.flatnonzero(system == number)
        if number not in grids.systems.frames:
            cards.refuse(
                int(rows[0]),
                f"coordinate system {number} is not in the deck; define it (CORD2R, ...)",
                2,
            )
        axes = grids.systems.frames[number].directions(grids.nodes[nodes[rows]])
        vectors[rows] = np.einsum("ni,nij->nj", vectors[rows], axes)
    forces = np.zeros((len(cards), 6))
    forces[:, first : first + 3] = vectors
    if not np.isfinite(forces).all():
        card = int(np.flatnonzero(~np.isfinite(forces).all(axis=1))[0])
        cards.refuse(card, "the load is too large for a number")
    for number in np.unique(sets).tolist():
        parts.setdefault(number, []).append((nodes[sets == number], forces[sets == number]))


def _add_scalar(
    cards: Cards, grids: Grids, parts: dict[int, list[_Part]], unread: dict[int, str]
) -> None:
    """SLOAD: pairs of a scalar point and its load."""
    for first in (1, 3, 5):
        these = cards.take(cards.given(first))
        nodes = grids.of_column(these, first)
        for i in np.flatnonzero(nodes < len(grids.ids) - grids.n_scalar).tolist():
            reason = f"{these.where(i)} on GRID {grids.ids[nodes[i]]}, which is no SPOINT,"
            unread.setdefault(int(these.integers(0)[i]), reason)
        forces = np.zeros((len(these), 6))
        forces[:, 0] = these.reals(first + 1)
        for number in np.unique(these.integers(0)).tolist():
            rows = these.integers(0) == number
            parts.setdefault(number, []).append((nodes[rows], forces[rows]))


def _add_pressures(
    cards: Cards,
    grids: Grids,
    mesh: Mesh,
    shells: Sequence[ShellBlock],
    parts: dict[int, list[_Part]],
) -> None:
    sets, nodes, vectors = read_pressures(cards, grids, mesh.nodes, mesh.blocks, shells)
    forces = np.hstack([vectors, np.zeros_like(vectors)])
    if not np.isfinite(forces).all():
        cards.refuse(0, "a pressure load is too large for a number")
    for number in np.unique(sets).tolist():
        parts.setdefault(number, []).append((nodes[sets == number], forces[sets == number]))


def _unsupported(cards: Mapping[str, Cards]) -> dict[int, str]:
    """Load set to the place of its first load that is not supported."""
    unsupported: dict[int, str] = {}
    for name in UNSUPPORTED:
        if name in cards:
            numbers, first = np.unique(cards[name].integers(0), return_index=True)
            for number, card in zip(numbers.tolist(), first.tolist(), strict=True):
                unsupported.setdefault(number, cards[name].where(card))
    return unsupported


def _merged(parts: list[_Part]) -> NodalLoads:
    """Sum the loads at each node."""
    if not parts:
        return NodalLoads(nodes=np.zeros(0, dtype=np.int64), forces=np.zeros((0, 6)))
    nodes = np.concatenate([n for n, _ in parts])
    forces = np.concatenate([f for _, f in parts])
    unique, which = np.unique(nodes, return_inverse=True)
    total = np.zeros((len(unique), 6))
    np.add.at(total, which, forces)
    return NodalLoads(nodes=unique, forces=total)
