"""``*CLOAD``: forces on nodes, step by step."""

from collections.abc import Iterator

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs, component
from faying.io.abaqus.fields import real
from faying.io.abaqus.keyword import Keyword

Forces = dict[tuple[int, int], float]


def operation(keyword: Keyword) -> bool:
    """Whether OP=NEW removes earlier loads.

    Raises
    ------
    FormatError
        If OP is neither MOD nor NEW.
    """
    wished = keyword.choice("OP", "MOD")
    if wished not in ("MOD", "NEW"):
        message = f"OP={wished} is not known; give MOD or NEW"
        raise keyword.error(message)
    return wished == "NEW"


def note_amplitude(keyword: Keyword, ignored: list[str]) -> None:
    """Say that the course over time is left out."""
    if keyword.has("AMPLITUDE"):
        note = f"AMPLITUDE={keyword.value('AMPLITUDE')} of *{keyword.name}: full magnitude taken"
        if note not in ignored:
            ignored.append(note)


def read_concentrated(deck: Deck, dofs: Dofs, ignored: list[str]) -> Iterator[Forces]:
    """Yield the *CLOAD in force, step by step from 0: (node, component) of the deck to the value.

    A later step replaces what it names again; within a step values add up. OP=NEW removes what
    earlier steps left.

    Raises
    ------
    FormatError
        Naming the line of a follower force, an unknown node or a malformed number.
    """
    found: Forces = {}
    for new, here in _steps(deck, dofs, ignored):
        found = {**({} if new else found), **here}
        yield found


def last_given(deck: Deck, dofs: Dofs) -> Forces:
    """Return the last value of each *CLOAD up to now, removed or not.

    A bolt keeps the force it was tightened to when it is locked and the force is removed.
    """
    found: Forces = {}
    for _, here in _steps(deck, dofs, []):
        found.update(here)
    return found


def _steps(deck: Deck, dofs: Dofs, ignored: list[str]) -> Iterator[tuple[bool, Forces]]:
    """Yield for each step whether it removes earlier forces, and those it names."""
    for step in range(deck.n_step + 1):
        here: Forces = {}
        new = False
        for keyword in (k for k in deck.of("CLOAD") if k.step == step):
            keyword.allow("OP", "AMPLITUDE")
            note_amplitude(keyword, ignored)
            new |= operation(keyword)
            for place, value in _values(keyword, dofs):
                here[place] = here.get(place, 0.0) + value
        yield new, here


def _values(keyword: Keyword, dofs: Dofs) -> Iterator[tuple[tuple[int, int], float]]:
    for row, fields in enumerate(keyword.rows()):
        if len(fields) != 3:
            message = (
                f"found {len(fields)} fields, expected node or node set, degree of freedom, force"
            )
            raise keyword.error(message, row)
        c = component(keyword, row, fields[1])
        value = real(keyword, row, fields[2], "a force")
        for node in dofs.find(keyword, row, fields[0]).tolist():
            yield (node, c), value


def nodal_forces(forces: Forces, dofs: Dofs) -> Matrix:
    """Return forces and moments (n_node, 6) in the basic frame."""
    result = np.zeros((len(dofs.nodes.ids), 6))
    for (node, c), value in forces.items():
        axes = dofs.axes(node)
        if axes is None:
            result[dofs.place(node, c)] += value
        else:
            first = 3 * (c // 3)
            result[node, first : first + 3] += value * axes[c % 3]
    return result
