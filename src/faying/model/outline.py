"""Boundary edges of facets."""

from collections.abc import Sequence

import numpy as np

from faying._typing import Indices, Matrix
from faying.model.elements import FACES


def outline_of(facets: Sequence[tuple[str, Indices]], points: Matrix) -> Matrix:
    """Return the edges (n_edge, 2, 3) that bound facets, given by kind and indices of points."""
    return points[bounding_edges(facets)]


def bounding_edges(facets: Sequence[tuple[str, Indices]]) -> Indices:
    """Return the edges (n_edge, 2) of single facets, given by kind and indices of points."""
    edges = [np.empty((0, 2), dtype=np.int64)]
    for kind, nodes in facets:
        ring = nodes[:, list(FACES[kind].ring)]
        edges.append(np.stack([ring, np.roll(ring, -1, axis=1)], axis=-1).reshape(-1, 2))
    joined = np.concatenate(edges)
    _, first, counts = np.unique(
        np.sort(joined, axis=1), axis=0, return_index=True, return_counts=True
    )
    single = joined[first[counts == 1]]
    return np.asarray(single[single[:, 0] != single[:, 1]])  # facets may have collapsed
