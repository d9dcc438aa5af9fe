"""CBAR, CBEAM, CROD, CTUBE, CONROD: beams and rods; BAROR, BEAMOR: values of blank fields.

MSC Nastran Quick Reference Guide, CBAR: offset vectors point from the grids to the ends, along the
displacement components of the grids, or (O of OFFT) along the axes of an element between the grids;
pin flags are the components of the element (x along it, y towards the orientation vector) in which
an end is not connected to its grid.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.digits import SHORT_DIGITS
from faying.exceptions import FormatError
from faying.io.nastran import fields as numbers
from faying.io.nastran.bushes import element_axes, orientation
from faying.io.nastran.cards import Card, by_id, property_of, single
from faying.io.nastran.fields import components
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.sections import Property, turned_about, with_shear
from faying.io.nastran.springs import springs_between
from faying.model.assembly import Beam, BeamSection, Equation, Material, RigidCoupling, Spring
from faying.model.axes import any_across

PINS = (8, 9)
OFFSETS = (10, 13)


@dataclass(kw_only=True)
class BeamEnds:
    """New nodes at beam ends with offsets or pins, and their connections to nodes of the deck.

    Attributes
    ----------
    first
        Index of the first new node.
    grids
        Node of the deck that each new node belongs to.
    """

    first: int
    places: list[Vector] = field(default_factory=list)
    couplings: list[RigidCoupling] = field(default_factory=list)
    equations: list[Equation] = field(default_factory=list)
    grids: list[int] = field(default_factory=list)

    @property
    def nodes(self) -> Matrix:
        """Coordinates (n, 3) of the new nodes."""
        return np.array(self.places, dtype=float).reshape(-1, 3)

    def offset(
        self, card: Card, grids: Grids, end: int, node: int, along: Matrix
    ) -> tuple[int, Vector]:
        """Return the node of an end (0 or 1) and its coordinates; a new node if it has an offset.

        ``along`` (3, 3) are the axes of the element between its grids, for offsets along
        them.
        """
        vector = np.array([card.real(OFFSETS[end] + j, 0.0) for j in range(3)])
        position = grids.nodes[node]
        if not vector.any():
            return node, position
        of_element = card.text(7)[1 + end : 2 + end] == "O"
        axes = along if of_element else grids.systems.axes(node)
        position = position + (vector if axes is None else vector @ axes)
        if not np.isfinite(position).all():
            card.refuse("the offset is too large for a number", OFFSETS[end])
        new = self._added(position, node)
        coupling = RigidCoupling(
            id=card.integer(0), reference=node, nodes=np.array([new]), components=tuple(range(6))
        )
        self.couplings.append(coupling)
        return new, position

    def pinned(
        self, card: Card, nodes: tuple[int, int], places: tuple[Vector, Vector], axes: Matrix
    ) -> tuple[int, int]:
        """Return the nodes of a beam, new ones where an end has pins.

        A component along or about the element that is free at both ends carries nothing; it is
        kept at the second end, so that the element has no rigid motion of its own.
        """
        first, second = (_released(card, field) for field in PINS)
        released = [c for c in second if not (c in first and c in (0, 3))]
        a = self._hinge(card, nodes[0], places[0], first, axes)
        return a, self._hinge(card, nodes[1], places[1], released, axes)

    def _hinge(
        self, card: Card, node: int, position: Vector, released: list[int], axes: Matrix
    ) -> int:
        if not released:
            return node
        new = self._added(position, node)
        for first in (0, 3):
            rows = np.eye(3)
            if any(first <= c < first + 3 for c in released):
                rows = axes[[c for c in range(3) if first + c not in released]]
            for row in rows:
                terms = []
                for c in np.argsort(-np.abs(row), kind="stable").tolist():
                    if row[c] != 0.0:
                        factor = float(row[c])
                        terms += [(new, first + c, factor), (node, first + c, -factor)]
                self.equations.append(Equation(id=card.integer(0), terms=tuple(terms)))
        return new

    def _added(self, position: Vector, node: int) -> int:
        self.places.append(position)
        self.grids.append(node if node < self.first else self.grids[node - self.first])
        return self.first + len(self.places) - 1

    def ids_behind(self, ids: Indices) -> Indices:
        """Return ids (n,) of the new nodes, above all others."""
        return int(ids.max(initial=0)) + 1 + np.arange(len(self.places))


def _released(card: Card, field: int) -> list[int]:
    """Return the components 0..5 of a pin flag, none where it is blank or 0."""
    text = card.text(field)
    if text in ("", "0"):
        return []

    def wrong(said: str) -> FormatError:
        return card.error(f"pin flag: {said}", field)

    return list(components(text, wrong))


def read_beams(
    bulk: BulkData, sections: Mapping[str, Mapping[int, Property]], ends: BeamEnds
) -> list[Beam]:
    """Read beams, with orientation vectors in the basic frame.

    Nodes of beams with offsets or pins are added to ``ends``.
    """
    beams: list[Beam] = []
    for name in ("CBAR", "CBEAM"):
        default = single(bulk.cards, {"CBAR": "BAROR", "CBEAM": "BEAMOR"}[name])
        if default is not None:
            default.refuse_given([0, 2, 3])
        beams += [
            _beam(_filled(card, default), bulk.grids, sections[name], ends)
            for card in bulk.cards.get(name, ())
        ]
    return beams


def _filled(card: Card, default: Card | None) -> Card:
    """Take property, orientation and OFFT from the default where the beam leaves them blank."""
    if default is None:
        return card
    texts = [*card.texts, *[""] * (8 - len(card))]
    orientation = [text for text in texts[4:7] if text]
    is_grid = len(orientation) == 1 and bool(texts[4]) and numbers.integer(texts[4]) is not None
    if orientation and not is_grid and len(orientation) < 3 and any(default.texts[4:7]):
        card.refuse(f"give all of X1, X2, X3: {default.where()} fills the blank ones", 4)
    for j in (1, *(() if orientation else (4, 5, 6)), 7):
        texts[j] = texts[j] or default.text(j)
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
    axes = element_axes(card, to - origin, vector)
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
    """Return element axes (3, 3) for offsets along them (O of OFFT), else basic axes."""
    if "O" not in card.text(7):
        return np.eye(3)
    return element_axes(card, grids.nodes[grid_ends[1]] - grids.nodes[grid_ends[0]], vector)


POINTS = (16, 17)


def read_warping(
    bulk: BulkData, sections: Mapping[int, Property], beams: Mapping[int, Beam]
) -> Iterator[Spring]:
    """Yield springs for the twist stiffness beyond G J / L of beams with restrained warping.

    The twist φ along the beam is cubic, φ' at the ends is the first component of SA and SB, and
    the energy is ∫ (G J φ'² + E C_w φ''²) dx / 2 (V. Z. Vlasov, Thin-walled elastic beams, 1961);
    the stiffness G J / L of the beams themselves is subtracted.
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
"""∫ φ'² of cubic φ by φ and φ' L at both ends, minus ∫ φ'² of linear φ, over unit length."""
_BIMOMENT = ((12, 6, -12, 6), (6, 4, -6, 2), (-12, -6, 12, -6), (6, 2, -6, 4))
"""∫ φ''² of the same."""


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


Member = tuple[BeamSection, Material]


def read_rods(bulk: BulkData) -> list[Beam]:
    """Read rods as beams without bending stiffness, with the mass along a straight line.

    Non-structural mass is added to the density.
    """
    rods: list[Beam] = []
    for name, family in (("CROD", "PROD"), ("CTUBE", "PTUBE"), ("CONROD", "CONROD")):
        members = {
            number: _member(card, bulk)
            for number, card in by_id(bulk.cards, family, what="property").items()
        }
        for card in bulk.cards.get(name, ()):
            number = card.integer(0 if name == family else 1, card.integer(0))
            member = card.find(members, 1, "property", family, number)
            rods.append(_rod(card, bulk.grids, member, 0 if name == family else number))
    return rods


def _member(card: Card, bulk: BulkData) -> Member:
    """Return section and material of PROD, PTUBE or CONROD; C is for stresses only."""
    material, factor = bulk.material(card, card.place("MID"))
    if card.cards.name == "PTUBE":
        area, torsion = _tube(card)
    else:
        area, torsion = card.real(card.place("A")), card.real(card.place("J"), 0.0)
    section = BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=torsion)
    line_mass = card.real(card.place("NSM"), 0.0) * bulk.mass_factor
    heavy = replace(material, density=material.density + line_mass / area)
    return with_shear(section, factor), heavy


