"""PLOAD1: forces and moments along CBAR and CBEAM.

MSC Nastran Quick Reference Guide: TYPE names a component along the basic axes (FX, MX, ...) or
those of the element (FXE, MXE, ...). Without X2, or where it equals X1, P1 acts at X1 alone; else
the intensity per length goes from P1 at X1 to P2, 0 where that is blank, at X2. X are lengths (LE,
LEPR) or parts of the length (FR, FRPR) from end A; LEPR and FRPR give the intensity per length as
seen along a basic force.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.io.nastran.cards import Cards
from faying.io.nastran.fields import SHORT_DIGITS
from faying.io.nastran.principal_axes import turned_properties
from faying.model.assembly import Beam
from faying.model.elements.beam import beam_frames
from faying.model.elements.beam_loads import nodal_forces_of_beams

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
    every = _beams(cards["PLOAD1"], cards, beams)
    readable, loaded, kinds, scales = _readable(cards, every, unread)
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
    stations, amounts = _stations(readable, np.where(by_length, length, 1.0), length)
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
    cards: Mapping[str, Cards], beams: Sequence[Beam | None], unread: dict[int, str]
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
    loaded = []
    for i, (beam, kind, scale) in enumerate(zip(beams, kinds, scales, strict=True)):
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


def _beams(
    line_loads: Cards, cards: Mapping[str, Cards], beams: Sequence[Beam]
) -> list[Beam | None]:
    """Return the beam of each card, None of a CBEND."""
    beam_ids = set[int]().union(*(cards[n].integers(0) for n in ("CBAR", "CBEAM") if n in cards))
    bends = set(cards["CBEND"].integers(0).tolist()) if "CBEND" in cards else set[int]()
    by_id = {beam.id: beam for beam in beams if beam.id in beam_ids}
    ids = line_loads.integers(1).tolist()
    for i, number in enumerate(ids):
        if number not in by_id and number not in bends:
            line_loads.refuse(
                i, f"element {number} is no CBAR or CBEAM of the deck; correct the id", 1
            )
    return [by_id.get(number) for number in ids]


def _stations(line_loads: Cards, unit: Vector, length: Vector) -> tuple[Matrix, Matrix]:
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
