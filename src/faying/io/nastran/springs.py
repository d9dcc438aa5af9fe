"""CELAS, CMASS, GENEL, CONM1 and CONM2: springs and masses at single components, point masses."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS, ROUND_OFF, SOLVED
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, Cards, property_of
from faying.io.nastran.fields import components
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.rigid_elements import rigid_motions
from faying.model.assembly import Assembly, Bush, PointMass, ScalarMass, Spring
from faying.model.boundary import DISPLACEMENT_NAMES

Place = tuple[int, int]


def read_general_elements(bulk: BulkData) -> Iterator[Spring]:
    """Yield springs that represent the stiffness of GENEL, some with negative stiffness.

    MSC Nastran Quick Reference Guide, GENEL: forces at u_i are K (u_i - S u_d), with K given or
    the inverse of Z, and S given or that of a rigid body. A symmetric matrix is a spring of -K_ij
    between each two components, and a spring of the sum of a row from each component to ground.
    """
    for card in bulk.cards.get("GENEL", ()):
        yield from springs_between(card.integer(0), *_stiffness(card, bulk.grids))


def springs_between(number: int, places: Sequence[Place], K: Matrix) -> Iterator[Spring]:
    """Yield springs that represent a symmetric stiffness matrix between components."""
    for i, j in np.argwhere(np.triu(K, 1)).tolist():
        yield Spring(id=number, ends=(places[i], places[j]), stiffness=-float(K[i, j]))
    ground = K.sum(axis=1)
    # Forces of a rigid motion are rounding of sums.
    for k in np.flatnonzero(np.abs(ground) > ROUND_OFF * np.abs(K).sum(axis=1)).tolist():
        yield Spring(id=number, ends=(places[k],), stiffness=float(ground[k]))


def _stiffness(card: Card, grids: Grids) -> tuple[list[Place], Matrix]:
    parts = _parts(card)
    free, dependent = (_places(card, parts.get(name, []), grids) for name in ("UI", "UD"))
    n = len(free)
    letter = "K" if "K" in parts else "Z"
    square = np.zeros((n, n))
    square[np.triu_indices(n)] = _reals(card, parts.get(letter, []), n * (n + 1) // 2, letter)
    square = square + np.triu(square, 1).T
    try:
        K = square if letter == "K" else np.linalg.inv(square)
        S = _following(card, parts, free, dependent, grids)
    except np.linalg.LinAlgError as error:
        text = f"its {letter}, or the rigid motion of its UD, cannot be inverted"
        raise card.error(text) from error
    both = np.hstack([np.eye(n), -S])
    return [*free, *dependent], np.asarray(both.T @ K @ both, dtype=np.float64)


def _following(
    card: Card,
    parts: Mapping[str, list[str]],
    free: Sequence[Place],
    dependent: Sequence[Place],
    grids: Grids,
) -> Matrix:
    """Return S (n_free, n_held)."""
    if not dependent:
        return np.zeros((len(free), 0))
    if "S" in parts:
        values = _reals(card, parts["S"], len(free) * len(dependent), "S")
        return values.reshape(len(free), len(dependent))
    if len(dependent) != 6:
        card.refuse(
            f"{len(dependent)} components in UD and no S; six make a rigid body, else give S"
        )
    origin = grids.nodes[dependent[0][0]]
    following, leading = (rigid_motions(places, grids, origin) for places in (free, dependent))
    return np.asarray(np.linalg.solve(leading.T, following.T).T)


def _parts(card: Card) -> dict[str, list[str]]:
    """Return the texts of UI (a word not written), UD, K or Z, and S."""
    parts: dict[str, list[str]] = {"UI": [card.text(j) for j in range(2, min(len(card), 8))]}
    name = "UI"
    for first in range(8, len(card), 8):
        texts = [card.text(first + j) for j in range(8)]
        if texts[0] in ("UD", "K", "Z", "S"):
            name, texts = texts[0], texts[1:]
        parts.setdefault(name, []).extend(texts)
    return parts


def _places(card: Card, texts: list[str], grids: Grids) -> list[Place]:
    filled = [text for text in texts if text]
    places = []
    for grid, digit in zip(filled[::2], filled[1::2], strict=False):
        number = numbers.integer(grid)
        (node,) = grids.several(card, [-1 if number is None else number]).tolist()
        chosen = (0,) if digit == "0" else components(digit, card.error)
        if grids.systems.axes(node) is not None or len(chosen) != 1:
            card.refuse(
                f"GRID {grid} with components '{digit}': one component each, of grids without a "
                "displacement system, is supported"
            )
        places.append((node, chosen[0]))
    return places


def _reals(card: Card, texts: list[str], count: int, name: str) -> Matrix:
    filled = [text for text in texts if text]
    values = [numbers.real(text) for text in filled]
    if len(values) != count or None in values:
        card.refuse(f"{name} has {len(values)} numbers; expected {count} for its components")
    return np.array(values, dtype=float)


class _End(NamedTuple):
    """A node, a component, and the directions (3, 3) of its displacement system."""

    node: int
    component: int
    axes: Matrix

    @property
    def direction(self) -> Vector:
        """Direction (3,) along or about which the component acts."""
        return np.asarray(self.axes[self.component % 3])

    @property
    def basic(self) -> tuple[int, int]:
        """Basic component and its sign, 1 or -1; sign 0 if the axis is not a basic axis."""
        along = int(np.abs(self.direction).argmax())
        inclined = float(np.sort(np.abs(self.direction))[1]) > DECK_DIGITS
        sign = 0 if inclined else int(np.sign(self.direction[along]))
        return along + 3 * (self.component // 3), sign


def read_springs(bulk: BulkData) -> tuple[list[Spring], list[Bush]]:
    """Read springs; an end whose grid is blank or 0 is grounded.

    Springs along axes of displacement systems other than basic axes become bushes.
    """
    if any(card.text(6) for card in bulk.cards.get("CELAS2", ())):
        bulk.ignored.append("structural damping GE of CELAS2")
    springs, bushes = list[Spring](), list[Bush]()
    for card, value in _valued(bulk.cards, "CELAS", "PELAS"):
        ends = _ends(card, bulk.grids)
        if all(end.basic[1] for end in ends):
            places = _places_of(card, ends, bulk.grids)
            springs.append(Spring(id=card.integer(0), ends=places, stiffness=value))
        else:
            bushes.append(_turned(card, value, ends, bulk.grids))
    return springs, bushes


def _turned(card: Card, stiffness: float, ends: Sequence[_End], grids: Grids) -> Bush:
    """Return a bush for a spring along an axis that is not a basic axis.

    Its ends are at one point and act along one direction, or one of them is the ground.
    """
    nodes, components = [end.node for end in ends], {end.component for end in ends}
    places, directions = grids.nodes[nodes], np.array([end.direction for end in ends])
    apart = np.ptp(places, axis=0).max() > DECK_DIGITS * np.abs(grids.nodes).max()
    across = np.ptp(directions, axis=0).max() > DECK_DIGITS
    if apart or across or len(components) > 1 or len(set(nodes)) < len(nodes):
        card.refuse(
            f"GRID {grids.ids[nodes[0]]} has a displacement coordinate system whose axis is not a "
            "basic axis; such a spring leads to the ground, or to a grid at the same place with "
            "the same axes; use a CBUSH"
        )
    along = {ends[0].component: stiffness}
    return Bush.of_arrays(card.integer(0), nodes, along, ends[0].axes, places[0])


def read_scalar_masses(bulk: BulkData) -> list[ScalarMass]:
    """Read scalar masses at a component or on the difference of two."""
    masses = []
    for card, value in _valued(bulk.cards, "CMASS", "PMASS"):
        places = _places_of(card, _ends(card, bulk.grids), bulk.grids)
        mass = value * bulk.mass_factor
        masses.append(ScalarMass(id=card.integer(0), ends=places, mass=mass))
    return masses


def _valued(
    cards: Mapping[str, Cards], family: str, property_name: str
) -> list[tuple[Card, float]]:
    """Return elements of a family and their values; kinds 1 and 3 take them from a property."""
    properties = _properties(cards, property_name)

    return [
        (card, property_of(card, properties, property_name) if kind in "13" else card.real(1))
        for kind in "1234"
        for card in cards.get(f"{family}{kind}", ())
    ]


def _properties(cards: Mapping[str, Cards], name: str) -> dict[int, float]:
    # PELAS has two properties of four fields, PMASS four of two.
    size = 4 if name == "PELAS" else 2
    stiffnesses: dict[int, float] = {}
    for fields in (group for card in cards.get(name, ()) for group in card.groups(0, size)):
        number = fields.integer(0)
        if number in stiffnesses:
            fields.refuse(f"property {number} is defined twice; renumber one")
        stiffnesses[number] = fields.real(1)
    return stiffnesses


def _ends(card: Card, grids: Grids) -> list[_End]:
    """Return the ends that are not grounded."""
    ends: list[_End] = []
    # Kinds 3 and 4 join scalar points, which have no components.
    scalar = card.cards.name[-1] in "34"
    for field in (2, 3) if scalar else (2, 4):
        if card.integer(field, 0) == 0:
            continue
        node = grids.one(card, field)
        digits = "" if scalar else card.text(field + 1)
        chosen = grids.components(np.array([node]), digits, card.error)
        if len(chosen) != 1:
            card.refuse(f"a spring or mass acts on one component; found '{digits}'", field + 1)
        ends.append(_End(node, chosen[0], grids.systems.axes_of(np.array([node]))[0]))
    return ends


def _places_of(card: Card, ends: Sequence[_End], grids: Grids) -> tuple[Place, ...]:
    """Return nodes and basic components of ends that act along basic axes."""
    basic = [end.basic for end in ends]
    for end in (end for end in ends if end.basic[1] == 0):
        card.refuse(
            f"GRID {grids.ids[end.node]} has a displacement coordinate system whose axis is not a "
            "basic axis; masses of one direction in such systems are not supported, use a CONM2"
        )
    places = [(end.node, component) for end, (component, _) in zip(ends, basic, strict=True)]
    if not ends or len({sign for _, sign in basic}) > 1 or len(set(places)) < len(places):
        card.refuse(
            "a spring or mass needs two different ends, or one and the ground, with the same "
            "direction (check grids, components and displacement coordinate systems)"
        )
    return tuple(places)


def read_masses(bulk: BulkData) -> list[PointMass]:
    """Read concentrated masses, with inertias in the basic frame."""
    return [
        read(card, bulk.grids, bulk.mass_factor)
        for name, read in (("CONM1", _matrix), ("CONM2", _mass))
        for card in bulk.cards.get(name, ())
    ]


def _matrix(card: Card, grids: Grids, factor: float) -> PointMass:
    """Read CONM1 whose matrix is that of a mass with inertia about its grid."""
    values = [card.real(j, 0.0) for j in range(3, 24)]
    matrix = np.zeros((6, 6))
    matrix[np.tril_indices(6)] = values
    mass = matrix[0, 0]
    if not mass >= 0 or (matrix[3:, :3] != 0).any() or (matrix[:3, :3] != mass * np.eye(3)).any():
        card.refuse(
            "masses that differ between directions, or that couple translations and rotations, are "
            "not supported; use CONM2, or CMASS2 for single components",
            3,
        )
    inertia = matrix[3:, 3:] + np.tril(matrix[3:, 3:], -1).T
    axes = _axes(card, grids, grids.one(card, 1))
    a, b, c = (tuple(row) for row in (factor * axes.T @ inertia @ axes + 0.0).tolist())
    return PointMass(
        id=card.integer(0), node=grids.one(card, 1), mass=mass * factor, inertia=(a, b, c)
    )


def _axes(card: Card, grids: Grids, node: int) -> Matrix:
    if card.integer(2, 0) <= 0:
        return np.eye(3)
    return np.asarray(grids.systems.frame_of(card, 2).directions(grids.nodes[node][None])[0])


def _mass(card: Card, grids: Grids, factor: float) -> PointMass:
    system = card.integer(2, 0)
    node = grids.one(card, 1)
    offset = card.reals((4, 5, 6), 0.0)
    if system == -1:
        offset = offset - grids.nodes[node]
        if np.abs(offset).max() <= SOLVED * max(float(np.abs(grids.nodes[node]).max()), 1.0):
            offset = np.zeros(3)
    # Off-diagonal fields are ∫ x y dm; in the inertia tensor they have a minus sign.
    i11, i21, i22, i31, i32, i33 = (card.real(j, 0.0) for j in range(8, 14))
    inertia = np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
    axes = _axes(card, grids, node)
    inertia, offset = axes.T @ inertia @ axes, offset @ axes
    # Adding zero turns -0.0 into 0.0.
    rows = tuple(tuple(row) for row in (factor * inertia + 0.0).tolist())
    x, y, z = (offset + 0.0).tolist()
    return PointMass(
        id=card.integer(0),
        node=node,
        mass=card.real(3) * factor,
        inertia=rows,
        offset=(x, y, z),
    )


def without_rotation(
    masses: Sequence[PointMass], assembly: Assembly, ignored: list[str]
) -> tuple[PointMass, ...]:
    """Remove inertia and offsets of masses at nodes without rotational stiffness.

    Nastran holds such rotations (PARAM,AUTOSPC), so the mass only translates with its node. The
    assembly must not have the masses yet.
    """
    turning = [item for item in masses if np.any(item.inertia) or any(item.offset)]
    if not turning:
        return tuple(masses)
    first_rotation = DISPLACEMENT_NAMES.index("rx")
    resisted = np.zeros(len(assembly.mesh.nodes), dtype=bool)
    for block in assembly.shells:
        resisted[block.nodes] = True
    for rigid in assembly.rigid_couplings:
        resisted[rigid.nodes] |= max(rigid.components) >= first_rotation
    resisted[[item.reference for item in assembly.rigid_couplings]] = True
    resisted[[item.reference for item in assembly.average_couplings]] = True
    ends = [item.nodes for item in assembly.beams] + [item.nodes for item in assembly.bushes]
    resisted[[node for nodes in ends for node in nodes]] = True
    places = [dof for spring in assembly.springs for dof in spring.ends]
    places += [(node, c) for item in assembly.equations for node, c, _ in item.terms]
    resisted[[node for node, c in places if c >= first_rotation]] = True
    loose = {item.id for item in turning if not resisted[item.node]}
    if loose:
        ignored.append(
            f"inertia and offset of {len(loose)} CONM1 or CONM2 at grids without rotational "
            "stiffness, whose rotation Nastran holds (AUTOSPC)"
        )
    return tuple(
        PointMass(id=item.id, node=item.node, mass=item.mass) if item.id in loose else item
        for item in masses
    )
