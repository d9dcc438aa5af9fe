"""Ids a deck needs where an assembly has names, values or ids that clash."""

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from faying.exceptions import refuse
from faying.model.assembly import Assembly, BeamSection, Material

LARGEST_ID = 99_999_999
"""Largest id that fits the eight columns of a small field."""

_NUMBER = re.compile(r"[1-9]\d{0,7}")

SectionKey = tuple[BeamSection, Material]


@dataclass(frozen=True, eq=False, kw_only=True)
class Numbering:
    """Ids of a deck.

    Attributes
    ----------
    sections
        Section and material to property id.
    supports, equations
        Set id of the assembly to that of the deck (only 0 changes).
    changed
        (family, id) of elements whose id was taken.
    spc, mpc
        Sets that case control selects.
    """

    materials: Mapping[Material, int]
    sections: Mapping[SectionKey, int]
    supports: Mapping[int, int]
    equations: Mapping[int, int]
    loads: Mapping[str, int]
    changed: Mapping[tuple[str, int], int]
    spc: int
    mpc: int

    def element(self, family: str, number: int) -> int:
        """Return the id of an element in the deck."""
        return self.changed.get((family, number), number)


def number_assembly(assembly: Assembly) -> Numbering:
    """Give everything in an assembly an id of its own."""
    supports = _sets(support.id for support in assembly.supports)
    equations = _sets(equation.id for equation in assembly.equations)
    return Numbering(
        materials=_materials(assembly),
        sections=_sections(assembly),
        supports=supports,
        equations=equations,
        loads=_named(list(assembly.loads)),
        changed=_elements(assembly),
        spc=_joined(supports),
        mpc=_joined(equations),
    )


def _numbers(wanted: Collection[int], what: str, taken: Collection[int] = ()) -> list[int]:
    """Return the numbers that are wanted, and free ones for what is not positive or taken."""
    used, free = set(taken), max([0, *wanted, *taken])
    numbers = []
    for preferred in wanted:
        number = preferred
        if number <= 0 or number in used:
            number = free = free + 1
        if number > LARGEST_ID:
            refuse(
                f"{what} {number} does not fit a Nastran field; renumber it below {LARGEST_ID + 1}"
            )
        used.add(number)
        numbers.append(number)
    return numbers


def _sets(numbers: Iterable[int]) -> dict[int, int]:
    distinct = list(dict.fromkeys(numbers))
    return dict(zip(distinct, _numbers(distinct, "constraint set"), strict=True))


def _joined(sets: Mapping[int, int]) -> int:
    values = set(sets.values())
    return next(iter(values)) if len(values) == 1 else max(values, default=0) + 1


def _named(names: list[str]) -> dict[str, int]:
    """Numbers that names say themselves, free ones for the others."""
    wanted = [int(name) if _NUMBER.fullmatch(name) else 0 for name in names]
    return dict(zip(names, _numbers(wanted, "number"), strict=True))


def _materials(assembly: Assembly) -> dict[Material, int]:
    materials = list(
        dict.fromkeys([*assembly.materials.values(), *(beam.material for beam in assembly.beams)])
    )
    names = [material.name for material in materials]
    # Different materials of one name get names that are no numbers.
    labels = [
        name if name and names.count(name) == 1 else f"{name}#{i}" for i, name in enumerate(names)
    ]
    numbers = _named(labels)
    return {material: numbers[label] for material, label in zip(materials, labels, strict=True)}


def _sections(assembly: Assembly) -> dict[SectionKey, int]:
    used = {int(n) for block in assembly.mesh.blocks for n in np.unique(block.properties)}
    preferred: dict[SectionKey, int] = {}
    for beam in assembly.beams:
        preferred.setdefault((beam.section, beam.material), beam.property)
    return dict(zip(preferred, _numbers(preferred.values(), "property", used), strict=True))


def _elements(assembly: Assembly) -> dict[tuple[str, int], int]:
    families: tuple[tuple[str, list[int]], ...] = (
        ("cell", [n for block in assembly.mesh.blocks for n in block.ids.tolist()]),
        ("beam", [beam.id for beam in assembly.beams]),
        ("spring", [spring.id for spring in assembly.springs]),
        ("mass", [mass.id for mass in assembly.masses]),
        ("rigid", [coupling.id for coupling in assembly.rigid_couplings]),
        ("average", [coupling.id for coupling in assembly.average_couplings]),
    )
    for family, ids in families:
        if len(set(ids)) < len(ids):
            twice = next(n for n in ids if ids.count(n) > 1)
            refuse(f"{family} id {twice} occurs twice; give each its own id")
    keys = [(family, number) for family, ids in families for number in ids]
    numbers = _numbers([number for _, number in keys], "element")
    return {key: new for key, new in zip(keys, numbers, strict=True) if new != key[1]}
