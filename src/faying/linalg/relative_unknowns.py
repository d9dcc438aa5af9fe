"""Relative displacements as unknowns, and the structure after elimination of all others.

Where P (n_port, n) has a degree of freedom for each of its rows, P_D is regular, and with v all the
others

    u_D = P_D⁻¹ (y − P_v v),   y = P u,

maps unknowns v and y to displacements: y = 0 glues the two sides of a pair together. The stiffness
between the ports, the inverse of their compliance P A⁻¹ Pᵀ, is the Schur complement of v,

    Σ = A_yy − A_yv A_vv⁻¹ A_vy,                                                              (F14)

in which soft springs beneath the pairs cost no digits.
"""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components, min_weight_full_bipartite_matching

from faying._typing import Indices, SparseMatrix

MOST_TOGETHER = 60
"""Largest number of rows of P with common degrees of freedom that are inverted as one block.

Three for a pair, and a few pairs where edges of bodies meet.
"""

STEEPEST = 100.0
"""Largest allowed entry of P_D⁻¹ over that for a single row: two of sixteen digits."""


def with_relative_unknowns(ports: SparseMatrix) -> SparseMatrix | None:
    """Return the map from [v, y] to displacements (n, n); None if rows share their dofs.

    Notes
    -----
    Of all choices D, the one with the largest product of entries of P, one for each row. Columns
    that differ in sign alone belong to the two sides of a pair: one of them is enough.
    """
    n_port, n = ports.shape
    felt = np.abs(ports.T @ np.random.default_rng(0).standard_normal(n_port))
    felt, columns = np.unique(felt, return_index=True)
    candidates = np.sort(columns[felt > 0])
    entries = sp.coo_array(ports[:, candidates])
    used = entries.data != 0
    sizes = np.abs(entries.data[used])
    weights = 1.0 + np.log(sizes.max(initial=0.0) / sizes)
    graph = sp.csr_array((weights, tuple(c[used] for c in entries.coords)), shape=entries.shape)
    try:
        _, matched = min_weight_full_bipartite_matching(graph)
    except ValueError:  # there is no such choice
        return None
    if len(matched) < n_port:
        return None
    own = candidates[matched]
    turned = _inverse_by_blocks(ports[:, own].tocsr())
    if turned is None or abs(turned).max() * sizes.min() > STEEPEST:
        return None
    others = np.setdiff1d(np.arange(n), own)
    if not len(others):
        return None
    shared = -(turned @ ports[:, others])
    rows = sp.vstack(
        [
            sp.hstack([sp.eye_array(len(others)), sp.csr_array((len(others), n_port))]),
            sp.hstack([shared, turned]),
        ],
        format="csr",
    )
    places = np.empty(n, dtype=np.int64)
    places[np.concatenate([others, own])] = np.arange(n)
    return rows[places]


def _inverse_by_blocks(matrix: SparseMatrix) -> SparseMatrix | None:
    """Return the inverse of a matrix of small decoupled blocks; None if they are large."""
    count, block = connected_components(matrix, directed=False)
    sizes = np.bincount(block, minlength=count)
    width = int(sizes.max(initial=0))
    if width > MOST_TOGETHER:
        return None
    order = np.argsort(block, kind="stable")
    place: Indices = np.empty(len(block), dtype=np.int64)
    place[order] = np.arange(len(block)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    members = np.full((count, width), -1)
    members[block, place] = np.arange(len(block))
    blocks = np.where(members < 0, 1.0, 0.0)[:, :, None] * np.eye(width)
    entries = sp.coo_array(matrix)
    row, column = entries.coords
    blocks[block[row], place[row], place[column]] = entries.data
    try:
        inverses = np.linalg.inv(blocks)
    except np.linalg.LinAlgError:
        return None
    stored = (members[:, :, None] >= 0) & (members[:, None, :] >= 0) & (inverses != 0)
    at_block, row, column = np.nonzero(stored)
    where = members[at_block, row], members[at_block, column]
    return sp.csr_array((inverses[stored], where), shape=matrix.shape)
