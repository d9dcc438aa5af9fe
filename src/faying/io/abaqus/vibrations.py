"""Where a deck that asks for vibrations has other masses in CalculiX."""

from collections.abc import Sequence

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.elements import ElementBlock

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