def _tube(card: Card) -> tuple[float, float]:
    """Return area and torsion constant of a tube; without a wall thickness it is a solid rod."""
    outer = card.real(2)
    wall = card.real(3, 0.0) or outer / 2
    end = card.real(5, outer)
    if wall > outer / 2:
        card.refuse(f"OD = {outer:g} with T = {wall:g} is not a tube; T is at most half of OD", 3)
    if not math.isclose(end, outer, rel_tol=SHORT_DIGITS):
        card.refuse(
            f"OD2 = {end:g} differs from OD = {outer:g}; divide the tube into constant pieces", 5
        )
    inner = outer - 2 * wall
    area = math.pi / 4 * (outer**2 - inner**2)
    return area, math.pi / 32 * (outer**4 - inner**4)


def _rod(card: Card, grids: Grids, member: Member, number: int) -> Beam:
    start, end = (grids.one(card, card.place(name)) for name in ("G1", "G2"))
    axis = np.abs(grids.nodes[end] - grids.nodes[start])
    if not 0 < float(np.linalg.norm(axis)) < math.inf:
        card.refuse("the rod has no length; its two nodes coincide")
    return Beam(
        id=card.integer(0),
        nodes=(start, end),
        section=member[0],
        material=member[1],
        orientation=any_across(axis),
        property=number,
    )
