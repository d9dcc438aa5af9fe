"""Means over many nodes, as means of groups of nodes.

The rigid motion of nodes in the mean is up to six equations E x = 0. Solved for components of a
few nodes, they fill K between all others. In a group c of nodes of a body, components e are
replaced by z,

    x_e = E_e⁻¹ (E_c R_c R_e⁻¹ z − E_o x_o),   so that   E_c x_c = E_c R_c R_e⁻¹ z,

with o the others of the group and R the rigid motions of its components. If the group is rigid,
z = x_e. Equations between all z are of the same kind. Groups are as large as there are z, which
fills least; groups of groups would fill less, and lose digits.
"""

import numpy as np
import scipy.linalg

from faying._typing import Indices, Matrix
from faying.digits import SHOWN_DIGITS
from faying.model.rigid_motion import rigid_motions

Part = tuple[Indices, Indices, Matrix]
"""Replaced components, those they depend on, and factors (n_replaced, n)."""

GROUP = 4
"""Least components of a group over its equations: fewer nodes often lie on one line."""


def grouped(
    equations: Matrix, points: Matrix, components: Indices, bodies: Indices
) -> tuple[list[Part], Matrix]:
    """Return replaced columns of each group, columns they depend on, factors; and new equations.

    Equations are (m, n), points (n, 3), components and bodies (n,) those of the columns. Bodies
    below zero are not grouped. New equations are zero at columns that are replaced by none.
    """
    parts, left, m = [], equations.copy(), len(equations)
    for body in np.unique(bodies[bodies >= 0]).tolist():
        members = np.flatnonzero((bodies == body) & equations.any(axis=0))
        size = max(int(np.sqrt(m * len(members))), GROUP * m)
        for group in np.array_split(members, max(len(members) // size, 1)):
            if len(group) < size:
                continue
            own, motions = equations[:, group], _motions(points[group], components[group])
            chosen = scipy.linalg.qr(_scaled(own, 1), mode="r", pivoting=True)[1][:m]
            if motions.shape[1] != m or not all(
                map(_is_firm, (own[:, chosen], motions[chosen], own @ motions))
            ):
                continue
            others = np.setdiff1d(np.arange(len(group)), chosen)
            means = np.linalg.solve(motions[chosen].T, (own @ motions).T).T
            factors = np.linalg.solve(own[:, chosen], np.hstack([means, -own[:, others]]))
            parts.append((group[chosen], group[np.concatenate([chosen, others])], factors))
            left[:, group] = 0.0
            left[:, group[chosen]] = means
    return parts, left


def _motions(points: Matrix, components: Indices) -> Matrix:
    """Return independent rigid motions (n, k <= 6)."""
    centre = points.mean(axis=0)
    motions = rigid_motions(points, components, centre)
    motions[:, 3:] /= np.linalg.norm(points - centre, axis=1).max() or 1.0
    left, size, _ = np.linalg.svd(motions, full_matrices=False)
    return left[:, size > SHOWN_DIGITS * size[0]]


def _scaled(matrix: Matrix, axis: int) -> Matrix:
    largest = np.abs(matrix).max(axis=axis, keepdims=True)
    return np.asarray(matrix / np.where(largest > 0, largest, 1.0))


def _is_firm(square: Matrix) -> bool:
    size = np.linalg.svd(_scaled(_scaled(square, 1), 0), compute_uv=False)
    return bool(size[-1] > SHOWN_DIGITS * size[0])
