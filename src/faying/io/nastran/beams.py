"""CBAR, CBEAM: beam elements; BAROR, BEAMOR: what their blank fields mean."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.io.nastran import fields as numbers
from faying.io.nastran.beam_ends import BeamEnds
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.bushes import orientation
from faying.io.nastran.cards import Card, Cards, property_of
from faying.io.nastran.general_elements import springs_between
from faying.io.nastran.grids import Grids
from faying.io.nastran.principal_axes import turned_about
from faying.io.nastran.sections import Property
from faying.model.assembly import Beam, Spring
from faying.model.axes import axes_along


def read_beams(
    bulk: BulkData, sections: Mapping[str, Mapping[int, Property]], ends: BeamEnds
) -> list[Beam]:
    """Read beams; orientation vectors are turned into the basic frame.

    ``ends`` takes the nodes of beams with offsets and pins.
    """
    beams: list[Beam] = []
    for name in ("CBAR", "CBEAM"):
        default = _default(bulk.cards, {"CBAR": "BAROR", "CBEAM": "BEAMOR"}[name])
        beams += [
            _beam(_filled(card, default), bulk.grids, sections[name], ends)
            for card in bulk.cards.get(name, ())
        ]
    return beams


def _default(cards: Mapping[str, Cards], name: str) -> Card | None:
    """Return the card that fills blank fields of beams."""
    defaults = list(cards.get(name, ()))
    if len(defaults) > 1:
        defaults[1].refuse(f"a second {name}; the first is at {defaults[0].where()}, keep one")
    for card in defaults:
        card.refuse_given([0, 2, 3])
    return defaults[0] if defaults else None


def _filled(card: Card, default: Card | None) -> Card:
    """Take property, orientation and OFFT from the default where the beam leaves them blank."""
    if default is None:
        return card
    texts = [*card.texts, *[""] * (8 - len(card))]
    orientation = [text for text in texts[4:7] if text]
    is_grid = len(orientation) == 1 and bool(texts[4]) and numbers.integer(texts[4]) is not None
    if orientation and not is_grid and len(orientation) < 3 and any(default.texts[4:7]):
        card.refuse(f"give all of X1, X2, X3: {default.where()} fills the blank ones", 4)
    for field in (1, *(() if orientation else (4, 5, 6)), 7):
        texts[field] = texts[field] or default.text(field)
    return replace(card, texts=texts)


def _beam(card: Card, grids: Grids, sections: Mapping[int, Property], ends: BeamEnds) -> Beam:
    number = card.integer(0)
    kinds = "PBAR or PBARL" if card.cards.name == "CBAR" else "PBEAM or PBEAML"
    section, material, angle, _ = property_of(card, sections, kinds)
    grid_ends = grids.one(card, 2), grids.one(card, 3)
    vector = _orientation(card, grids, grid_ends[0])
    along = _between(card, grids, grid_ends, vector)
    (start, origin), (end, to) = (
        ends.offset(card, grids, i, node, along) for i, node in enumerate(grid_ends)
    )
    axes = _axes(card, to - origin, vector)
    x, y, z = turned_about(to - origin, vector, angle).tolist()
    return Beam(
        id=number,
        nodes=ends.pinned(card, (start, end), (origin, to), axes),
        section=section,
        material=material,
        orientation=(x, y, z),
        property=card.integer(1, number),
    )


def _orientation(card: Card, grids: Grids, start: int) -> Vector:
    flag = card.text(7)
    # OFFT, in old decks 1 for a vector and 2 for a grid; a real number here would be BIT of CBEAM,
    # a p-version element.
    if flag and flag not in {"1", "2", *(a + b + c for a in "GB" for b in "GO" for c in "GO")}:
        card.refuse(f"OFFT = '{flag}' is not supported; leave it blank or give GGG or BGG", 7)
    vector = orientation(card, grids, start, basic=flag.startswith("B"))
    return np.zeros(3) if vector is None else vector


def _between(card: Card, grids: Grids, grid_ends: tuple[int, int], vector: Vector) -> Matrix:
    """Axes (3, 3) from grid to grid, where offsets (O of OFFT) are along them; else basic ones."""
    if "O" not in card.text(7):
        return np.eye(3)
    return _axes(card, grids.nodes[grid_ends[1]] - grids.nodes[grid_ends[0]], vector)


def _axes(card: Card, axis: Vector, vector: Vector) -> Matrix:
    """Axes (3, 3) of a beam, which must have a length and a direction across it."""
    with np.errstate(over="ignore"):
        length = np.linalg.norm(axis)
    if not 0 < length < np.inf:
        card.refuse("the beam has no length; its two nodes coincide")
    axes = axes_along(axis, vector)
    if axes is None:
        card.refuse("the orientation vector is zero or parallel to the beam; give another one", 4)
    return axes


POINTS = (16, 17)


def read_warping(
    bulk: BulkData, sections: Mapping[int, Property], beams: Mapping[int, Beam]
) -> Iterator[Spring]:
    """Yield springs by which beams whose ends do not warp freely resist twist more than G J / L.

    The twist φ along the beam is cubic, φ' at the ends is the first component of SA and SB, and
    the energy is ∫ (G J φ'² + E C_w φ''²) dx / 2 (V. Z. Vlasov, Thin-walled elastic beams, 1961);
    what beams have of it themselves, G J / L, is taken off.
    """
    for card in bulk.cards.get("CBEAM", ()):
        if not any(card.text(field) for field in POINTS):
            continue
        beam = beams[card.integer(0)]
        resisting = sections[beam.property].warping
        if not resisting:
            continue
        start, end = (
            bulk.grids.nodes[node] for node in (bulk.grids.one(card, 2), bulk.grids.one(card, 3))
        )
        points = [_point(card, bulk.grids, field) for field in POINTS]
        length = float(np.linalg.norm(end - start))
        axis = (end - start) / length
        twist, bimoment = (np.array(rows) for rows in (_TWIST, _BIMOMENT))
        scale = np.diag([1.0, length, 1.0, length])
        twisting = beam.material.shear_modulus * beam.section.torsion
        bending = beam.material.youngs_modulus * resisting
        K = scale @ (twisting / length * twist + bending / length**3 * bimoment) @ scale
        T = np.zeros((4, 8))
        T[0, :3] = T[2, 4:7] = axis
        T[1, 3] = T[3, 7] = 1.0
        a, b = beam.nodes
        places = [(a, 3), (a, 4), (a, 5), (points[0], 0), (b, 3), (b, 4), (b, 5), (points[1], 0)]
        yield from springs_between(beam.id, places, T.T @ K @ T)


_TWIST = (
    *((0.2, 0.1, -0.2, 0.1), (0.1, 2 / 15, -0.1, -1 / 30)),
    *((-0.2, -0.1, 0.2, -0.1), (0.1, -1 / 30, -0.1, 2 / 15)),
)
"""∫ φ'² of cubic φ over the length, by φ and φ' L at both ends, without that of linear φ."""
_BIMOMENT = ((12, 6, -12, 6), (6, 4, -6, 2), (-12, -6, 12, -6), (6, 2, -6, 4))
"""∫ φ''² over the length."""


def _point(card: Card, grids: Grids, field: int) -> int:
    if not card.text(field):
        card.refuse(
            "a warping point at one end only is not supported; give SA and SB, or none", field
        )
    node = grids.one(card, field)
    if grids.systems.axes(node) is not None:
        card.refuse(
            "a warping point with a displacement system is not supported; use an SPOINT", field
        )
    return node
