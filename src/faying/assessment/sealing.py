"""Sealing: how well the closed ring around a hole of an interface is pressed.

A fluid inside the hole leaks along the path whose largest pressure is smallest; that pressure is
also the smallest one on the best closed ring around the hole, for every path crosses every ring.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import ModelError
from faying.interface.surface import ContactSurface
from faying.model.elements import FACES

MOST_NUMBERS = 2_000_000
"""Numbers of all links and cases in memory at a time."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ring:
    """The nodes of an interface around a hole, and which are next to each other.

    Attributes
    ----------
    points
        Of the interface, among all contact points.
    averaging : (n_node, n_point) sparse
        From pressures of points to nodal averages.
    links : (n_link, 2)
        Neighbours: a node, increasing, and one that shares a facet with it; every node is its own.
    inside, outside : (n,)
        Nodes on the edge of the hole, and on all other edges.
    """

    points: slice
    averaging: sp.csr_array
    links: Indices
    inside: Indices
    outside: Indices


def ring_around(surface: ContactSurface, around: Sequence[float]) -> Ring:
    """Return the nodes around the hole of an interface whose edge is nearest to a point."""
    rows = _pair_rows(surface)
    edges, links = [], [np.repeat(np.arange(len(surface.pairs))[:, None], 2, axis=1)]
    for pairs in surface.faces:
        nodes, corners = rows[pairs.minus], FACES[pairs.kind].n_corners
        width = nodes.shape[1]
        first, second = np.divmod(np.arange(width**2), width)
        links.append(np.stack([nodes[:, first], nodes[:, second]], axis=2).reshape(-1, 2))
        starts, following = nodes[:, :corners], np.roll(nodes[:, :corners], -1, axis=1)
        # Mid-side nodes belong to the edge of the corners before and behind them.
        middle = nodes[:, corners : 2 * corners] if width > corners else starts
        edges.append(np.stack([starts, following, middle], axis=2).reshape(-1, 3))
    rim = _rim(np.concatenate(edges))
    loop = _loops(rim, len(surface.pairs))
    distance = np.linalg.norm(surface.pair_points - np.asarray(around, dtype=float), axis=1)
    on_rim = np.flatnonzero(loop >= 0)
    nearest = loop[on_rim[distance[on_rim].argmin()]]
    outside = np.flatnonzero((loop >= 0) & (loop != nearest))
    if not len(outside):
        position = ", ".join(f"{x:g}" for x in around)
        message = (
            f"the edge of the interface nearest to ({position}) is its only one, so no ring goes "
            "around a hole there; give a point inside a hole"
        )
        raise ModelError(message)
    return Ring(
        points=slice(*surface.slice),
        averaging=sp.csr_array(surface.averaging),
        links=np.unique(np.concatenate(links), axis=0),
        inside=np.flatnonzero(loop == nearest),
        outside=outside,
    )


def ring_pressure(ring: Ring, pressure: Matrix) -> Vector:
    """Return the smallest pressure on the best ring (n_case,) [force/length²].

    Pressures (n_case, n_point) are those of all contact points.

    Notes
    -----
    From the edge of the hole outwards each node takes the smallest maximum of the paths to it,
    until none changes: as many passes over all links as the longest such path has nodes.
    """
    nodal = np.asarray((ring.averaging @ pressure[:, ring.points].T).T)
    parts = max(1, len(nodal) * len(ring.links) // MOST_NUMBERS)
    barriers = [_least_barrier(ring, part) for part in np.array_split(nodal, parts)]
    return np.concatenate(barriers)


def _least_barrier(ring: Ring, nodal: Matrix) -> Vector:
    """Return the smallest maximum of nodal pressures on paths from inside to outside (n_case,)."""
    starts = np.flatnonzero(np.diff(ring.links[:, 0], prepend=-1))
    barrier = np.full(nodal.shape, np.inf)
    barrier[:, ring.inside] = nodal[:, ring.inside]
    while True:
        neighbours = np.minimum.reduceat(barrier[:, ring.links[:, 1]], starts, axis=1)
        better = np.maximum(neighbours, nodal)
        if np.array_equal(better, barrier):
            return np.asarray(barrier[:, ring.outside].min(axis=1))
        barrier = better


def _pair_rows(surface: ContactSurface) -> Indices:
    """Return the row among the pairs of each minus node; -1 of all others."""
    rows = np.full(int(surface.pairs[:, 0].max()) + 1, -1, dtype=np.int64)
    rows[surface.pairs[:, 0]] = np.arange(len(surface.pairs))
    return rows


def _rim(edges: Indices) -> Indices:
    """Return the edges (n, 3) that belong to one facet only."""
    ends = np.sort(edges[:, :2], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    single = edges[first[count == 1]]
    rim: Indices = single[single[:, 0] != single[:, 1]]
    return rim


def _loops(rim: Indices, n_node: int) -> Indices:
    """Return the number of the closed edge that nodes (n_node,) lie on; -1 where on none."""
    rows = np.concatenate([rim[:, [0, 1]], rim[:, [0, 2]]])
    graph = sp.coo_array((np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(n_node, n_node))
    _, label = connected_components(graph.tocsr(), directed=False)
    on = np.zeros(n_node, dtype=bool)
    on[rim.ravel()] = True
    return np.where(on, label, -1)
