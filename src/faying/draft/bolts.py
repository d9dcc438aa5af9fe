"""Bolts: beams and springs between bodies, and holes of several bodies on one axis."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Mask, Vector
from faying.assessment.strength.sizes import size_named, size_through
from faying.display.plane import ROUND
from faying.draft.cylinders import Cylinders
from faying.exceptions import ModelError
from faying.model.assembly import Assembly, Spring
from faying.model.clamping import check_clamping, element_seats
from faying.model.deck_bolt import bolt_axis_element
from faying.model.specs import BoltSpec
from faying.units import LENGTHS

PARALLEL = 1 - 1e-4
"""Least cosine of the angle between the axes of holes in line."""

ASIDE = 0.25
"""Largest distance between the axes of holes in line, over the smaller radius."""

ACROSS = np.sqrt(0.5)
"""Cosine between a spring and a face normal above which the spring crosses the interface."""

WASHER = 1.5
"""Radius of a washer over the radius of its hole. Holes of the same bolt differ by less, such as
a threaded and a clearance hole: a wider hole would let the washer through."""

DIAMETER = 0.9
"""Diameter of a bolt over the diameter of its hole, for holes of no standard size."""

MOST_CHAINS = 500
"""Number of beam chains above which they are taken for a frame rather than bolts."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """A chain of beams, or a spring, that clamps bodies together.

    Attributes
    ----------
    elements
        Element ids.
    spring
        Whether the line is a spring.
    """

    elements: tuple[int, ...]
    spring: bool


@dataclass(frozen=True, kw_only=True)
class Hole:
    """A hole through several bodies on one axis.

    Attributes
    ----------
    bodies
        Numbers of the bodies.
    ends : [length]
        Centres of both outer ends.
    radius : [length]
        Radius of the narrowest body's hole.
    filled
        Whether a shank of solids is inside.
    """

    bodies: tuple[int, ...]
    ends: tuple[tuple[float, float, float], tuple[float, float, float]]
    radius: float
    filled: bool


def clamping_lines(assembly: Assembly, normals: Sequence[Vector]) -> list[Line]:
    """Return the beam chains that clamp bodies, or single springs where there are none.

    The normals belong to faces of different bodies that face each other; springs along them may
    be bolts.
    """
    beams = [tuple(chain) for chain in _chains(assembly)]
    lines = [Line(elements=beam, spring=False) for beam in beams if _clamps(assembly, beam)]
    if lines or len(beams) > MOST_CHAINS:
        return lines
    springs = [(beam,) for beam in _lone_springs(assembly, normals)]
    return [
        Line(elements=beam, spring=True)
        for beam in springs
        if len(springs) <= MOST_CHAINS and _clamps(assembly, beam)
    ]


def _clamps(assembly: Assembly, elements: tuple[int, ...]) -> bool:
    """Return whether elements form a chain that clamps bodies."""
    spec = BoltSpec(name="bolt", elements=elements)
    try:
        seats = element_seats(assembly, bolt_axis_element(assembly, spec))
        check_clamping(assembly.mesh, spec, seats)
    except ModelError:
        return False
    return bool(len(seats[0]) and len(seats[1]))


def _chains(assembly: Assembly) -> list[list[int]]:
    """Return the ids of connected beams, chain by chain."""
    if not assembly.beams:
        return []
    ends = np.array([beam.nodes for beam in assembly.beams])
    nodes, columns = np.unique(ends, return_inverse=True)
    columns = columns.reshape(ends.shape)
    graph = sp.coo_array(
        (np.ones(len(ends)), (columns[:, 0], columns[:, 1])), shape=(len(nodes),) * 2
    )
    _, label = connected_components(graph.tocsr(), directed=False)
    chains: dict[int, list[int]] = defaultdict(list)
    for beam, chain in zip(assembly.beams, label[columns[:, 0]].tolist(), strict=True):
        chains[chain].append(beam.id)
    return list(chains.values())


def _lone_springs(assembly: Assembly, normals: Sequence[Vector]) -> list[int]:
    """Return the ids of springs across faces that share both nodes with no other spring."""
    between = defaultdict(list)
    for spring in assembly.springs:
        nodes = frozenset(node for node, _ in spring.ends)
        if len(nodes) == 2:
            between[nodes].append(spring)
    alone = [springs[0] for springs in between.values() if len(springs) == 1]
    return [lone.id for lone in alone if _across(lone, normals)]


def _across(spring: Spring, normals: Sequence[Vector]) -> bool:
    components = {component for _, component in spring.ends}
    along = [abs(normal[c]) for normal in normals for c in components if c < 3]
    return bool(max(along, default=0.0) > ACROSS)


def holes_in_line(cylinders: Cylinders) -> list[Hole]:
    """Return the holes that pass through at least two bodies on one axis.

    Notes
    -----
    All pairs of cylinders are compared.
    """
    holes = np.flatnonzero(cylinders.holes)
    if len(holes) < 2:
        return []
    sizes = cylinders.radii[holes]
    comparable = sizes[:, None] <= WASHER * sizes[None]
    linked = _in_line(cylinders, holes, holes) & comparable & comparable.T
    _, label = connected_components(sp.csr_array(linked), directed=False)
    lines = []
    for number in np.unique(label):  # bolts, of which there are few
        members = holes[label == number]
        if len(np.unique(cylinders.bodies[members])) > 1:
            lines.append(_hole(cylinders, members))
    return sorted(lines, key=lambda hole: (hole.radius, hole.ends))


def _in_line(cylinders: Cylinders, first: Indices, others: Indices) -> Mask:
    """Return which pairs of cylinders (n_first, n_other) share an axis and adjoin on it."""
    axes, points = cylinders.axes[first], cylinders.points[first]
    away = cylinders.points[others][None] - points[:, None]
    along = np.einsum("abd,ad->ab", away, axes)
    aside = np.linalg.norm(away - along[..., None] * axes[:, None], axis=2)
    radius = np.minimum(cylinders.radii[first][:, None], cylinders.radii[others][None])
    parallel = np.abs(axes @ cylinders.axes[others].T) > PARALLEL
    low, high = cylinders.spans[first].T
    other_low, other_high = cylinders.spans[others].T
    apart = np.maximum(
        along + other_low[None] - high[:, None], low[:, None] - along - other_high[None]
    )
    return np.asarray(parallel & (aside < ASIDE * radius) & (apart <= radius))


def _hole(cylinders: Cylinders, members: Indices) -> Hole:
    first = members[0]
    origin, axis = cylinders.points[first], cylinders.axes[first]
    along = (cylinders.points[members] - origin) @ axis
    low = float((along + cylinders.spans[members, 0]).min())
    high = float((along + cylinders.spans[members, 1]).max())
    inside = np.flatnonzero(~cylinders.holes)
    shank = _in_line(cylinders, members, inside).any(axis=0)
    shank &= cylinders.radii[inside] <= cylinders.radii[members].min() * (1 + ROUND)
    ends = [tuple((origin + position * axis).tolist()) for position in (low, high)]
    return Hole(
        bodies=tuple(np.unique(cylinders.bodies[members]).tolist()),
        ends=(ends[0], ends[1]),
        radius=float(cylinders.radii[members].min()),
        filled=bool(shank.any()),
    )


def size_of(hole: Hole, units: str) -> str | None:
    """Return the bolt size of a clearance hole; None where no standard size fits."""
    metre = LENGTHS.get(units.split("-")[0])
    return None if metre is None else size_through(2 * hole.radius * metre)


def bolt_diameter(hole: Hole, units: str) -> float:
    """Return the diameter [length] of the bolt in a hole."""
    size = size_of(hole, units)
    if size is None:
        return DIAMETER * 2 * hole.radius
    return size_named(size).diameter / LENGTHS[units.split("-")[0]]


def pattern(holes: list[Hole]) -> list[Hole]:
    """Return the likely bolt holes: the most frequent size, the smallest where several tie.

    A flange has many bolts and one bore.
    """
    groups: list[list[Hole]] = []
    for hole in holes:
        if groups and hole.radius <= groups[-1][0].radius * (1 + ROUND):
            groups[-1].append(hole)
        else:
            groups.append([hole])
    return max(groups, key=len, default=[])
