"""``*CLOAD``: forces on nodes, step by step."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.amplitudes import Amplitudes
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs, component
from faying.io.abaqus.fields import check_count, real
from faying.io.abaqus.in_force import in_force
from faying.io.abaqus.keyword import Keyword

Forces = dict[tuple[int, int], float]


def read_concentrated(deck: Deck, dofs: Dofs, amplitudes: Amplitudes) -> Iterator[Forces]:
    """Yield the *CLOAD in force, step by step from 0: (node, component) of the deck to the value.

    As of :func:`~.in_force.in_force`.
    """
    for load in deck.of("CLOAD"):
        amplitudes.note(load, deck.ignored)
        if _is_imaginary(load):
            deck.ignored.append(
                f"{load.where()}: *CLOAD, LOAD CASE=2: the imaginary part of a harmonic load; "
                "the load of the step is the real part"
            )
        if load.has("OMEGA0"):
            deck.ignored.append(
                f"{load.where()}: OMEGA0 of *CLOAD: loads of statics have no frequency"
            )
    for step, forces in enumerate(in_force(deck, ("CLOAD",), partial(_values, dofs=dofs))):
        yield {
            dof: sum(value * amplitudes.factor(keyword, step) for value, keyword in values)
            for dof, values in forces.items()
        }


def _is_imaginary(keyword: Keyword) -> bool:
    """Whether forces are the imaginary part of those of a harmonic response."""
    return keyword.choice("LOAD CASE", "1") == "2"


def _values(keyword: Keyword, dofs: Dofs) -> Iterator[tuple[tuple[int, int], float]]:
    if _is_imaginary(keyword):
        return
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
