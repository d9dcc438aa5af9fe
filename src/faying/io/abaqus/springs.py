"""``*SPRING``, ``*MASS`` and ``*ROTARY INERTIA``: linear springs, concentrated masses."""

from collections.abc import Iterator, Sequence

import numpy as np

from faying._typing import Matrix
from faying.digits import DECK_DIGITS
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import component
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.fields import check_count, only_line, padded, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets, assign
from faying.model.assembly import Bush, PointMass, Spring
from faying.model.axes import any_across, axes_along


def read_springs(
    deck: Deck, elements: Elements, sets: NamedSets, coordinates: Matrix
) -> tuple[tuple[Spring, ...], tuple[Bush, ...]]:
    """Read SPRING1, SPRING2 and SPRINGA; those off the coordinate axes are bushes."""
    stiffness: dict[int, Keyword] = {}
    for keyword in deck.of("SPRING"):
        keyword.check()
        assign(stiffness, keyword, sets, keyword)
    springs: list[Spring] = []
    bushes: list[Bush] = []
    for block in elements.of("SPRING1", "SPRING2", "SPRINGA"):
        for i in range(len(block.ids)):
            spring = _spring(block, i, block.section(i, stiffness, "SPRING"), coordinates)
            if isinstance(spring, Bush):
                bushes.append(spring)
            else:
                springs.append(spring)
    return tuple(springs), tuple(bushes)


def _spring(block: ElementBlock, i: int, keyword: Keyword, coordinates: Matrix) -> Spring | Bush:
    rows = keyword.rows()
    if len(rows) != 2 and not (block.type == "SPRINGA" and len(rows) == 1):
        keyword.refuse(
            f"found {len(rows)} data lines, expected the degrees of freedom (blank for SPRINGA) "
            "and one stiffness; nonlinear springs are not supported"
        )
    value = real(keyword, len(rows) - 1, rows[-1][0], "a stiffness")
    if any(rows[-1][1:]):
        keyword.refuse(
            "a stiffness that depends on frequency or temperature is not supported", len(rows) - 1
        )
    nodes = block.nodes[i].tolist()
    if block.type == "SPRINGA":
        axis = _axis(block, i, coordinates)
        if axis is None:
            return _inclined(block, i, value, coordinates)
        components = [axis] * 2
    else:
        check_count(keyword, 0, rows[0], (len(nodes),), f"{len(nodes)} degrees of freedom")
        components = [component(keyword, 0, text) for text in rows[0]]
    ends = tuple(zip(nodes, components, strict=True))
    return Spring(id=int(block.ids[i]), ends=ends, stiffness=value)


def _axis(block: ElementBlock, i: int, coordinates: Matrix) -> int | None:
    """Component of an axial spring parallel to a coordinate axis; None for any other."""
    apart = coordinates[block.nodes[i, 1]] - coordinates[block.nodes[i, 0]]
    if not apart.any():
        block.keyword.refuse(
            f"SPRINGA {block.ids[i]} has no direction, for its nodes coincide; use SPRING2",
            int(block.rows[i]),
        )
    component = int(np.abs(apart).argmax())
    others = np.delete(np.abs(apart), component)
    return component if others.max() <= DECK_DIGITS * abs(apart[component]) else None


def _inclined(block: ElementBlock, i: int, stiffness: float, coordinates: Matrix) -> Bush:
    """Return an axial spring along the line between its nodes."""
    start, end = block.nodes[i].tolist()
    along = coordinates[end] - coordinates[start]
    side = np.cross(along, any_across(along))
    first, second, third = (
        (float(row[0]), float(row[1]), float(row[2])) for row in np.asarray(axes_along(along, side))
    )
    x, y, z = coordinates[start].tolist()
    return Bush(
        id=int(block.ids[i]),
        nodes=(start, end),
        stiffness=(stiffness, 0.0, 0.0, 0.0, 0.0, 0.0),
        axes=(first, second, third),
        place=(x, y, z),
    )


Tensor = tuple[tuple[float, float, float], ...]


def read_masses(deck: Deck, elements: Elements, sets: NamedSets) -> Iterator[PointMass]:
    """Read MASS and ROTARYI elements."""
    values: dict[int, float] = {}
    inertias: dict[int, Tensor] = {}
    for keyword in deck.of("MASS", "ROTARY INERTIA"):
        keyword.check()
        if keyword.name == "MASS":
            assign(values, keyword, sets, _mass(keyword))
        else:
            assign(inertias, keyword, sets, _inertia(keyword))
    for block in elements.of("MASS", "ROTARYI"):
        for i, (number, node) in enumerate(zip(block.ids.tolist(), block.nodes[:, 0], strict=True)):
            if block.type == "MASS":
                mass = block.section(i, values, "MASS")
                yield PointMass(id=number, node=int(node), mass=mass)
            else:
                inertia = block.section(i, inertias, "ROTARY INERTIA")
                yield PointMass(id=number, node=int(node), mass=0.0, inertia=inertia)


def _mass(keyword: Keyword) -> float:
    (text,) = only_line(keyword, (1,), "one mass")
    value = real(keyword, 0, text, "a mass")
    if value < 0:
        keyword.refuse(f"the mass is {value:g}; it must not be negative", 0)
    return value


def _inertia(keyword: Keyword) -> Tensor:
    fields = only_line(keyword, range(3, 7), "I11, I22, I33, I12, I13, I23")
    xx, yy, zz, xy, xz, yz = padded(keyword, 0, fields, 6, "an inertia")
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    turned = keyword.scope.rotation @ tensor @ keyword.scope.rotation.T
    if np.linalg.eigvalsh(tensor).min() < 0:
        keyword.refuse("the inertia has a negative principal value; check its signs", 0)
    first, second, third = ((float(a), float(b), float(c)) for a, b, c in turned)
    return (first, second, third)


_VIBRATIONS = ("FREQUENCY", "COMPLEX FREQUENCY", "DYNAMIC", "MODAL DYNAMIC")
_INCOMPATIBLE = (
    "C3D8I: incompatible modes have no mass here; in CalculiX they have, and frequencies of "
    "bending are lower: by 2 % at 12 elements to a wave, 7 % at 7, 16 % at 5"
)
_SCALED = (
    "time step on *FREQUENCY: CalculiX adds mass to the elements that would need a smaller one "
    "(selective mass scaling) and finds lower frequencies; masses are those of the densities here"
)
_TIME_STEP = 3
"""Field of *FREQUENCY behind the number of frequencies and their bounds."""


def note_masses(deck: Deck, solids: Sequence[ElementBlock]) -> None:
    """Say which masses differ, in decks that ask for vibrations."""
    if not any(deck.of(name) for name in _VIBRATIONS):
        return
    if any(block.type == "C3D8I" for block in solids):
        deck.ignored.append(_INCOMPATIBLE)
    rows = [row for keyword in deck.of("FREQUENCY") for row in keyword.rows()[:1]]
    if any(len(row) > _TIME_STEP and row[_TIME_STEP] for row in rows):
        deck.ignored.append(_SCALED)
