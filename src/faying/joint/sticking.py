"""Sticking friction: pairs under enough pressure are held tangentially by penalty springs."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Mask, SparseMatrix, Vector
from faying.exceptions import refuse_model
from faying.interface.interface import Interface


def stuck_pairs(interface: Interface, pressure: Vector, threshold: float) -> Mask:
    """Return the node pairs (n_pair,) that stick, §15.4.2 of the paper; none where all is open.

    Contact pressures (n_point,) [force/length²] are those of the preloaded state, positive in
    compression. A pair sticks if its pressure exceeds the threshold, a fraction of the largest
    nodal average: from 0 (every pair with pressure) up to but not including 1.
    """
    if not 0 <= threshold < 1:
        refuse_model(
            f"interface '{interface.name}': the sticking threshold is {threshold:g}; give a "
            "fraction of the largest preload pressure, at least 0 and below 1"
        )
    average = interface.nodal_average(pressure)
    return average > threshold * max(float(average.max()), 0.0)


def sticking_stiffness(interface: Interface, pairs: Mask, stiffness: float) -> SparseMatrix:
    """Return the stiffness of tangential springs at stuck pairs, §15.4.2 of the paper.

    Each pair has the stiffness k (I − n nᵀ) between its two nodes: k in both tangential directions,
    zero along the normal. Between non-matching meshes it acts on the projected relative
    displacement, and k is multiplied by the covered share of the facets around the node.

    Parameters
    ----------
    pairs : (n_pair,)
        From :func:`stuck_pairs`.
    stiffness : [force/length]
        k per pair.

    Returns
    -------
    csr_array (n_dof, n_dof)
        To be added to K; symmetric and positive semidefinite.

    Raises
    ------
    ModelError
        If the stiffness is not a positive number.
    """
    difference = interface.motion_operator[np.repeat(pairs, 3)]
    matrix = (difference.T @ sticking_forces(interface, pairs, stiffness)).tocsr()
    matrix.eliminate_zeros()
    return matrix


def sticking_forces(interface: Interface, pairs: Mask, stiffness: float) -> SparseMatrix:
    """Return the rows (3 n_stuck, n_dof) of forces in the springs of :func:`sticking_stiffness`.

    They pull the plus side back to the minus side: three components for each pair, of the force of
    the plus side on the springs.
    """
    if not 0 < stiffness < np.inf:
        refuse_model(
            f"interface '{interface.name}': the sticking stiffness is {stiffness:g}; give a "
            "positive number [force/length]"
        )
    difference = interface.motion_operator[np.repeat(pairs, 3)]
    normals = interface.pair_normals[pairs]
    tangential = stiffness * (np.eye(3) - normals[:, :, None] * normals[:, None, :])
    if interface.coupling is not None:
        # A node in contact with a mere corner of its facets has no stiffness.
        tangential *= interface.coupling.coverage[pairs][:, None, None]
    blocks = np.arange(len(normals))
    springs = sp.bsr_array(
        (tangential, blocks, np.arange(len(normals) + 1)), shape=(3 * len(normals),) * 2
    )
    return (springs @ difference).tocsr()
