"""Relative displacements of two sides, and their components along the normals."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.digits import DECK_DIGITS, SOLVED
from faying.model.dofs import DofMap


def relative_displacement(dofs: DofMap, pairs: Indices) -> SparseMatrix:
    """Return the operator (3 n_pair, n_dof) of u⁺ − u⁻ at node pairs, pair by pair."""
    minus, plus = ((6 * nodes[:, None] + np.arange(3)).ravel() for nodes in pairs.T)
    difference = (dofs.transformation[plus] - dofs.transformation[minus]).tocsr()
    difference.eliminate_zeros()
    return difference


def combined_displacement(dofs: DofMap, factors: SparseMatrix) -> SparseMatrix:
    """Return the operator (3 n, n_dof) of sums of translations with factors (n, n_node)."""
    entries = factors.tocoo()
    component = np.arange(3)
    rows = (3 * entries.row[:, None] + component).ravel()
    columns = (6 * entries.col[:, None] + component).ravel()
    shape = (3 * factors.shape[0], 6 * factors.shape[1])
    spread = sp.csr_array((np.repeat(entries.data, 3), (rows, columns)), shape=shape)
    combined = (spread @ dofs.transformation).tocsr()
    combined.eliminate_zeros()
    return combined


def common_normal(
    normals: Matrix, weights: Vector, pair_normals: Matrix
) -> tuple[Matrix, Matrix, bool]:
    """Replace all normals by their mean where they agree; return whether they did.

    Normals of points are (n_point, 3) with weights (n_point,), those of pairs (n_pair, 3).
    """
    total = (weights @ normals)[None]
    if not total.any():  # as of both faces of a plate
        return normals, pair_normals, False
    mean = unit(total)
    every = np.concatenate([normals, pair_normals])
    if np.linalg.norm(every - mean, axis=1).max() > DECK_DIGITS:
        return normals, pair_normals, False
    # Round-off of a vanishing component would couple independent directions.
    mean = unit(np.where(np.abs(mean) < 1e-14, 0.0, mean))
    return (
        np.broadcast_to(mean, normals.shape),
        np.broadcast_to(mean, pair_normals.shape),
        True,
    )


def axes_of(shape: SparseMatrix, normals: Matrix, fewest: int = 1) -> SparseMatrix:
    """Return orthonormal rows (n_axis, 3 n_pair) that span the normals of the points of each pair.

    The shape (n_point, n_pair) tells on which pairs a point depends along its normal (n_point, 3).
    A pair has at least the fewest rows, a normal first: as many as points have components.

    Notes
    -----
    Gram and Schmidt: the longest remainder of a normal outside the axes so far is the next axis.
    """
    entries = shape.tocoo()
    used = np.flatnonzero(entries.data)
    order = used[np.argsort(entries.col[used], kind="stable")]
    pairs, first = np.unique(entries.col[order], return_index=True)
    counts = np.diff(first, append=len(order))
    remainder, axes = normals[entries.row[order]], list[Matrix]()
    for _ in range(3):
        lengths = np.linalg.norm(remainder, axis=1)
        longest = np.maximum.reduceat(lengths, first) if len(first) else lengths
        # The first of equals, so that the axes do not depend on round-off.
        candidates_near = np.flatnonzero(lengths >= np.repeat(longest, counts) * (1 - SOLVED))
        chosen = candidates_near[np.searchsorted(candidates_near, first)]
        length = np.where(longest > SOLVED, longest, np.inf)
        axis = remainder[chosen] / length[:, None]
        # A second projection removes the round-off of short remainders along earlier axes.
        for axis_before in axes:
            axis = axis - np.einsum("kd,kd->k", axis, axis_before)[:, None] * axis_before
        norm = np.linalg.norm(axis, axis=1, keepdims=True)
        axis = axis / np.where(norm > 0, norm, 1.0)
        axes.append(axis)
        spread = np.repeat(axis, counts, axis=0)
        remainder = remainder - np.einsum("kd,kd->k", remainder, spread)[:, None] * spread
    every = np.stack(axes, axis=1)
    second = every[:, 1].any(axis=1, keepdims=True)
    beside = np.where(second, every[:, 1], tangents_of(every[:, 0]))
    across = np.stack([beside, np.cross(every[:, 0], beside)], axis=1)
    every[:, 1:fewest] = across[:, : fewest - 1]
    owners, which = np.nonzero(every.any(axis=2))
    rows = np.repeat(np.arange(len(owners)), 3)
    columns = (3 * pairs[owners][:, None] + np.arange(3)).ravel()
    data = every[owners, which].ravel()
    result = sp.csr_array((data, (rows, columns)), shape=(len(owners), 3 * shape.shape[1]))
    result.eliminate_zeros()
    return result


def times_normals(shape: SparseMatrix, normals: Matrix) -> SparseMatrix:
    """Return N n (n_point, 3 n_pair) from N (n_point, n_pair), with columns pair by pair."""
    entries = shape.tocoo()
    rows = np.repeat(entries.row, 3)
    columns = (3 * entries.col[:, None] + np.arange(3)).ravel()
    data = (entries.data[:, None] * normals[entries.row]).ravel()
    result = sp.csr_array((data, (rows, columns)), shape=(shape.shape[0], 3 * shape.shape[1]))
    result.eliminate_zeros()
    return result


def unit(vectors: Matrix) -> Matrix:
    """Return vectors (n, 3) scaled to length one."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def tangents_of(normals: Matrix) -> Matrix:
    """Return a unit tangent for each normal (n, 3), the same for equal normals."""
    axes = np.eye(3)[np.abs(normals).argmin(axis=1)]
    return unit(np.cross(np.cross(normals, axes), normals))
