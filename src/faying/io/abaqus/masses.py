"""``*MASS`` and ``*ROTARY INERTIA``: concentrated masses; where CalculiX has others."""

from collections.abc import Iterator, Sequence

import numpy as np

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import ElementBlock, Elements
from faying.io.abaqus.fields import only_line, padded, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets, assign
from faying.model.assembly import PointMass

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


def note_masses(deck: Deck, solids: Sequence[ElementBlock], ignored: list[str]) -> None:
    """Say which masses differ, in decks that ask for vibrations."""
    if not any(deck.of(name) for name in _VIBRATIONS):
        return
    if any(block.type == "C3D8I" for block in solids):
        ignored.append(_INCOMPATIBLE)
    rows = [row for keyword in deck.of("FREQUENCY") for row in keyword.rows()[:1]]
    if any(len(row) > _TIME_STEP and row[_TIME_STEP] for row in rows):
        ignored.append(_SCALED)
