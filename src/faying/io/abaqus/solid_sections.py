"""``*SOLID SECTION``: solids and their materials as blocks of a mesh."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.element_types import SOLID_TYPES
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.keyword import Keyword, named
from faying.io.abaqus.orientations import distributed_axes
from faying.io.abaqus.sets import NamedSets
from faying.model.assembly import Material
from faying.model.cells import CellBlock
from faying.model.elastic_law import turned


def find_isotropic(materials: Mapping[str, Material], keyword: Keyword) -> Material:
    """Return the material the section of a beam, truss or shell names."""
    material = find_material(materials, keyword)
    if material.law is not None:
        keyword.refuse(
            f"material '{material.name}' is anisotropic; beams, trusses and shells are isotropic "
            "here"
        )
    return material


def find_material(materials: Mapping[str, Material], keyword: Keyword) -> Material:
    """Return the material a section names."""
    return named(keyword, keyword.required("MATERIAL"), materials, "material")


def read_solid_sections(
    deck: Deck, elements: Elements, sets: NamedSets, materials: Mapping[str, Material]
) -> tuple[tuple[CellBlock, ...], dict[int, Material]]:
    """Return blocks of cells, whose properties number the sections from 1, and their materials."""
    ids = np.concatenate([np.empty(0, dtype=np.int64), *(b.ids for b in elements.solids)])
    section = np.zeros(len(ids), dtype=np.int64)
    used: dict[int, Material] = {}
    reduced = np.concatenate(
        [np.empty(0, dtype=bool), *(np.full(len(b.ids), _hourglasses(b)) for b in elements.solids)]
    )
    sections = deck.of("SOLID SECTION")
    more = itertools.count(len(sections) + 1)
    for number, keyword in enumerate(sections, start=1):
        keyword.check()
        chosen = np.isin(ids, sets.find(keyword, keyword.required("ELSET")))
        again = np.flatnonzero(chosen & (section > 0))
        if again.size:
            deck.ignored.append(
                f"{keyword.where()}: *SOLID SECTION of {len(again)} elements (the first "
                f"{ids[again[0]]}) that have one already: the last counts, as in CalculiX; Abaqus "
                "refuses such a deck"
            )
        section[chosen] = number
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
                "is isotropic, take C3D8I"
            )
    missing = np.flatnonzero(section == 0)
    if missing.size:
        block, row = _place(elements.solids, int(missing[0]))
        block.keyword.refuse(
            f"element {ids[missing[0]]} has no *SOLID SECTION; give its set one", row
        )
    return tuple(cells(elements.solids, section, _reduced(deck))), used


def _hourglasses(block: ElementBlock) -> bool:
    return SOLID_TYPES[block.type].hourglass_patterns is not None


def _place(blocks: Sequence[ElementBlock], position: int) -> tuple[ElementBlock, int]:
    for block in blocks:
        if position < len(block.ids):
            return block, int(block.rows[position])
        position -= len(block.ids)
    raise IndexError(position)


def is_of_abaqus(deck: Deck) -> bool:
    """Whether only Abaqus reads a deck: it has instances, or keywords that CalculiX has not."""
    return bool(deck.of("PREPRINT")) or any(k.scope.name for k in deck.of("NODE"))


def _reduced(deck: Deck) -> str:
    """Return the formulation of C3D8R, by the program the deck is of."""
    return "reduced-abaqus" if is_of_abaqus(deck) else "reduced"


def cells(
    blocks: Sequence[ElementBlock], section: Indices, reduced: str = "reduced"
) -> list[CellBlock]:
    """Return solids as blocks of a mesh; ``section`` are the properties of all, in order.

    Bricks of eight nodes have a formulation of their own only where the deck mixes them;
    ``reduced`` is that of C3D8R.
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
    """Say what *SECTION CONTROLS would change in the solids of a deck."""
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
                f"{head}hourglass control {kind} and its factors are not taken; C3D8R has the "
                "default of its program, which few layers in bending feel"
            )


_OF_ABAQUS = (
    "uniform strain with the hourglass stiffness that Abaqus 2023 showed on one model, a fifth of "
    "that of CalculiX 2.20, which decks without *PREPRINT and instances get: bending of few layers "
    "differs"
)
_ENHANCED = (
    "hourglass control ENHANCED is not taken: it lets C3D8R bend nearly as C3D8I; here they have "
    "the default of their program, with which a strip of cubes, 20 thicknesses long, gives way 28 "
    "times as much as a beam in one layer (139 in decks of Abaqus), 1.30 times in two, 1.11 in "
    "three, 1.05 in four; take C3D8I (0.999 times)"
)


def formulation(deck: Deck, blocks: Sequence[ElementBlock]) -> str:
    """Return the formulation of eight-node bricks, and say what differs from the deck."""
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
