"""Averages of values at contact points over node pairs, with positive weights.

A pair takes the mean of the points near it, weighted with w φ²: w is the area of a point, φ the
shape function of the pair there, where that is positive. Shape functions of quadratic facets are
negative near the far corners, which must not count. A corner without such points (under nodal
quadrature six-node triangles have points at their mid-sides alone) takes for φ the linear function
that is one there and zero at its neighbours: in triangles the mean of the mid-sides next to it.
"""

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, SparseMatrix, Vector, read_only
from faying.interface.facets import reference_nodes, shape_functions
from faying.model.elements import FACES


def averaging_operator(
    shape: SparseMatrix, weights: Vector, facets: Sequence[tuple[str, Indices]]
) -> SparseMatrix:
    """Return the operator (n_pair, n_point) from values at contact points to averages at the pairs.

    No entry is negative and the sum of every row is one. Shape functions of the pairs at the points
    are (n_point, n_pair), weights (n_point,) [length²]; facets are kinds with pairs (n_face,
    n_node_per_face).
    """
    values = shape.maximum(0.0)
    unseen = np.asarray(values.sum(axis=0)).ravel() == 0
    if unseen.any():
        columns = np.flatnonzero(unseen)
        ones = np.ones(len(columns))
        indices = (np.arange(len(columns)), columns)
        into = sp.csr_array((ones, indices), shape=(len(columns), shape.shape[1]))
        values = values + shape @ corner_functions(facets, shape.shape[1])[:, columns] @ into
    share = values.power(2).multiply(weights[:, None]).T.tocsr()
    total = np.asarray(share.sum(axis=1)).ravel()
    share.data /= np.repeat(total, np.diff(share.indptr))
    return read_only(share)


def corner_functions(facets: Sequence[tuple[str, Indices]], n_pair: int) -> SparseMatrix:
    """Return the linear functions of all corners at the pairs (n_pair, n_pair).

    They are the shape functions of the facets without mid-sides. The column of a corner is one at
    this corner and 1/2 at the mid-sides next to it; columns of mid-sides are empty.
    """
    rows, columns, values = [], [], []
    for kind, pairs in facets:
        linear = shape_functions(FACES[kind].linear, reference_nodes(kind))
        node, corner = np.nonzero(linear)
        rows.append(pairs[:, node].ravel())
        columns.append(pairs[:, corner].ravel())
        values.append(np.tile(linear[node, corner], len(pairs)))
    positions = np.concatenate(rows) * n_pair + np.concatenate(columns)
    # Facets that share an edge give the same values there.
    unique, first = np.unique(positions, return_index=True)
    entries = np.concatenate(values)[first]
    return sp.csc_array((entries, np.divmod(unique, n_pair)), shape=(n_pair, n_pair))


def facet_columns(pairs: Indices, minus: Indices, plus: Indices) -> Indices:
    """Return the numbers of the pairs at the nodes of facets, in the shape of ``minus``.

    ``pairs`` (n_pair, 2) are nodes of the minus and the plus side; ``minus`` and ``plus`` those of
    facets.
    """
    width = int(pairs.max()) + 1
    keys = pairs[:, 0] * width + pairs[:, 1]
    order = np.argsort(keys, kind="stable")
    return order[np.searchsorted(keys[order], minus * width + plus)]
