"""Rows that turn where their labels say that they move, as CalculiX writes rotations.

CalculiX has no rotational degrees of freedom: those of a rigid body, a coupling or a beam's end are
the displacements of nodes of their own. Read as displacements they are wrong in the mass of the
structure and in the names of what can be loaded there.
"""

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Indices, Mask, Matrix, SparseMatrix
from faying.digits import ROUND_OFF

_ROUNDING = 1e-6
"""Force of a rigid motion over the forces it is made of, below which it is none."""


def turning_nodes(K: SparseMatrix, nodes: Indices, components: Indices) -> Indices:
    """Find nodes whose rows, labelled as translations, are rotations.

    A translation of the whole structure meets no resistance, and nothing turns in it. Where all
    rows labelled with one direction move together and K resists, some of them do not belong to
    that motion: those that stand still in the motion of least energy, if K then resists no more.

    Parameters
    ----------
    K : (n, n)
        Symmetric.
    nodes, components : (n,)
        Node index and component 0..5 of each row.

    Returns
    -------
    ndarray
        Indices of nodes; nodes next to supports are never among them.

    Notes
    -----
    One factorization of the rows around what resists.
    """
    translation = components < 3
    rigid = np.stack([components == c for c in range(3)], axis=1).astype(float)
    resisted = _resisted(K, rigid).any(axis=1)
    suspects = np.setdiff1d(nodes[resisted], nodes[~translation])
    free = translation & np.isin(nodes, suspects)
    if not free.any():
        return suspects[:0]
    still = np.abs(_relaxed(K, rigid, free)) < _ROUNDING
    is_still = np.take_along_axis(still, np.minimum(components, 2)[:, None], axis=1)[:, 0]
    moving = nodes[free & ~is_still]
    turning = np.setdiff1d(suspects, moving)
    without = rigid * ~np.isin(nodes, turning)[:, None]
    wrong = nodes[_resisted(K, without).any(axis=1)]
    # Where everything is next to a support nothing is left that moves, and nothing can be said.
    linked = nodes[(abs(K) @ without > 0).any(axis=1)]
    labelled: Indices = np.intersect1d(np.setdiff1d(turning, wrong), linked)
    return labelled


def _resisted(K: SparseMatrix, motions: Matrix) -> Mask:
    """Tell where K resists motions (n, k) by more than round-off."""
    force, size = K @ motions, abs(K) @ np.abs(motions)
    resisted: Mask = np.abs(force) > _ROUNDING * size
    return resisted


def _relaxed(K: SparseMatrix, motions: Matrix, free: Mask) -> Matrix:
    """Return motions (n, k) with the free rows where they need the least energy."""
    inner = sp.csc_array(K[free][:, free])
    inner = inner + ROUND_OFF * float(K.diagonal().max()) * sp.eye_array(inner.shape[0])
    fixed = np.where(free[:, None], 0.0, motions)
    relaxed = motions.copy()
    relaxed[free] = -spla.splu(sp.csc_matrix(inner)).solve((K @ fixed)[free])
    return relaxed
