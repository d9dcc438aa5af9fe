"""Beams, trusses, springs and masses."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from faying._typing import Matrix
from faying.digits import DECK_DIGITS
from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import DeckData, component
from faying.io.abaqus.fields import Line, lines, only_line, parameter
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.mesh import ElementBlock
from faying.io.abaqus.sets import section_numbers
from faying.io.abaqus.solid_sections import find_isotropic
from faying.model.assembly import Beam, BeamSection, Bush, Material, PointMass, Spring
from faying.model.axes import any_across, axes_along, rectangular_section, round_section

TYPES = ("B31", "B31R", "B33", "B32", "B32R")

Direction = tuple[float, float, float]


def read_beams(data: DeckData, materials: Mapping[str, Material]) -> Iterator[Beam]:
    """Yield the beams of a deck; a three-node beam becomes two beams.

    The second half of a three-node beam gets the id of the beam, the first half a new one.
    """
    deck, elements = data.deck, data.elements
    blocks = elements.of(*TYPES)
    if not blocks:
        return
    keywords = deck.of("BEAM SECTION", "BEAM GENERAL SECTION")
    first = len(deck.of("SOLID SECTION")) + 1
    sections = [_beam(keyword, n, materials) for n, keyword in enumerate(keywords, start=first)]
    numbers = section_numbers("BEAM SECTION", keywords, blocks, data.element_sets, deck.ignored)
    for keyword in deck.of("TRANSVERSE SHEAR STIFFNESS"):
        keyword.refuse("it is not supported; remove it, and use B33 for beams rigid in shear")
    deck.ignored.extend(
        f"{name}: read as beams that are exact for end loads"
        for name in sorted({block.type for block in blocks} - {"B33"})
    )
    halves = max((int(block.ids.max(initial=0)) for block in elements.blocks), default=0) + 1
    for block, of_block in zip(blocks, numbers, strict=True):
        for i, element_id in enumerate(block.ids.tolist()):
            ends = block.nodes[i].tolist()
            for start, end in pairwise(ends):
                last = end == ends[-1]
                section = sections[of_block[i]]
                if block.type == "B33":
                    rigid = replace(section.section, shear_factor_y=np.inf, shear_factor_z=np.inf)
                    section = replace(section, section=rigid)
                yield replace(section, id=element_id if last else halves, nodes=(start, end))
                halves += not last


def _beam(keyword: Keyword, number: int, materials: Mapping[str, Material]) -> Beam:
    """Return a beam with the section of a keyword, without nodes."""
    rows = lines(keyword)
    if keyword.name == "BEAM SECTION":
        material = find_isotropic(materials, keyword)
        section = _profile(keyword, rows[:1], material.poissons_ratio)
    else:
        section, material = _general(keyword, rows)
    return Beam(
        id=0,
        nodes=(0, 0),
        section=section,
        material=material,
        orientation=_direction(rows[1:]),
        property=number,
    )


def _measures(keyword: Keyword, first: list[Line], counts: tuple[int, ...]) -> list[float]:
    if not first or len(first[0]) not in counts:
        shown = " or ".join(map(str, counts))
        keyword.refuse(
            f"expected {shown} measures of the section on the first data line", 0 if first else None
        )
    return [first[0].positive(column, "a measure") for column in range(len(first[0]))]


def _profile(keyword: Keyword, first: list[Line], poisson: float) -> BeamSection:
    """Return the section of a circle, pipe or rectangle; the first local axis n1 is y here."""
    kind = keyword.choice("SECTION")
    if kind not in ("CIRC", "PIPE", "RECT"):
        shapes = "CIRC, PIPE, RECT, or *BEAM GENERAL SECTION"
        keyword.refuse(f"SECTION={kind} is not supported; give {shapes}")
    if kind == "RECT":
        width, height = _measures(keyword, first, (2,))
        return rectangular_section(width, height, _rectangle_torsion(width, height), poisson)
    radius, *others = _measures(keyword, first, (2,) if kind == "PIPE" else (1, 2))
    if kind == "CIRC" and others not in ([], [radius]):
        keyword.refuse("an elliptic section is not supported; give one radius", 0)
    inner = radius - others[0] if kind == "PIPE" else 0.0
    if kind == "PIPE" and inner <= 0:
        keyword.refuse(f"the wall {others[0]:g} is not thinner than the radius {radius:g}", 0)
    return round_section(radius, inner, poisson)


def _rectangle_torsion(width: float, height: float) -> float:
    """Return the torsion constant of a rectangle (Timoshenko, Goodier: Theory of Elasticity, §109).

    Three terms of the series have an error of 1e-6.
    """
    long, short = max(width, height), min(width, height)
    odd = np.arange(1, 12, 2)
    series = np.sum(np.tanh(odd * np.pi * long / (2 * short)) / odd**5)
    return float(long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series))


def _general(keyword: Keyword, rows: list[Line]) -> tuple[BeamSection, Material]:
    """Return section and material of *BEAM GENERAL SECTION."""
    if len(rows) != 3 or len(rows[0]) != 5 or not 2 <= len(rows[2]) <= 4:
        keyword.refuse(
            "expected three data lines: area, I11, I12, I22, J; direction of the first axis; "
            "Young's modulus, shear modulus"
        )
    area, i11, i12, i22, torsion = rows[0].reals("a constant")
    modulus, shear = (rows[2].real(column, "a modulus") for column in (0, 1))
    density = parameter(keyword, "DENSITY", 0.0)
    if i12 != 0.0:
        keyword.refuse("I12 is not zero; give the section in its principal axes", 0)
    if not min(area, i11, i22, torsion) > 0 or not shear > 0:
        keyword.refuse("areas, inertias and moduli must be positive", 0)
    try:
        material = Material(
            youngs_modulus=modulus, poissons_ratio=modulus / (2 * shear) - 1, density=density
        )
    except ModelError as error:
        raise keyword.error(str(error), 2) from None
    return BeamSection(area=area, inertia_y=i11, inertia_z=i22, torsion=torsion), material


def _direction(second: list[Line]) -> Direction:
    """Return the direction of the first local axis n1; both programs default to (0, 0, -1)."""
    if not second:
        return (0.0, 0.0, -1.0)
    line = second[0]
    if len(line) != 3:
        line.refuse("expected the direction of the first local axis: three numbers")
    x, y, z = (line.keyword.scope.rotation @ line.padded(3, "a direction")).tolist()
    return (x, y, z)


TRUSSES = ("T3D2",)


def read_trusses(data: DeckData, materials: Mapping[str, Material]) -> Iterator[Beam]:
    """Yield the trusses of a deck; the default area is 1, as in both programs."""
    blocks, coordinates = data.elements.of(*TRUSSES), data.nodes.coordinates
    if not blocks:
        return
    keywords = data.deck.of("SOLID SECTION")
    sets, ignored = data.element_sets, data.deck.ignored
    numbers = section_numbers("SOLID SECTION", keywords, blocks, sets, ignored)
    for block, of_block in zip(blocks, numbers, strict=True):
        for i, element_id in enumerate(block.ids.tolist()):
            keyword = keywords[of_block[i]]
            start, end = block.nodes[i].tolist()
            along = coordinates[end] - coordinates[start]
            if not along.any():
                message = f"truss {element_id} has no length; its nodes coincide"
                block.keyword.refuse(message, int(block.rows[i]))
            yield Beam(
                id=element_id,
                nodes=(start, end),
                section=_section(keyword),
                material=find_isotropic(materials, keyword),
                orientation=any_across(along),
                property=int(of_block[i]) + 1,
            )


def _section(keyword: Keyword) -> BeamSection:
    rows = lines(keyword)
    area = rows[0].positive(0, "an area") if rows and rows[0].text(0) else 1.0
    return BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=0.0)


def read_springs(data: DeckData) -> tuple[tuple[Spring, ...], tuple[Bush, ...]]:
    """Return springs and bushes of SPRING1, SPRING2 and SPRINGA; inclined springs are bushes."""
    keywords = data.deck.of("SPRING")
    blocks = data.elements.of("SPRING1", "SPRING2", "SPRINGA")
    numbers = section_numbers("SPRING", keywords, blocks, data.element_sets, data.deck.ignored)
    springs: list[Spring] = []
    bushes: list[Bush] = []
    for block, of_block in zip(blocks, numbers, strict=True):
        for i, number in enumerate(of_block.tolist()):
            spring = _spring(block, i, keywords[number], data.nodes.coordinates)
            if isinstance(spring, Bush):
                bushes.append(spring)
            else:
                springs.append(spring)
    return tuple(springs), tuple(bushes)


def _spring(block: ElementBlock, i: int, keyword: Keyword, coordinates: Matrix) -> Spring | Bush:
    rows = lines(keyword)
    if len(rows) != 2 and not (block.type == "SPRINGA" and len(rows) == 1):
        keyword.refuse(
            f"found {len(rows)} data lines, expected the degrees of freedom (blank for SPRINGA) "
            "and one stiffness; nonlinear springs are not supported"
        )
    value = rows[-1].real(0, "a stiffness")
    if any(rows[-1].texts[1:]):
        rows[-1].refuse("a stiffness that depends on frequency or temperature is not supported")
    nodes = block.nodes[i].tolist()
    if block.type == "SPRINGA":
        axis = _axis(block, i, coordinates)
        if axis is None:
            return _inclined(block, i, value, coordinates)
        components = [axis] * 2
    else:
        rows[0].check((len(nodes),), f"{len(nodes)} degrees of freedom")
        components = [component(rows[0], column) for column in range(len(nodes))]
    ends = tuple(zip(nodes, components, strict=True))
    return Spring(id=int(block.ids[i]), ends=ends, stiffness=value)


def _axis(block: ElementBlock, i: int, coordinates: Matrix) -> int | None:
    """Return the component of an axial spring along a coordinate axis; None for others."""
    apart = coordinates[block.nodes[i, 1]] - coordinates[block.nodes[i, 0]]
    if not apart.any():
        block.keyword.refuse(
            f"SPRINGA {block.ids[i]} has no direction, because its nodes coincide; use SPRING2",
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
    axes = np.asarray(axes_along(along, side))
    number = int(block.ids[i])
    return Bush.of_arrays(number, (start, end), {0: stiffness}, axes, coordinates[start])


def read_masses(data: DeckData) -> Iterator[PointMass]:
    """Yield the point masses of MASS and ROTARYI elements."""
    for kind, name, read in (("MASS", "MASS", _mass), ("ROTARYI", "ROTARY INERTIA", _inertia)):
        keywords, blocks = data.deck.of(name), data.elements.of(kind)
        values = [read(keyword) for keyword in keywords]
        numbers = section_numbers(name, keywords, blocks, data.element_sets, data.deck.ignored)
        for block, of_block in zip(blocks, numbers, strict=True):
            for element_id, node, number in zip(
                block.ids.tolist(), block.nodes[:, 0].tolist(), of_block.tolist(), strict=True
            ):
                yield replace(values[number], id=element_id, node=node)


def _mass(keyword: Keyword) -> PointMass:
    line = only_line(keyword, (1,), "one mass")
    value = line.real(0, "a mass")
    if value < 0:
        line.refuse(f"the mass is {value:g}; it must not be negative")
    return PointMass(id=0, node=0, mass=value)


def _inertia(keyword: Keyword) -> PointMass:
    line = only_line(keyword, range(3, 7), "I11, I22, I33, I12, I13, I23")
    xx, yy, zz, xy, xz, yz = line.padded(6, "an inertia")
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    turned = keyword.scope.rotation @ tensor @ keyword.scope.rotation.T
    if np.linalg.eigvalsh(tensor).min() < 0:
        line.refuse("the inertia has a negative principal value; check its signs")
    first, second, third = ((float(a), float(b), float(c)) for a, b, c in turned)
    return PointMass(id=0, node=0, mass=0.0, inertia=(first, second, third))


_VIBRATIONS = ("FREQUENCY", "COMPLEX FREQUENCY", "DYNAMIC", "MODAL DYNAMIC")
_INCOMPATIBLE = (
    "C3D8I: incompatible modes have no mass here; in CalculiX they have, and frequencies of "
    "bending are lower: by 2 % at 12 elements per wave, 7 % at 7, 16 % at 5"
)
_SCALED = (
    "time step on *FREQUENCY: CalculiX adds mass to the elements that would need a smaller one "
    "(selective mass scaling) and finds lower frequencies; masses follow from densities here"
)
_TIME_STEP = 3
"""Field of *FREQUENCY after the number of frequencies and their bounds."""


def note_masses(deck: Deck, solids: Sequence[ElementBlock]) -> None:
    """Note differences of masses to the deck's program, in decks with vibration steps."""
    if not any(deck.of(name) for name in _VIBRATIONS):
        return
    if any(block.type == "C3D8I" for block in solids):
        deck.ignored.append(_INCOMPATIBLE)
    rows = [line for keyword in deck.of("FREQUENCY") for line in lines(keyword)[:1]]
    if any(line.text(_TIME_STEP) for line in rows):
        deck.ignored.append(_SCALED)
