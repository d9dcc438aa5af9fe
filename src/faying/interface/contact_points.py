"""Contact points of an interface: positions, weights, and shape functions of the pairs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.interface.facets import Rule, shape_functions, surface


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactPoints:
    """Contact points: shape functions of the pairs (n_point, n_pair), geometry, owning facet."""

    shape: SparseMatrix
    points: Matrix
    weights: Vector
    normals: Matrix
    faces: Indices
    rule: str


def on_facets(
    kind: str,
    coordinates: Matrix,
    rule: Rule,
    faces: Indices,
    seen: str,
    columns: Indices,
    n_pair: int,
) -> ContactPoints:
    """Return the contact points of facets of one kind, from coordinates (n_face, n_node, 3).

    Their shape functions are of the kind ``seen``, for the pairs ``columns`` (n_face, n_seen).
    """
    geometry, shape = surface(kind, coordinates, rule), shape_functions(seen, rule.points)
    return ContactPoints(
        shape=spread(np.broadcast_to(shape, (len(columns), *shape.shape)), columns, n_pair),
        points=geometry.points.reshape(-1, 3),
        weights=geometry.areas.ravel(),
        normals=geometry.normals.reshape(-1, 3),
        faces=np.repeat(faces, len(rule.weights)),
        rule=rule.name,
    )


def spread(values: Matrix, columns: Indices, n_pair: int) -> SparseMatrix:
    """Return rows (n n_q, n_pair) from values (n, n_q, n_seen) for the pairs of each facet."""
    n, n_q, n_seen = values.shape
    rows = np.repeat(np.arange(n * n_q), n_seen)
    pairs = np.repeat(columns[:, None, :n_seen], n_q, axis=1).ravel()
    matrix = sp.csr_array((values.ravel(), (rows, pairs)), shape=(n * n_q, n_pair))
    # Round-off of shape functions that vanish at nodes would fill the matrix.
    matrix.data[np.abs(matrix.data) < 1e-14] = 0.0
    matrix.eliminate_zeros()
    return matrix


def joined(parts: Sequence[ContactPoints]) -> ContactPoints:
    """Return the points of all parts in sequence."""
    return ContactPoints(
        shape=sp.vstack([part.shape for part in parts]).tocsr(),
        points=np.concatenate([part.points for part in parts]),
        weights=np.concatenate([part.weights for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        faces=np.concatenate([part.faces for part in parts]),
        rule="+".join(dict.fromkeys(part.rule for part in parts)),
    )
