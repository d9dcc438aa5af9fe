"""SLOAD, GRAV, RFORCE, PLOAD1, LOAD: nodal loads by load set.

MSC Nastran Quick Reference Guide, PLOAD1: TYPE is a component along the basic axes (FX, MX, ...)
or the element axes (FXE, MXE, ...). Without X2, or if it equals X1, P1 acts at X1 only;
else the intensity per length varies from P1 at X1 to P2 (0 if blank) at X2. X are lengths
(LE, LEPR) or parts of the length (FR, FRPR) from end A; LEPR and FRPR give the intensity per length
projected along a basic force.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from math import pi

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import SHORT_DIGITS
from faying.io.nastran.cards import Card, Cards, each
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.pressures import Part, read_directed_loads, read_pressures
from faying.io.nastran.sections import turned_properties
from faying.io.nastran.supports import ALWAYS
from faying.model.assembly import Assembly, Beam, NodalLoads
from faying.model.body_forces import body_forces, centrifugal, nodal_forces_of_beams
from faying.model.elements.beam import beam_frames

_COMPONENTS = [f"{kind}{axis}" for kind in "FM" for axis in "XYZ"]
_TYPES = (*_COMPONENTS, *(f"{name}E" for name in _COMPONENTS))
_SCALES = ("LE", "FR", "LEPR", "FRPR")
# Exact: the deflection is cubic, the intensity linear.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


def _on_beams(
    bulk: BulkData, nodes: Matrix, beams: Sequence[Beam], unread: dict[int, str]
) -> Iterator[Part]:
    """Yield the loads of PLOAD1; nodes (n_node, 3) include those at the ends of lines.

    Load sets with loads on CBEND, with moments by projected length, or along axes of elements with
    I12 are added to ``unread``, with the reason.
    """
    loaded = [*_readable(bulk.cards, beams, unread)] if "PLOAD1" in bulk.cards else []
    if not loaded:
        return
    cards = bulk.cards["PLOAD1"].take(np.array([card.number for card, _ in loaded]))
    chosen = [beam for _, beam in loaded]
    ends = np.array([beam.nodes for beam in chosen])
    axes = nodes[ends[:, 1]] - nodes[ends[:, 0]]
    frames, length = beam_frames(chosen, axes)
    kinds, scales = cards.words(2), cards.words(3)
    components = np.array([_COMPONENTS.index(kind[:2]) for kind in kinds])
    directions = np.eye(3)[components % 3]
    of_element = np.array([kind.endswith("E") for kind in kinds])
    directions[of_element] = frames[of_element, components[of_element] % 3]
    by_length = np.array([scale.startswith("LE") for scale in scales])
    spread = np.asarray(cards.given(6) & (cards.reals(4) != cards.reals(6, 0.0)))
    stations, amounts = _along_beams(cards, spread, np.where(by_length, length, 1.0), length)
    projected = np.array([scale.endswith("PR") for scale in scales]) & ~of_element & spread
    seen = np.linalg.norm(np.cross(axes / length[:, None], directions), axis=1)
    amounts[projected] *= seen[projected, None]
    vectors = np.zeros((len(cards), 3, 6))
    for first, these in ((0, components < 3), (3, components >= 3)):
        vectors[these, :, first : first + 3] = amounts[these, :, None] * directions[these, None]
    forces = nodal_forces_of_beams(chosen, nodes, stations, vectors)
    cards.check_finite(forces)
    yield np.repeat(cards.integers(0), 2), ends.ravel(), forces.reshape(-1, 6)


def _readable(
    cards: Mapping[str, Cards], beams: Sequence[Beam], unread: dict[int, str]
) -> Iterator[tuple[Card, Beam]]:
    """Yield the supported PLOAD1 and their beams; note the sets of the others."""
    lines, bends = (
        {card.integer(0) for card in each(cards, *names)}
        for names in (("CBAR", "CBEAM"), ("CBEND",))
    )
    by_number = {beam.id: beam for beam in beams if beam.id in lines}
    turned = turned_properties(cards)
    for card in cards["PLOAD1"]:
        kind, scale, number = card.choice(2, _TYPES), card.choice(3, _SCALES), card.integer(1)
        beam = by_number.get(number)
        if beam is None and number not in bends:
            card.refuse(f"element {number} is not a CBAR or CBEAM of the deck; correct the id", 1)
        if beam is None:
            reason = "on a CBEND"
        elif kind in _COMPONENTS[3:] and scale.endswith("PR"):
            reason = "with moments by projected length"  # manuals do not define the projection
        elif kind.endswith("E") and beam.property in turned:
            reason = "along the axes of an element whose section has I12"
        else:
            yield card, beam
            continue
        unread.setdefault(card.integer(0), f"{card.where()} {reason}")


def _along_beams(cards: Cards, spread: Mask, unit: Vector, length: Vector) -> tuple[Matrix, Matrix]:
    """Return points (n, 3) as fractions of the length, and the forces there (n, 3)."""
    first, intensity = cards.reals(4), cards.reals(5)
    last = np.where(spread, cards.reals(6, 0.0), first)
    final = np.where(spread, cards.reals(7, 0.0), intensity)
    places = np.stack([first, last], axis=1) / unit[:, None]
    cards.refuse_where(
        np.asarray(~((places >= 0) & (places <= 1 + SHORT_DIGITS)).all(axis=1)),
        lambda i: (
            f"X1 = {first[i]:g}, X2 = {last[i]:g} lie beyond the ends of the beam, which is "
            f"{length[i]:g} long; correct them, or SCALE"
        ),
        4,
    )
    places = np.minimum(places, 1.0)
    part = (1 + _POINTS) / 2
    stations = places[:, :1] + part * (places[:, 1:] - places[:, :1])
    amounts = intensity[:, None] + part * (final - intensity)[:, None]
    extent = np.abs(places[:, 1] - places[:, 0]) * length
    # A force at a single point: a third at each of three coincident points.
    weights = np.where(spread[:, None], extent[:, None] * _WEIGHTS / 2, 1 / 3)
    return stations, weights * amounts


UNSUPPORTED = (*("ACCEL", "ACCEL1", "GMLOAD", "LSEQ", "QVOL", "SPCR"),)
"""Unsupported static loads; sets with them are left out."""


def read_loads(
    bulk: BulkData,
    structure: Assembly,
    pulls: Mapping[int | None, Matrix],
    unread: Mapping[int, str],
) -> dict[str, NodalLoads]:
    """Read load sets; the set selected by case control comes first.

    A set with an unsupported kind of load is left out with a note. GRAV and RFORCE act on all mass
    of the structure. ``pulls`` are the forces (n_node, 6) that move supports, by load set and for
    SPC (None); ``unread`` has reasons to leave sets out.
    """
    nodes, chosen = structure.mesh.nodes, bulk.control.set_of("LOAD")
    spoiled = {**unread, **_unsupported(bulk.cards)}
    parts: dict[int, list[tuple[Indices, Matrix]]] = {}
    for sets, loaded, forces in chain(
        read_directed_loads(bulk, structure),
        _on_scalar_points(bulk, spoiled),
        read_pressures(bulk, structure),
        (_part(number, forces) for number, forces in pulls.items() if number is not None),
        _on_beams(bulk, nodes, structure.beams, spoiled),
        _accelerated(bulk, structure, spoiled),
    ):
        for number in np.unique(sets).tolist():
            mine = np.broadcast_to(sets == number, len(loaded))
            parts.setdefault(number, []).append((loaded[mine], forces[mine]))
    for card in bulk.cards.get("LOAD", ()):
        number = card.integer(0)
        combined: list[tuple[Indices, Matrix]] = []
        for factor, member, fields in card.combination():
            if member in spoiled:
                spoiled.setdefault(number, spoiled[member])
            elif member not in parts or member == number:
                fields.refuse(f"load set {member} is not in the deck; define it (FORCE, MOMENT)")
            combined += [(nodes, factor * forces) for nodes, forces in parts.get(member, [])]
        if number in parts:
            card.refuse(f"load set {number} also has cards of its own; give the LOAD another id")
        parts[number] = combined
    for number, reason in spoiled.items():
        bulk.ignored.append(f"load set {number} ({reason} is not supported)")
        parts.pop(number, None)
    if chosen is not None and chosen not in parts and chosen not in spoiled:
        bulk.ignored.append(f"case control LOAD = {chosen} (no supported load has it)")
    always = [_part(0, pulls[None])[1:]] if pulls[None].any() else []
    if chosen in parts:
        parts[chosen] += always
    order = sorted(parts, key=lambda number: (number != chosen, number))
    named = {str(number): parts[number] for number in order}
    if always and chosen not in parts:
        named = {ALWAYS: always, **named}
    return {name: _merged(of_load) for name, of_load in named.items()}


def _part(number: int, forces: Matrix) -> Part:
    """Return the forces (n_node, 6) of a set as loads of nodes."""
    loaded = np.flatnonzero((forces != 0).any(axis=1))
    return np.array([number]), loaded, forces[loaded]


def _on_scalar_points(bulk: BulkData, unread: dict[int, str]) -> Iterator[Part]:
    """Yield the loads of SLOAD: pairs of a scalar point and its load."""
    if "SLOAD" in bulk.cards:
        pairs = bulk.cards["SLOAD"].groups(1, 2)
        sets, nodes = pairs.whole.integers(0), bulk.grids.of_column(pairs, 0)
        for i in np.flatnonzero(nodes < len(bulk.grids.ids) - bulk.grids.n_scalar).tolist():
            reason = f"{pairs.where(i)} on GRID {bulk.grids.ids[nodes[i]]}, which is no SPOINT,"
            unread.setdefault(int(sets[i]), reason)
        yield sets, nodes, pairs.reals(1)[:, None] * np.eye(6)[:1]


def _unsupported(cards: Mapping[str, Cards]) -> dict[int, str]:
    """Return file and line of the first unsupported load of each load set."""
    unsupported: dict[int, str] = {}
    for card in each(cards, *UNSUPPORTED):
        unsupported.setdefault(card.integer(0), card.where())
    return unsupported


def _merged(parts: list[tuple[Indices, Matrix]]) -> NodalLoads:
    """Sum the loads at each node."""
    nodes = np.concatenate([np.empty(0, dtype=np.int64), *(n for n, _ in parts)])
    forces = np.concatenate([np.empty((0, 6)), *(f for _, f in parts)])
    unique, which = np.unique(nodes, return_inverse=True)
    total = np.zeros((len(unique), 6))
    np.add.at(total, which, forces)
    return NodalLoads(nodes=unique, forces=total)


def _accelerated(bulk: BulkData, structure: Assembly, unread: dict[int, str]) -> Iterator[Part]:
    """Yield the forces of GRAV and RFORCE on all masses.

    MSC Nastran Quick Reference Guide: GRAV accelerates by A N; RFORCE rotates with A revolutions
    per unit of time about R through grid G, or the origin. Load sets with unsupported cards are
    added to ``unread``, with the reason.
    """
    nodes = structure.mesh.nodes
    for card in bulk.cards.get("GRAV", ()):
        vector = _basic(card, 1, card.reals((3, 4, 5), 0.0), bulk.grids)
        if vector is None:
            unread.setdefault(card.integer(0), f"{card.where()} in a system that turns")
        else:
            motion = np.tile(card.real(2) * vector, (len(nodes), 1))
            yield _part(card.integer(0), body_forces(structure, motion))
    for card in bulk.cards.get("RFORCE", ()):
        number, speed = card.integer(0), 2 * pi * card.real(3, 0.0)
        axis = _basic(card, 2, card.reals((4, 5, 6), 0.0), bulk.grids)
        point = bulk.grids.nodes[bulk.grids.one(card, 1)] if card.integer(1, 0) else np.zeros(3)
        if any(any(mass.offset) for mass in structure.masses):
            unread.setdefault(number, f"{card.where()} of CONM2 that are offset")
        elif (
            axis is None or abs(float(np.linalg.norm(axis)) - 1) > SHORT_DIGITS or card.real(8, 0.0)
        ):
            reason = (
                f"{card.where()} with RACC, or a direction that is turning or not of length one"
            )
            unread.setdefault(number, reason)
        else:
            motion = centrifugal(speed**2, point, axis / np.linalg.norm(axis), nodes)
            yield _part(number, body_forces(structure, motion))


def _basic(card: Card, field: int, vector: Vector, grids: Grids) -> Vector | None:
    """Return a vector in the basic frame; None if its system is not rectangular."""
    if card.integer(field, 0) == 0:
        return vector
    frame = grids.systems.frame_of(card, field)
    return np.asarray(vector @ frame.axes) if frame.kind == "R" else None
