"""``*CLOAD``: forces on nodes, step by step."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.amplitudes import Amplitudes
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs, component
from faying.io.abaqus.fields import check_count, real
from faying.io.abaqus.keyword import Keyword

Forces = dict[tuple[int, int], float]
_Given = tuple[float, Keyword]


def read_concentrated(
    deck: Deck, dofs: Dofs, amplitudes: Amplitudes, ignored: list[str]
) -> Iterator[Forces]:
    """Yield the *CLOAD in force, step by step from 0: (node, component) of the deck to the value.

    A later step replaces what it names again; within a step values add up. OP=NEW removes what
    earlier steps left, and none of it acts in a linear perturbation.
    """
    for load in deck.of("CLOAD"):
        amplitudes.note(load, ignored)
        if _is_imaginary(load):
            ignored.append(
                f"{load.where()}: *CLOAD, LOAD CASE=2: the imaginary part of a harmonic load; "
                "the load of the step is the real part"
            )
        if load.has("OMEGA0"):
            ignored.append(f"{load.where()}: OMEGA0 of *CLOAD: loads of statics have no frequency")
    forces: dict[tuple[int, int], list[_Given]] = {}
    for step, (new, changes) in enumerate(_steps(deck, dofs)):
        forces = {**({} if new else forces), **changes}
        yield _at(forces, amplitudes, step)


def _at(
    forces: Mapping[tuple[int, int], list[_Given]], amplitudes: Amplitudes, step: int
) -> Forces:
    """Return the forces at the end of a step."""
    return {
        dof: sum(value * amplitudes.factor(keyword, step) for value, keyword in values)
        for dof, values in forces.items()
    }


def _steps(deck: Deck, dofs: Dofs) -> Iterator[tuple[bool, dict[tuple[int, int], list[_Given]]]]:
    """Yield for each step whether it removes earlier forces, and those it names."""
    for step in range(deck.n_step + 1):
        changes: dict[tuple[int, int], list[_Given]] = {}
        new = step in deck.perturbations
        for keyword in (k for k in deck.of("CLOAD") if k.step == step):
            keyword.check()
            new |= keyword.choice("OP") == "NEW"
            if _is_imaginary(keyword):
                continue
            for dof, value in _values(keyword, dofs):
                changes.setdefault(dof, []).append((value, keyword))
        yield new, changes


def _is_imaginary(keyword: Keyword) -> bool:
    """Whether forces are the imaginary part of those of a harmonic response."""
    return keyword.choice("LOAD CASE", "1") == "2"


def _values(keyword: Keyword, dofs: Dofs) -> Iterator[tuple[tuple[int, int], float]]:
    for row, fields in enumerate(keyword.rows()):
        check_count(keyword, row, fields, (3,), "node or node set, degree of freedom, force")
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
