"""``*BOUNDARY``: degrees of freedom held at zero, or moved."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying.io.abaqus.deck_data import DeckData, component_range
from faying.io.abaqus.fields import Line, lines
from faying.io.abaqus.loads import Amplitudes
from faying.io.moved_supports import Place
from faying.model.assembly import Support

TYPES = {
    "XSYMM": (0, 4, 5),
    "YSYMM": (1, 3, 5),
    "ZSYMM": (2, 3, 4),
    "XASYMM": (1, 2, 3),
    "YASYMM": (0, 2, 4),
    "ZASYMM": (0, 1, 5),
    "PINNED": (0, 1, 2),
    "ENCASTRE": (0, 1, 2, 3, 4, 5),
}

Holds = dict[Place, tuple[float, Line]]
"""Value and data line by node and component of the deck."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Boundary:
    """Boundary conditions of *BOUNDARY up to the last step of a deck.

    Attributes
    ----------
    supports
        Degrees of freedom held at zero in all steps.
    moved
        Displacements at the end of each step, from 0, by node and component of degrees of
        freedom that move.
    pretension
        Displacements of held pretension nodes; NaN where a force determined the
        displacement.
    since
        First step in which each pretension node is held.
    """

    supports: tuple[Support, ...]
    moved: Mapping[Place, tuple[float, ...]]
    pretension: Mapping[int, float]
    since: Mapping[int, int]


def read_supports(data: DeckData, apart: frozenset[int], amplitudes: Amplitudes) -> Boundary:
    """Return the boundary conditions up to the last step of a deck.

    ``apart`` are nodes of pretension sections, whose boundary conditions lock a bolt or give the
    shortening of its section.
    """
    deck = data.deck
    courses: dict[Place, list[float]] = {}
    holds: Holds = {}
    since: dict[Place, int] = {}
    for step in range(deck.n_step + 1):
        left = {dof: courses[dof][step - 1] for dof in holds}
        holds = _after(holds, left, step, data, apart)
        since = {dof: since.get(dof, step) for dof in holds}
        for dof, (value, line) in holds.items():
            course = courses.setdefault(dof, [0.0] * (deck.n_step + 1))
            acts = value and (line.keyword.step == step or step not in deck.perturbations)
            course[step] = value * amplitudes.factor(line.keyword, step) if acts else 0.0
    bolts = [node for node, c in holds if node in apart and c == 0]
    last = deck.n_step - (deck.n_step in deck.perturbations)
    holds = {dof: hold for dof, hold in holds.items() if dof[0] not in apart}
    moved = {}
    for dof in [dof for dof in holds if any(courses[dof])]:
        _, line = holds.pop(dof)
        if data.local.axes(dof[0]) is not None:
            line.refuse(
                f"node {data.nodes.ids[dof[0]]} is moved along axes of a *TRANSFORM; only basic "
                "directions are supported for other displacements than zero"
            )
        ((node, c, _),) = data.parts(*dof)
        moved[node, c] = tuple(courses[dof])
    fixed = np.zeros((len(data.nodes.ids), 6), dtype=bool)
    for node, c in holds:
        fixed[(node, c) if node not in data.rotations else data.parts(node, c)[0][:2]] = True
    supports = enumerate(data.local.supports(fixed, 0), start=1)
    return Boundary(
        supports=tuple(replace(item, id=number) for number, item in supports),
        moved=moved,
        pretension={node: courses[node, 0][last] for node in bolts},
        since={node: since[node, 0] for node in bolts},
    )


def _after(
    holds: Holds,
    left: Mapping[Place, float],
    step: int,
    data: DeckData,
    apart: frozenset[int],
) -> Holds:
    """Return the held degrees of freedom of a step from those of the step before.

    The value is NaN where FIXED holds a degree of freedom at a displacement by a force.
    """
    holds = dict(holds)
    for keyword in (item for item in data.deck.of("BOUNDARY") if item.step == step):
        if keyword.choice("OP") == "NEW":
            holds = {dof: item for dof, item in holds.items() if item[1].keyword.step == step}
        new = {
            dof: (value, line)
            for line in lines(keyword, range(2, 5), _EXPECTED)
            for dof, value in _held(line, data, "temperature" in data.deck.ignore)
        }
        if keyword.has("FIXED"):
            new = {dof: (left.get(dof, np.nan), line) for dof, (_, line) in new.items()}
        holds |= new
        if keyword.has("FIXED") and any(node not in apart for node, _ in new):
            keyword.refuse(
                "FIXED holds nodes at their last displacement, which is known only for pretension "
                "nodes; give displacements, or choose an earlier step (subcase in the study)"
            )
    return holds


_EXPECTED = "node or node set, first and last degree of freedom, value"


def _held(line: Line, data: DeckData, cold: bool) -> Iterator[tuple[Place, float]]:
    """Yield degrees of freedom and values of a line, without temperatures (11, 0) if ``cold``."""
    kind = line.text(1)
    if cold and kind in ("0", "11"):
        return
    nodes = data.find(line)
    if kind.upper() in TYPES:
        if len(line) > 2:
            line.refuse(f"found fields after {kind}; expected none")
        components, value = TYPES[kind.upper()], 0.0
    else:
        components = tuple(component_range(line, 1))
        value = line.real(3, "a displacement", 0.0)
    for c in components:
        for node in nodes.tolist():
            yield (node, c), value
