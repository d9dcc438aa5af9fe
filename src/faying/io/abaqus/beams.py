"""``*BEAM SECTION`` and ``*BEAM GENERAL SECTION``: beams of both programs as exact beams."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import Elements
from faying.io.abaqus.fields import numbers, padded, parameter, positive
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets, assign
from faying.io.abaqus.solid_sections import find_isotropic
from faying.model.assembly import Beam, BeamSection, Material
from faying.model.axes import any_across, rectangular_section, round_section

TYPES = ("B31", "B31R", "B33", "B32", "B32R")

Direction = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class _Section:
    number: int
    section: BeamSection
    material: Material
    first_axis: Direction


def read_beams(
    deck: Deck, elements: Elements, sets: NamedSets, materials: Mapping[str, Material]
) -> Iterator[Beam]:
    """Read beams: two-node ones as they are, three-node ones as two beams.

    The second half of a three-node beam gets the id of the beam, the first half a new one.
    """
    blocks = elements.of(*TYPES)
    if not blocks:
        return
    sections = _sections(deck, sets, materials)
    deck.ignored.extend(
        f"{name}: taken as beams exact for end loads, not as the element's own"
        for name in sorted({block.type for block in blocks} - {"B33"})
    )
    halves = max((int(block.ids.max(initial=0)) for block in elements.blocks), default=0) + 1
    for block in blocks:
        for i, element_id in enumerate(block.ids.tolist()):
            ends = block.nodes[i].tolist()
            for start, end in pairwise(ends):
                last = end == ends[-1]
                section = block.section(i, sections, "BEAM SECTION")
                yield _beam(block.type, section, element_id if last else halves, (start, end))
                halves += not last


def _beam(kind: str, section: _Section, number: int, ends: tuple[int, int]) -> Beam:
    used = section.section
    if kind == "B33":
        used = replace(used, shear_factor_y=np.inf, shear_factor_z=np.inf)
    return Beam(
        id=number,
        nodes=ends,
        section=used,
        material=section.material,
        orientation=section.first_axis,
        property=section.number,
    )


def _sections(
    deck: Deck, sets: NamedSets, materials: Mapping[str, Material]
) -> dict[int, _Section]:
    sections: dict[int, _Section] = {}
    first = len(deck.of("SOLID SECTION")) + 1
    named = ("BEAM SECTION", "BEAM GENERAL SECTION", "TRANSVERSE SHEAR STIFFNESS")
    for number, keyword in enumerate(deck.of(*named), start=first):
        if keyword.name == "TRANSVERSE SHEAR STIFFNESS":
            keyword.refuse(
                "it is not supported; leave it out, and take B33 for beams rigid in shear"
            )
        keyword.check()
        rows = keyword.rows()
        if keyword.name == "BEAM SECTION":
            material = find_isotropic(materials, keyword)
            section = _profile(keyword, rows, material.poissons_ratio)
        else:
            section, material = _general(keyword, rows)
        axis = _direction(keyword, rows)
        beam = _Section(number=number, section=section, material=material, first_axis=axis)
        assign(sections, keyword, sets, beam)
    return sections


def _measures(keyword: Keyword, rows: list[list[str]], counts: tuple[int, ...]) -> list[float]:
    if not rows or len(rows[0]) not in counts:
        shown = " or ".join(map(str, counts))
        keyword.refuse(
            f"expected {shown} measures of the section on the first data line", 0 if rows else None
        )
    return [positive(keyword, 0, text, "a measure") for text in rows[0]]


def _profile(keyword: Keyword, rows: list[list[str]], poisson: float) -> BeamSection:
    """Section of a circle, pipe or rectangle; the first local axis n1 is our y."""
    kind = keyword.choice("SECTION")
    if kind not in ("CIRC", "PIPE", "RECT"):
        shapes = "CIRC, PIPE, RECT, or *BEAM GENERAL SECTION"
        keyword.refuse(f"SECTION={kind} is not supported; give {shapes}")
    if kind == "RECT":
        width, height = _measures(keyword, rows, (2,))
        return rectangular_section(width, height, _rectangle_torsion(width, height), poisson)
    radius, *others = _measures(keyword, rows, (2,) if kind == "PIPE" else (1, 2))
    if kind == "CIRC" and others not in ([], [radius]):
        keyword.refuse("an elliptic section is not supported; give one radius", 0)
    inner = radius - others[0] if kind == "PIPE" else 0.0
    if kind == "PIPE" and inner <= 0:
        keyword.refuse(f"the wall {others[0]:g} is not thinner than the radius {radius:g}", 0)
    return round_section(radius, inner, poisson)


def _rectangle_torsion(width: float, height: float) -> float:
    """Torsion constant of a rectangle: S. Timoshenko, J. Goodier, "Theory of Elasticity", §109.

    Three terms of the series leave 1e-6.
    """
    long, short = max(width, height), min(width, height)
    odd = np.arange(1, 12, 2)
    series = np.sum(np.tanh(odd * np.pi * long / (2 * short)) / odd**5)
    return float(long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series))


def _general(keyword: Keyword, rows: list[list[str]]) -> tuple[BeamSection, Material]:
    """Area, I11, I12, I22, J; axis; Young's and shear modulus."""
    if len(rows) != 3 or len(rows[0]) != 5 or not 2 <= len(rows[2]) <= 4:
        keyword.refuse(
            "expected three data lines: area, I11, I12, I22, J; direction of the first axis; "
            "Young's modulus, shear modulus"
        )
    area, i11, i12, i22, torsion = numbers(keyword, 0, rows[0], "a constant")
    modulus, shear = numbers(keyword, 2, rows[2][:2], "a modulus")
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


