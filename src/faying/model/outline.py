"""The edges of facets, and those that bound a surface."""

from collections.abc import Sequence

import numpy as np

from faying._typing import Indices, Matrix
from faying.model.elements import FACES


def outline_of(facets: Sequence[tuple[str, Indices]], points: Matrix) -> Matrix:
    """Return the edges (n_edge, 2, 3) that bound facets, given by kind and indices of points."""
    edges = []
    for kind, nodes in facets:
        ring = nodes[:, list(FACES[kind].ring)]
        edges.append(np.stack([ring, np.roll(ring, -1, axis=1)], axis=-1).reshape(-1, 2))
    joined = np.concatenate([*edges, np.empty((0, 2), dtype=np.int64)])
    if not len(joined):
        return np.empty((0, 2, 3))
    _, first, counts = np.unique(
        np.sort(joined, axis=1), axis=0, return_index=True, return_counts=True
    )
    bounding: Matrix = points[joined[first[counts == 1]]]
    return bounding
