"""Bushes: six springs between two nodes, or a node and the ground, at one position.

The springs stretch with the motion of the second end relative to the first, both carried rigidly to
the position of the bush. A bush between distant nodes therefore transmits moments, and rigid
motions do not stretch it.
"""

from collections.abc import Sequence

import numpy as np

from faying._typing import Indices, Matrix
from faying.model.assembly import Bush
from faying.model.couplings.rows import lever_arms


def bush_matrices(bushes: Sequence[Bush], nodes: Matrix) -> tuple[Matrix, Matrix, Indices]:
    """Return masses, stiffnesses and degrees of freedom of bushes with equal numbers of ends.

    Nodes (n_node, 3) [length] are all nodes of the mesh; matrices are (n_bush, 6 n_end, 6 n_end),
    degrees of freedom (n_bush, 6 n_end).
    """
    ends = np.array([bush.nodes for bush in bushes], dtype=np.int64)
    axes = np.array([bush.axes for bush in bushes], dtype=float)
    positions = np.array([bush.place for bush in bushes], dtype=float)
    springs = np.array([bush.stiffness for bush in bushes], dtype=float)
    stretch = np.concatenate(
        [
            sign * _arm_motions(positions - nodes[ends[:, i]], axes)
            for i, sign in zip(range(ends.shape[1]), (-1.0, 1.0), strict=False)
        ],
        axis=2,
    )
    stiffness = stretch.transpose(0, 2, 1) @ (springs[:, :, None] * stretch)
    dofs = (6 * ends[:, :, None] + np.arange(6)).reshape(len(ends), -1)
    shares = np.array([bush.mass for bush in bushes]) / ends.shape[1]
    moved = np.tile([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], ends.shape[1])
    mass = shares[:, None, None] * np.diag(moved)
    return mass, 0.5 * (stiffness + stiffness.transpose(0, 2, 1)), dofs


def _arm_motions(arms: Matrix, axes: Matrix) -> Matrix:
    """Return motions along axes, at the end of a rigid arm, per motion of a node (n, 6, 6)."""
    motion = np.zeros((len(arms), 6, 6))
    motion[:, :3, :3] = motion[:, 3:, 3:] = axes
    motion[:, :3, 3:] = axes @ lever_arms(arms)
    return motion