def _direction(keyword: Keyword, rows: list[list[str]]) -> Direction:
    """Direction of the first local axis n1; both programs default to (0, 0, -1)."""
    if len(rows) < 2:
        return (0.0, 0.0, -1.0)
    if len(rows[1]) != 3:
        keyword.refuse("expected the direction of the first local axis: three numbers", 1)
    turned = keyword.scope.rotation @ padded(keyword, 1, rows[1], 3, "a direction")
    return (float(turned[0]), float(turned[1]), float(turned[2]))


TRUSSES = ("T3D2",)


def read_trusses(
    deck: Deck,
    elements: Elements,
    sets: NamedSets,
    materials: Mapping[str, Material],
    coordinates: Matrix,
) -> Iterator[Beam]:
    """Read trusses; their area is 1 where the section gives none, as in both programs."""
    blocks = elements.of(*TRUSSES)
    if not blocks:
        return
    truss_ids = np.concatenate([block.ids for block in blocks])
    sections: dict[int, tuple[int, BeamSection, Material]] = {}
    for number, keyword in enumerate(deck.of("SOLID SECTION"), start=1):
        ids = sets.find(keyword, keyword.required("ELSET"))
        members = ids[np.isin(ids, truss_ids)].tolist()
        if members:
            member = number, _section(keyword), find_isotropic(materials, keyword)
            sections.update(dict.fromkeys(members, member))
    for block in blocks:
        for i, element_id in enumerate(block.ids.tolist()):
            number, section, material = block.section(i, sections, "SOLID SECTION")
            start, end = block.nodes[i].tolist()
            along = coordinates[end] - coordinates[start]
            if not along.any():
                message = f"truss {element_id} has no length; its nodes coincide"
                block.keyword.refuse(message, int(block.rows[i]))
            yield Beam(
                id=element_id,
                nodes=(start, end),
                section=section,
                material=material,
                orientation=any_across(along),
                property=number,
            )


def _section(keyword: Keyword) -> BeamSection:
    rows = keyword.rows()
    area = positive(keyword, 0, rows[0][0], "an area") if rows and rows[0][0] else 1.0
    return BeamSection(area=area, inertia_y=0.0, inertia_z=0.0, torsion=0.0)
