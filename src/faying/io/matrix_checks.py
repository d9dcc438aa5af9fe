"""Checks of mass, damping and stiffness matrices; every message names row and node."""

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Indices, Mask, Matrix, SparseMatrix
from faying.digits import DECK_DIGITS, ROUND_OFF
from faying.exceptions import ModelError, refuse_model


class RowLabel:
    """Labels of matrix rows for messages: node and component."""

    def __init__(self, ids: Indices, components: Indices) -> None:
        self.ids, self.components = ids, components

    def __len__(self) -> int:
        return len(self.ids)

    def __call__(self, row: int) -> str:
        """Return the row number from 1, node id and component 1..6."""
        labelled = row < len(self)
        label = f", node {self.ids[row]} component {self.components[row] + 1}" if labelled else ""
        return f"row {row + 1}{label}"


def checked_matrix(name: str, matrix: Any, label: RowLabel) -> SparseMatrix:
    """Return a real, finite, square matrix of the size of the dof table, in CSR form."""
    shape = np.shape(matrix) if not sp.issparse(matrix) else matrix.shape
    if len(shape) != 2 or shape[0] != shape[1]:
        refuse_model(f"matrix {name} has shape {tuple(shape)}; it must be square")
    if shape[0] != len(label):
        refuse_model(
            f"matrix {name} has {shape[0]} rows but the dof table {len(label)}; each row of the "
            "table names one row of M, C and K"
        )
    if not sp.issparse(matrix):
        matrix = np.asarray(matrix)
    if matrix.dtype.kind not in "fiub":
        refuse_model(f"matrix {name} is of type {matrix.dtype}; it must be real")
    result = sp.csr_array(matrix, dtype=np.float64, copy=True)
    result.sum_duplicates()
    bad = np.flatnonzero(~np.isfinite(result.data))
    if bad.size:
        row = int(np.searchsorted(result.indptr, bad[0], side="right")) - 1
        column = int(result.indices[bad[0]])
        refuse_model(
            f"matrix {name}: entry ({row + 1}, {column + 1}) is {result.data[bad[0]]} "
            f"({label(row)}); it must be finite"
        )
    result.eliminate_zeros()
    return result


def symmetric_matrix(name: str, matrix: SparseMatrix, label: RowLabel) -> SparseMatrix:
    """Return the mean of a matrix and its transpose, which may differ by rounding only."""
    largest = float(np.abs(matrix.data).max(initial=0.0))
    difference = sp.coo_array(matrix - matrix.T)
    if not difference.nnz:
        return matrix
    worst = int(np.abs(difference.data).argmax())
    size = abs(float(difference.data[worst]))
    # Programs sum element matrices in varying order, and write six digits or more.
    if size <= DECK_DIGITS * largest:
        return sp.csr_array((matrix + matrix.T) * 0.5)
    row, column = sorted((int(difference.row[worst]), int(difference.col[worst])))
    if sp.triu(matrix, 1).nnz == 0 or sp.tril(matrix, -1).nnz == 0:
        remedy = "only one triangle is stored: add the transpose without the diagonal"
    else:
        remedy = "faying needs symmetric matrices (no follower forces, friction or gyroscopics)"
    message = (
        f"matrix {name} is not symmetric: entries ({row + 1}, {column + 1}) and its mirror "
        f"differ by {size:.3g} ({label(row)}; {label(column)}), {size / largest:.1g} of the "
        f"largest entry; {remedy}"
    )
    raise ModelError(message)


def check_mass(mass: SparseMatrix, label: RowLabel) -> None:
    """Refuse a mass matrix with a negative diagonal or no mass rᵀ M r along x, y or z."""
    diagonal = mass.diagonal()
    if len(diagonal) and diagonal.min() < 0:
        row = int(diagonal.argmin())
        refuse_model(
            f"matrix M: the diagonal is {diagonal[row]:g} at {label(row)}; masses must be positive"
        )
    for component in range(3):
        motion = (label.components == component).astype(np.float64)
        total = float(motion @ (mass @ motion))
        if motion.any() and not total > 0:
            axis = "xyz"[component]
            refuse_model(
                f"matrix M: the mass moving along {axis} is rᵀMr = {total:g}; it must be positive. "
                "Check that M and K are not swapped and that the dof table is in row order"
            )


def turning_nodes(K: SparseMatrix, nodes: Indices, components: Indices) -> Indices:
    """Find nodes whose rows, labelled as translations, are rotations.

    CalculiX has no rotational degrees of freedom: rotations of a rigid body, a coupling or a beam
    end are displacements of extra nodes.

    A translation of the whole structure meets no resistance and rotates nothing. If K resists
    a common motion of all rows labelled with one direction, some of these rows are no translations:
    the rows that stand still in the motion of least energy, if K does not resist that motion. K
    (n, n) is symmetric; rows have a node index and a component 0..5 (n,). Nodes next to supports
    are never returned.

    Notes
    -----
    One factorization of the rows around the resisting ones.
    """
    translation = components < 3
    rigid = np.stack([components == c for c in range(3)], axis=1).astype(float)
    resisted = _resisted(K, rigid).any(axis=1)
    suspects = np.setdiff1d(nodes[resisted], nodes[~translation])
    free = translation & np.isin(nodes, suspects)
    if not free.any():
        return suspects[:0]
    still = np.abs(_relaxed(K, rigid, free)) < DECK_DIGITS
    is_still = np.take_along_axis(still, np.minimum(components, 2)[:, None], axis=1)[:, 0]
    moving = nodes[free & ~is_still]
    turning = np.setdiff1d(suspects, moving)
    without = rigid * ~np.isin(nodes, turning)[:, None]
    wrong = nodes[_resisted(K, without).any(axis=1)]
    # Where all nodes are next to a support nothing moves, and rotations cannot be found.
    linked = nodes[(abs(K) @ without > 0).any(axis=1)]
    return np.intersect1d(np.setdiff1d(turning, wrong), linked)


def _resisted(K: SparseMatrix, motions: Matrix) -> Mask:
    """Return where K resists motions (n, k) by more than round-off."""
    force, size = K @ motions, abs(K) @ np.abs(motions)
    return np.asarray(np.abs(force) > DECK_DIGITS * size)


def _relaxed(K: SparseMatrix, motions: Matrix, free: Mask) -> Matrix:
    """Return motions (n, k) whose free rows minimize the energy."""
    inner = sp.csc_array(K[free][:, free])
    inner = inner + ROUND_OFF * float(K.diagonal().max()) * sp.eye_array(inner.shape[0])
    fixed = np.where(free[:, None], 0.0, motions)
    relaxed = motions.copy()
    relaxed[free] = -spla.splu(sp.csc_matrix(inner)).solve((K @ fixed)[free])
    return relaxed
