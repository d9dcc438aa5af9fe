"""Few unknowns that connect two parts of a sparse matrix."""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components, dijkstra

from faying._typing import Indices, Mask, SparseMatrix, Vector
from faying.linalg.blocks import node_blocks

HUB = 2
"""Over the usual number of neighbours: from here on a node is one that a coupling refers to."""

EVEN = 0.1
"""How far from one half the share of a part may be, for a smaller separator."""

SEARCHES = 3
"""From an end to the one farthest from it; two or three reach the longest way."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Separator:
    """Unknowns without which a matrix falls into two parts.

    Attributes
    ----------
    unknowns, first, second
        Of the separator and of both parts, ascending; only the separator may be empty.
    """

    unknowns: Indices
    first: Indices
    second: Indices


def separator(A: SparseMatrix, weighted: Mask) -> Separator | None:
    """Return what separates A (n, n) into parts that hold about as many weighted unknowns (n,).

    Nodes that many others refer to (ends of bolts, references of couplings) where bodies fall
    apart without them; else nodes as far from one end as from the other.

    Notes
    -----
    Breadth-first searches between nodes. None where nothing is found that separates.
    """
    blocks = node_blocks(A)
    size, n = blocks.blocksize[0], A.shape[0]
    pattern = (np.ones(len(blocks.indices)), blocks.indices, blocks.indptr)
    graph = sp.csr_array(pattern, shape=(len(blocks.indptr) - 1,) * 2)
    side = _bodies(graph)
    if side is None:
        weights = np.add.reduceat(weighted.astype(float), np.arange(0, n, size))
        side = _halves(graph, weights)
    sides = np.repeat(side, size)[:n]
    unknowns, first, second = (np.flatnonzero(sides == which) for which in (0, -1, 1))
    if not (len(first) and len(second)):
        return None
    return Separator(unknowns=unknowns, first=first, second=second)


def _bodies(graph: SparseMatrix) -> Indices | None:
    """Return 0 for hubs, -1 for one body and 1 for all others, if there are several."""
    neighbours = np.diff(graph.indptr)
    plain = np.flatnonzero(neighbours <= HUB * np.median(neighbours))
    count, body = connected_components(graph[plain][:, plain], directed=False)
    if count < 2:
        return None
    side = np.zeros(len(neighbours), dtype=np.int64)
    side[plain] = np.where(body == np.bincount(body).argmax(), -1, 1)
    return side


def _halves(graph: SparseMatrix, weights: Vector) -> Indices:
    """Return 0 for nodes at one distance from an end, -1 for those nearer and 1 for others."""
    start = np.zeros(1, dtype=np.int64)
    for _ in range(SEARCHES):
        distance = dijkstra(graph, unweighted=True, indices=start, min_only=True)
        distance[np.isinf(distance)] = 0  # what nothing connects may be on any side
        start = np.flatnonzero(distance == distance.max())
    level = distance.astype(np.int64)
    count = np.bincount(level)
    weight = np.bincount(level, weights=weights)
    middle = (np.cumsum(weight) - weight / 2) / max(weight.sum(), 1.0)
    fit = np.flatnonzero(np.abs(middle - 0.5) <= EVEN)
    cut = fit[count[fit].argmin()] if len(fit) else np.abs(middle - 0.5).argmin()
    side: Indices = np.sign(level - cut)
    return side
