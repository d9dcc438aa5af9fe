"""The seats of a bolt at its two ends: clamping, direction of the pull, and repeated bolts."""

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, Beam, Spring
from faying.model.links import joined_nodes
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec

_SMALLEST_DEPTH = 1e-2
"""Distance from a seat, over the length of a bolt, below which a node is not between the seats.

Bodies in the plane of a seat touch it, and seats deviate from a plane by up to a percent.
"""


def check_clamping(mesh: Mesh, spec: BoltSpec, seats: tuple[Indices, Indices]) -> None:
    """Refuse a bolt through one body only, unless another part is between the arms of a fork.

    ``seats`` are the nodes of solids under the head and the nut.
    """
    labels = mesh.bodies
    head, nut = (np.unique(labels[seat]) for seat in seats)
    if not len(head) or not len(nut) or not np.array_equal(head, nut):
        return
    if np.setdiff1d(labels[_nodes_between(mesh, spec, seats)], [-1, *head]).size:
        return
    nodes = ", ".join(map(str, mesh.node_ids[np.unique(np.concatenate(seats))][:4].tolist()))
    refuse_model(
        f"bolt '{spec.name}' clamps nothing: head and nut hold the same body (at nodes {nodes}, …) "
        "with no other between them; give parts nodes of their own where they touch (separate of "
        "[model], for a mesh file)"
    )


def element_seats(assembly: Assembly, cut: Beam | Spring) -> tuple[Indices, Indices]:
    """Return the nodes of solids at the two ends of a deck's bolt, separately.

    Ends are followed through beams, springs, couplings and equations to the first solids, but not
    through the cut element and others between the same two nodes (its shear and bending springs).
    If such springs have nodes of their own (CalculiX's rotation nodes), a path around the cut
    remains and head and nut cannot be told apart; the result is then empty.
    """
    first, second = cut.nodes if isinstance(cut, Beam) else (node for node, _ in cut.ends)
    links = _links(assembly, (first, second))
    solid = assembly.mesh.bodies >= 0
    of_node, through = links.tocsc(), links[:, np.flatnonzero(~solid)]
    _, group = connected_components(through @ through.T, directed=False)

    def groups(node: int) -> Indices:
        at_node = of_node.indices[of_node.indptr[node] : of_node.indptr[node + 1]]
        return np.unique(group[at_node])

    def reached(node: int) -> Indices:
        if solid[node]:
            return np.array([node])
        nodes = np.unique(links[np.flatnonzero(np.isin(group, groups(node)))].indices)
        return np.asarray(nodes[solid[nodes]])

    if not solid[[first, second]].any() and np.isin(groups(first), groups(second)).any():
        nothing = np.empty(0, dtype=np.int64)
        return nothing, nothing
    return reached(first), reached(second)


def _links(assembly: Assembly, cut: tuple[int, int]) -> SparseMatrix:
    """Return the nodes (n_link, n_node) joined by each beam, spring, coupling and equation."""
    parts = [nodes for _, nodes in joined_nodes(assembly)]
    parts += [shell for block in assembly.shells for shell in block.nodes]
    parts = [part for part in parts if np.setdiff1d(part, cut).size]
    columns = np.concatenate([np.empty(0, dtype=np.int64), *parts])
    rows = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    shape = (len(parts), len(assembly.mesh.nodes))
    return sp.csr_array((np.ones(len(columns)), (rows, columns)), shape=shape)


def _nodes_between(mesh: Mesh, spec: BoltSpec, seats: tuple[Indices, Indices]) -> Indices:
    """Return the nodes inside the cylinder from seat to seat."""
    ends = np.array([mesh.nodes[seat].mean(axis=0) for seat in seats])
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length == 0:
        return np.empty(0, dtype=np.int64)
    axis = (ends[1] - ends[0]) / length
    along, radial = _cylindrical(mesh.nodes, ends[0], axis)
    radius = max(spec.washer_radius or 0.0, float(radial[np.concatenate(seats)].max()))
    # A beam may end at a single node of a solid, which gives no thickness.
    radius = radius if radius > _SMALLEST_DEPTH * length else length / 2
    inside = (along > _SMALLEST_DEPTH * length) & (along < (1 - _SMALLEST_DEPTH) * length)
    return np.flatnonzero(inside & (radial <= radius))


def _cylindrical(points: Matrix, origin: Vector, axis: Vector) -> tuple[Vector, Vector]:
    """Return the distances of points (n, 3) along an axis and from it."""
    relative = points - origin
    along = relative @ axis
    return along, np.linalg.norm(relative - np.outer(along, axis), axis=1)


Seats = tuple[Indices, Indices]
"""Nodes of solids at the two ends of a bolt."""


_SAME_SEAT = 0.5
"""Common share of the smaller seat above which two bolts are on the same seat."""


def spring_sense(assembly: Assembly, spring: Spring, seats: Seats) -> float:
    """Return 1 if the spring grows longer when its second end moves forward, else -1.

    Ends at different positions determine this themselves. If they coincide, as at a cut through a
    bolt, their seats do: the end whose seat lies farther along the spring's direction is the
    forward one, in either order of the deck. If the seats lie beside each other, as the threads of
    a bolt and its nut, the middle of their bodies there decides. The default is 1.
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
    """Return nodes of the bodies of each seat, across the spring as far as their elements reach."""
    touched = np.zeros(len(mesh.nodes), dtype=bool)
    touched[np.concatenate(seats)] = True
    around = [block.nodes[touched[block.nodes].any(axis=1)].ravel() for block in mesh.blocks]
    across = np.delete(mesh.nodes, component, axis=1)
    reach = across[np.concatenate([*seats, *around])]
    inside = ((across >= reach.min(axis=0)) & (across <= reach.max(axis=0))).all(axis=1)
    return [np.flatnonzero(inside & np.isin(mesh.bodies, mesh.bodies[seat])) for seat in seats]


def check_not_twice(seats: Mapping[str, Seats]) -> None:
    """Refuse two bolts on the same faces at both ends, which would both pull."""
    names = [name for name, ends in seats.items() if all(map(len, ends))]
    for number, name in enumerate(names):  # bolts, of which there are few
        for first in names[:number]:
            if _same_seats(seats[name], seats[first]):
                refuse_model(
                    f"bolts '{first}' and '{name}' hold the same nodes at both ends, so that both "
                    "would clamp the joint: one of them is already in the source; to change the "
                    "preload of a bolt of the source, use its name"
                )


def _same_seats(first: Seats, second: Seats) -> bool:
    return any(
        all(_share_seat(seat, end) for seat, end in zip(first, order, strict=True))
        for order in (second, second[::-1])
    )


def _share_seat(first: Indices, second: Indices) -> bool:
    return len(np.intersect1d(first, second)) > _SAME_SEAT * min(len(first), len(second))
