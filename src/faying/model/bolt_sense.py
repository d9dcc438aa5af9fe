"""Which way a spring that stands for a bolt pulls, and whether two bolts are one."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices
from faying.digits import DECK_DIGITS
from faying.exceptions import ModelError
from faying.model.assembly import Assembly, Spring
from faying.model.mesh import Mesh

Seats = tuple[Indices, Indices]
"""Nodes of solids that the two ends of a bolt hold."""


_SAME_SEAT = 0.5
"""Share of the smaller seat from which two bolts that have it in common sit on the same one."""


def spring_sense(assembly: Assembly, spring: Spring, seats: Seats) -> float:
    """Return 1 if the spring grows longer when its second end moves forward, else -1.

    Ends in different places say so themselves. Where they coincide, as at a cut through a bolt,
    what they hold does: the end whose seat lies farther along the spring's direction is the forward
    one, in whichever order a deck lists them. Seats that lie beside each other, as the threads of a
    bolt and its nut, leave it to the middle of what their bodies have there. It is 1 where nothing
    decides.
    """
    (first, component), (second, _) = spring.ends
    mesh = assembly.mesh
    along = mesh.nodes[:, component]
    nothing = DECK_DIGITS * float(np.ptp(mesh.nodes, axis=0).max())
    for backward, forward in (([first], [second]), seats):
        if len(backward) and len(forward):
            start, end = along[backward], along[forward]
            if max(end.min() - start.max(), start.min() - end.max()) > nothing:
                return float(np.sign(end.mean() - start.mean()))
    if not all(map(len, seats)):
        return 1.0
    start, end = (along[nodes] for nodes in _bodies_at(mesh, seats, component))
    apart = (end.min() + end.max() - start.min() - start.max()) / 2
    return float(np.sign(apart)) if abs(apart) > nothing else 1.0


def _bodies_at(mesh: Mesh, seats: Seats, component: int) -> list[Indices]:
    """Return the nodes of the bodies of each seat, across the spring as far as elements there."""
    touched = np.zeros(len(mesh.nodes), dtype=bool)
    touched[np.concatenate(seats)] = True
    around = [block.nodes[touched[block.nodes].any(axis=1)].ravel() for block in mesh.blocks]
    across = np.delete(mesh.nodes, component, axis=1)
    reach = across[np.concatenate([*seats, *around])]
    inside = ((across >= reach.min(axis=0)) & (across <= reach.max(axis=0))).all(axis=1)
    return [np.flatnonzero(inside & np.isin(mesh.bodies, mesh.bodies[seat])) for seat in seats]


def check_not_twice(seats: Mapping[str, Seats]) -> None:
    """Refuse two bolts that sit on the same faces at both ends, which would both pull."""
    names = [name for name, ends in seats.items() if all(map(len, ends))]
    for number, name in enumerate(names):  # bolts, of which there are few
        for first in names[:number]:
            if _same(seats[name], seats[first]):
                message = (
                    f"bolts '{first}' and '{name}' hold the same nodes at both ends, so that both "
                    "would clamp the joint: one of them is already in the source; to change the "
                    "preload of a bolt of the source, use its name"
                )
                raise ModelError(message)


def _same(first: Seats, second: Seats) -> bool:
    return any(
        all(_shared(seat, end) for seat, end in zip(first, order, strict=True))
        for order in (second, second[::-1])
    )


def _shared(first: Indices, second: Indices) -> bool:
    return len(np.intersect1d(first, second)) > _SAME_SEAT * min(len(first), len(second))
