"""``*SOLID SECTION`` and ``*ORIENTATION``: solids, their materials and directions."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from faying._typing import Indices, Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import ON_AXIS, DeckData, about_axis, rectangular
from faying.io.abaqus.fields import Line, lines
from faying.io.abaqus.keyword import Keyword, named
from faying.io.abaqus.mesh import SOLID_TYPES, ElementBlock
from faying.io.abaqus.sets import NamedSets, section_numbers
from faying.io.frames import Frame
from faying.model.assembly import Material
from faying.model.cells import CellBlock
from faying.model.elastic_law import turned


def distributed_axes(
    deck: Deck, keyword: Keyword, sets: NamedSets
) -> tuple[Matrix, list[tuple[Indices, Matrix]]]:
    """Return the axes (3, 3) of the ORIENTATION of a keyword, as rows in the basic frame.

    Also return ids and axes of elements with other axes by a *DISTRIBUTION.
    """
    orientation = _find(deck, keyword)
    rows = orientation.rows()
    name = rows[0][0].upper() if rows and len(rows[0]) == 1 else ""
    tables = [k for k in deck.of("DISTRIBUTION") if k.value("NAME").upper() == name]
    if not name or not tables:
        frame = _frame(orientation)
        if frame.kind != "R":
            system = orientation.choice("SYSTEM")
            orientation.refuse(f"SYSTEM={system} is not supported; RECTANGULAR is")
        return frame.axes, []
    default, *others = lines(tables[-1])
    if len(rows) > 1 or default.text(0):
        tables[-1].refuse(
            "expected a first line without an element, and no rotation after the distribution"
        )
    return rectangular(default.behind(1)).axes, [
        (sets.members(tables[-1], line.text(0), line.row), rectangular(line.behind(1)).axes)
        for line in others
    ]


def find_frame(deck: Deck, keyword: Keyword, points: Matrix) -> Frame:
    """Return the system of the ORIENTATION of a keyword, and note points (n, 3) on its axis."""
    orientation = _find(deck, keyword)
    frame = _frame(orientation)
    if count := int(frame.on_axis(points).sum()):
        name = orientation.value("NAME")
        deck.ignored.append(f"{count} nodes on the axis of *ORIENTATION {name}: {ON_AXIS}")
    return frame


def _find(deck: Deck, keyword: Keyword) -> Keyword:
    orientations = {k.value("NAME").upper(): k for k in deck.of("ORIENTATION")}
    return named(keyword, keyword.value("ORIENTATION"), orientations, "orientation")


def _frame(keyword: Keyword) -> Frame:
    keyword.check()
    rows = lines(keyword)
    if keyword.choice("SYSTEM") in ("C", "CYLINDRICAL"):
        if not rows or not 5 <= len(rows[0]) <= 6:
            keyword.refuse("expected a line with the coordinates of two points of the axis")
        return about_axis(rows[0], "C")
    if not 1 <= len(rows) <= 2 or not 6 <= len(rows[0]) <= 9:
        keyword.refuse(
            "expected a line with the coordinates of points a and b, and one with a turn"
        )
    frame = rectangular(rows[0])
    return frame if len(rows) == 1 else replace(frame, axes=_turned(rows[1], frame.axes))


def _turned(line: Line, axes: Matrix) -> Matrix:
    """Return axes rotated about one of them."""
    about = line.integer(0, "an axis 1, 2 or 3") - 1
    if len(line) != 2 or about not in (0, 1, 2):
        line.refuse("expected an axis, 1, 2 or 3, and an angle in degrees")
    angle = np.radians(line.real(1, "an angle"))
    return np.asarray(Rotation.from_rotvec(angle * axes[about]).apply(axes))


def find_isotropic(materials: Mapping[str, Material], keyword: Keyword) -> Material:
    """Return the material of the section of a beam, truss or shell."""
    material = find_material(materials, keyword)
    if material.law is not None:
        keyword.refuse(
            f"material '{material.name}' is anisotropic; beams, trusses and shells are isotropic "
            "here"
        )
    return material


def find_material(materials: Mapping[str, Material], keyword: Keyword) -> Material:
    """Return the material of a section."""
    return named(keyword, keyword.required("MATERIAL"), materials, "material")


def read_solid_sections(
    data: DeckData, materials: Mapping[str, Material]
) -> tuple[tuple[CellBlock, ...], dict[int, Material]]:
    """Return blocks of cells, with section numbers from 1 as properties, and their materials."""
    deck, elements, sets = data.deck, data.elements, data.element_sets
    sections = deck.of("SOLID SECTION")
    numbers = section_numbers("SOLID SECTION", sections, elements.solids, sets, deck.ignored)
    nothing = np.empty(0, dtype=np.int64)
    ids = np.concatenate([nothing, *(block.ids for block in elements.solids)])
    section = np.concatenate([nothing, *numbers]) + 1
    used: dict[int, Material] = {}
    reduced = np.concatenate(
        [np.empty(0, dtype=bool), *(np.full(len(b.ids), _hourglasses(b)) for b in elements.solids)]
    )
    more = itertools.count(len(sections) + 1)
    for number, keyword in enumerate(sections, start=1):
        chosen = section == number
        used[number] = find_material(materials, keyword)
        material, law = used[number], used[number].law
        if law is not None and keyword.has("ORIENTATION"):
            axes, others = distributed_axes(deck, keyword, sets)
            used[number] = replace(material, law=turned(law, axes))
            for members, along in others:
                new_number = next(more)
                section[chosen & np.isin(ids, members)] = new_number
                used[new_number] = replace(material, law=turned(law, along))
        if used[number].law is not None and (chosen & reduced).any():
            keyword.refuse(
                f"material '{used[number].name}' is anisotropic; the hourglass stiffness of C3D8R "
                "is isotropic; use C3D8I"
            )
    return tuple(cells(elements.solids, section, _reduced(deck))), used


def _hourglasses(block: ElementBlock) -> bool:
    return SOLID_TYPES[block.type].hourglass_patterns is not None


def is_of_abaqus(deck: Deck) -> bool:
    """Return whether a deck is for Abaqus only: it has instances, or keywords of Abaqus."""
    return bool(deck.of("PREPRINT")) or any(k.scope.name for k in deck.of("NODE"))


def _reduced(deck: Deck) -> str:
    """Return the formulation of C3D8R in the program of the deck."""
    return "reduced-abaqus" if is_of_abaqus(deck) else "reduced"


def cells(
    blocks: Sequence[ElementBlock], section: Indices, reduced: str = "reduced"
) -> list[CellBlock]:
    """Return solids as blocks of a mesh; ``section`` (n_element,) has their properties.

    Blocks of eight-node bricks have a formulation only where the deck mixes several;
    ``reduced`` is the formulation of C3D8R.
    """
    cell_blocks, start = [], 0
    mixed = len({block.type for block in blocks if _is_hex8(block.type)}) > 1
    for block in blocks:
        element = SOLID_TYPES[block.type]
        incompatible = mixed if _is_hex8(block.type) else element.formulation != "standard"
        end = start + len(block.ids)
        cell_blocks.append(
            CellBlock(
                kind=element.kind,
                formulation=(reduced if block.type == "C3D8R" else element.formulation)
                if incompatible
                else "",
                nodes=block.nodes,
                ids=block.ids,
                properties=section[start:end],
            )
        )
        start = end
    return cell_blocks


def note_controls(deck: Deck, blocks: Sequence[ElementBlock]) -> None:
    """Note the effect that *SECTION CONTROLS would have on the solids of a deck."""
    reduced = any(_hourglasses(block) for block in blocks)
    for keyword in deck.of("SECTION CONTROLS"):
        kind = keyword.choice("HOURGLASS", "STIFFNESS")
        head = f"*SECTION CONTROLS {keyword.value('NAME')}: "
        if not reduced:
            deck.ignored.append(f"{head}no solid of the deck has hourglass modes")
        elif kind == "ENHANCED":
            deck.ignored.append(f"{head}{_ENHANCED}")
        else:
            deck.ignored.append(
                f"{head}hourglass control {kind} and its factors are not read; C3D8R has the "
                "default of its program, which matters for few layers in bending"
            )


_OF_ABAQUS = (
    "uniform strain with the hourglass stiffness of Abaqus 2023 on one model, a fifth of "
    "that of CalculiX 2.20, which decks without *PREPRINT and instances get: bending of few layers "
    "differs"
)
_ENHANCED = (
    "hourglass control ENHANCED is not read: with it C3D8R bends nearly as C3D8I; here it has "
    "the default of its program, with which a strip of cubes, 20 thicknesses long, deflects 28 "
    "times as much as a beam in one layer (139 in decks of Abaqus), 1.30 times in two, 1.11 in "
    "three, 1.05 in four; use C3D8I (0.999 times)"
)


def formulation(deck: Deck, blocks: Sequence[ElementBlock]) -> str:
    """Return the formulation of eight-node bricks, and note differences from the deck."""
    counts: dict[str, int] = {}
    for block in blocks:
        counts[block.type] = counts.get(block.type, 0) + len(block.ids)
    for name, count in counts.items():
        if name == "C3D8R" and is_of_abaqus(deck):
            deck.ignored.append(f"{count} {name}: {_OF_ABAQUS}")
        elif note := SOLID_TYPES[name].elsewhere.abaqus.get(name, ""):
            deck.ignored.append(f"{count} {name}: {note}")
    bricks = {
        _reduced(deck) if name == "C3D8R" else SOLID_TYPES[name].formulation
        for name in counts
        if _is_hex8(name)
    }
    return bricks.pop() if len(bricks) == 1 else "incompatible"


def _is_hex8(name: str) -> bool:
    return SOLID_TYPES[name].kind == "hex8"
