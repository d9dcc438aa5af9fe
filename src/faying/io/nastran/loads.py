"""SLOAD, GRAV, RFORCE, PLOAD1, LOAD: nodal loads by load set.

MSC Nastran Quick Reference Guide, PLOAD1: TYPE names a component along the basic axes (FX, MX, ...)
or those of the element (FXE, MXE, ...). Without X2, or where it equals X1, P1 acts at X1 alone;
else the intensity per length goes from P1 at X1 to P2, 0 where that is blank, at X2. X are lengths
(LE, LEPR) or parts of the length (FR, FRPR) from end A; LEPR and FRPR give the intensity per length
as seen along a basic force.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import pi

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.fields import SHORT_DIGITS
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.pressures import Part, read_directed_loads, read_pressures
from faying.io.nastran.sections import turned_properties
from faying.io.nastran.supports import ALWAYS
from faying.model.assembly import Assembly, Beam, NodalLoads, PointMass
from faying.model.body_forces import body_forces, centrifugal, nodal_forces_of_beams
from faying.model.elements.beam import beam_frames

_COMPONENTS = [f"{kind}{axis}" for kind in "FM" for axis in "XYZ"]
_TYPES = (*_COMPONENTS, *(f"{name}E" for name in _COMPONENTS))
_SCALES = ("LE", "FR", "LEPR", "FRPR")
# The deflection is cubic, the intensity linear: exact.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


def read_line_loads(
    cards: Mapping[str, Cards], nodes: Matrix, beams: Sequence[Beam], unread: dict[int, str]
) -> list[tuple[Indices, Indices, Matrix]]:
    """Return load sets (n,), nodes (n,) and forces and moments (n, 6).

    Nodes (n_node, 3) [length] are those of the deck, and those at the ends of beams, rods too. Load
    sets with loads on CBEND, with moments by projected length, or along axes of elements with I12
    are added to ``unread``, with what is not read of them.
    """
    if "PLOAD1" not in cards:
        return []
    readable, loaded, kinds, scales = _readable(cards, beams, unread)
    if not len(readable):
        return []
    ends = nodes[np.array([beam.nodes for beam in loaded])]
    axes = ends[:, 1] - ends[:, 0]
    frames, length = beam_frames(loaded, axes)
    components = np.array([_COMPONENTS.index(kind[:2]) for kind in kinds])
    directions = np.eye(3)[components % 3]
    of_element = np.array([kind.endswith("E") for kind in kinds])
    directions[of_element] = frames[of_element, components[of_element] % 3]
    by_length = np.array([scale.startswith("LE") for scale in scales])
    projected = np.array([scale.endswith("PR") for scale in scales]) & ~of_element
    seen = np.linalg.norm(np.cross(axes / length[:, None], directions), axis=1)
    stations, amounts = _along_beams(readable, np.where(by_length, length, 1.0), length)
    projected &= _is_spread(readable)
    amounts[projected] *= seen[projected, None]
    vectors = np.zeros((len(readable), 3, 6))
    for first, these in ((0, components < 3), (3, components >= 3)):
        vectors[these, :, first : first + 3] = amounts[these, :, None] * directions[these, None]
    forces = nodal_forces_of_beams(loaded, nodes, stations, vectors)
    if not np.isfinite(forces).all():
        readable.refuse(
            int(np.flatnonzero(~np.isfinite(forces).all(axis=(1, 2)))[0]),
            "the load is too large for a number",
        )
    places = np.array([beam.nodes for beam in loaded])
    return [(np.repeat(readable.integers(0), 2), places.ravel(), forces.reshape(-1, 6))]


def _readable(
    cards: Mapping[str, Cards], beams: Sequence[Beam], unread: dict[int, str]
) -> tuple[Cards, list[Beam], list[str], list[str]]:
    """Return the cards that are read, their beams, TYPE and SCALE; note the sets of the others."""
    line_loads = cards["PLOAD1"]
    kinds, scales = line_loads.words(2), line_loads.words(3)
    for field, words, allowed in ((2, kinds, _TYPES), (3, scales, _SCALES)):
        for i, word in enumerate(words):
            if word not in allowed:
                line_loads.refuse(
                    i,
                    f"{('TYPE', 'SCALE')[field - 2]} = '{word}'; it is {', '.join(allowed)}",
                    field,
                )
    turned = turned_properties(cards)
    line_ids, bends = (
        set[int]().union(*(cards[name].integers(0).tolist() for name in names if name in cards))
        for names in (("CBAR", "CBEAM"), ("CBEND",))
    )
    by_id = {beam.id: beam for beam in beams if beam.id in line_ids}
    loaded = []
    numbers = line_loads.integers(1).tolist()
    for i, (number, kind, scale) in enumerate(zip(numbers, kinds, scales, strict=True)):
        beam = by_id.get(number)
        if beam is None and number not in bends:
            line_loads.refuse(
                i, f"element {number} is no CBAR or CBEAM of the deck; correct the id", 1
            )
        if beam is None:
            reason = "on a CBEND"
        elif kind in _COMPONENTS[3:] and scale.endswith("PR"):
            reason = "with moments by projected length"  # programs do not say what is projected
        elif kind.endswith("E") and beam.property in turned:
            reason = "along the axes of an element whose section has I12"
        else:
            loaded.append((i, beam))
            continue
        unread.setdefault(int(line_loads.integers(0)[i]), f"{line_loads.where(i)} {reason}")
    rows = [i for i, _ in loaded]
    return (
        line_loads.take(np.array(rows, dtype=np.int64)),
        [beam for _, beam in loaded],
        [kinds[i] for i in rows],
        [scales[i] for i in rows],
    )


def _along_beams(line_loads: Cards, unit: Vector, length: Vector) -> tuple[Matrix, Matrix]:
    """Return places (n, 3) in parts of the length, and the forces there (n, 3)."""
    spread = _is_spread(line_loads)
    first, intensity = line_loads.reals(4), line_loads.reals(5)
    last = np.where(spread, line_loads.reals(6, 0.0), first)
    final = np.where(spread, line_loads.reals(7, 0.0), intensity)
    places = np.stack([first, last], axis=1) / unit[:, None]
    outside = np.flatnonzero(~((places >= 0) & (places <= 1 + SHORT_DIGITS)).all(axis=1))
    if outside.size:
        i = int(outside[0])
        line_loads.refuse(
            i,
            f"X1 = {first[i]:g}, X2 = {last[i]:g} lie beyond the ends of the beam, which is "
            f"{length[i]:g} long; correct them, or SCALE",
            4,
        )
    places = np.minimum(places, 1.0)
    part = (1 + _POINTS) / 2
    stations = places[:, :1] + part * (places[:, 1:] - places[:, :1])
    amounts = intensity[:, None] + part * (final - intensity)[:, None]
    extent = np.abs(places[:, 1] - places[:, 0]) * length
    # A force at a single place: a third of it at each of three that coincide.
    weights = np.where(spread[:, None], extent[:, None] * _WEIGHTS / 2, 1 / 3)
    return stations, weights * amounts


def _is_spread(line_loads: Cards) -> Mask:
    return np.asarray(line_loads.given(6) & (line_loads.reals(4) != line_loads.reals(6, 0.0)))


UNSUPPORTED = (*("ACCEL", "ACCEL1", "GMLOAD", "LSEQ", "QVOL", "SPCR"),)
"""Static loads that are not read; sets that use them are left out."""

_Load = tuple[int, Indices, Matrix]
"""Load set, nodes (n,), forces and moments (n, 6)."""


def read_loads(
    bulk: BulkData,
    structure: Assembly,
    pulls: Mapping[int | None, Matrix],
    unread: Mapping[int, str],
) -> dict[str, NodalLoads]:
    """Read load sets; the one case control selects comes first.

    A set that uses a kind of load that is not supported is left out, with a note. The structure has
    all elements, whose mass GRAV and RFORCE act on. Supports are moved by ``pulls`` (n_node, 6), by
    load set and by SPC (None); sets that are ``unread`` move them otherwise.
    """
    places, chosen = structure.mesh.nodes, bulk.control.load
    spoiled = {**unread, **_unsupported(bulk.cards)}
    nodal = [*read_directed_loads(bulk, structure), *_on_scalar_points(bulk, spoiled)]
    nodal += read_pressures(bulk, structure)
    loads = [load for part in nodal for load in _by_set(*part)]
    loads += [(number, *_loaded(forces)) for number, forces in pulls.items() if number is not None]
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
    always = [_loaded(pulls[None])] if pulls[None].any() else []
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
