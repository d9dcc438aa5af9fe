"""Sealing: the pressure on the best closed ring around a hole of an interface.

A fluid inside the hole leaks along the path with the smallest maximum of pressure. That maximum is
also the smallest pressure on the best closed ring, since every path crosses every ring.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import refuse_model
from faying.interface.surface import ContactSurface, pair_facets
from faying.linalg.pieces import pieces
from faying.model.outline import bounding_edges


@dataclass(frozen=True, eq=False, kw_only=True)
class Ring:
    """The nodes of an interface around a hole, and their neighbours.

    Attributes
    ----------
    points
        Slice of the interface in all contact points.
    averaging : (n_node, n_point) sparse
        Map from pressures of points to nodal averages.
    links : (n_link, 2)
        A node, in ascending order, and one that shares a facet with it, or the node itself.
    inside, outside : (n,)
        Nodes on the edge of the hole, and on all other edges.
    """

    points: slice
    averaging: sp.csr_array
    links: Indices
    inside: Indices
    outside: Indices


def ring_around(surface: ContactSurface, around: Sequence[float]) -> Ring:
    """Return the nodes around the hole of an interface with the edge nearest to a point."""
    facets, every = pair_facets(surface), np.arange(len(surface.pairs))
    links = [np.repeat(every[:, None], 2, axis=1)]
    for _, nodes in facets:
        width = nodes.shape[1]
        first, second = np.divmod(np.arange(width**2), width)
        links.append(np.stack([nodes[:, first], nodes[:, second]], axis=2).reshape(-1, 2))
    loop = _loops(bounding_edges(facets), len(every))
    distance = np.linalg.norm(surface.pair_points - np.asarray(around, dtype=float), axis=1)
    on_rim = np.flatnonzero(loop >= 0)
    nearest = loop[on_rim[distance[on_rim].argmin()]]
    outside = np.flatnonzero((loop >= 0) & (loop != nearest))
    if not len(outside):
        position = ", ".join(f"{x:g}" for x in around)
        refuse_model(
            f"the edge of the interface nearest to ({position}) is its only one, so no ring goes "
            "around a hole there; give a point inside a hole"
        )
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
    From the edge of the hole outwards each node takes the smallest maximum over the paths to it,
    until none changes: as many passes over all links as the longest such path has nodes.
    """
    nodal = np.asarray((ring.averaging @ pressure[:, ring.points].T).T)
    parts = pieces(len(nodal), len(ring.links))
    return np.concatenate([np.empty(0), *(_least_barrier(ring, nodal[part]) for part in parts)])


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


def _loops(rim: Indices, n_node: int) -> Indices:
    """Return the number of the closed edge of each node (n_node,); -1 for nodes off edges."""
    graph = sp.coo_array((np.ones(len(rim)), tuple(rim.T)), shape=(n_node, n_node))
    _, label = connected_components(graph.tocsr(), directed=False)
    on = np.zeros(n_node, dtype=bool)
    on[rim.ravel()] = True
    return np.where(on, label, -1)
