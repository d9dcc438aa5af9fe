"""Forces of accelerations: gravity and rotation, as loads on nodes."""

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.assembly import Assembly
from faying.model.matrices import mass_times


def body_forces(assembly: Assembly, accelerations: Matrix) -> Matrix:
    """Return forces M a (n_node, 6) of accelerations (n_node, 3), consistent with every mass."""
    motion = np.zeros((len(assembly.mesh.nodes), 6))
    motion[:, :3] = accelerations
    return mass_times(assembly, motion)


def centrifugal(square: float, point: Vector, direction: Vector, nodes: Matrix) -> Matrix:
    """Return ω² r (n_node, 3), away from an axis, with the square ω² [1/time²].

    The axis goes through a point (3,) [length] along a direction of length one.
    """
    arms = nodes - point
    return np.asarray(square * (arms - np.outer(arms @ direction, direction)))
