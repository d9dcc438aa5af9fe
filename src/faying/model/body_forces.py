"""Forces of accelerations: gravity and rotation, as loads on nodes."""

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.assembly import Assembly
from faying.model.matrices import mass_times


def body_forces(assembly: Assembly, accelerations: Matrix) -> Matrix:
    """Return forces M a (n_node, 6), consistent with the mass of every element.

    Parameters
    ----------
    accelerations : (n_node, 3) [length/time²]
    """
    motion = np.zeros((len(assembly.mesh.nodes), 6))
    motion[:, :3] = accelerations
    return mass_times(assembly, motion)


def centrifugal(square: float, point: Vector, direction: Vector, nodes: Matrix) -> Matrix:
    """Return ω² r (n_node, 3), away from an axis.

    Parameters
    ----------
    square : [1/time²]
        ω².
    point : (3,) [length]
        A point of the axis.
    direction : (3,)
        Its direction, of length one.
    """
    arms = nodes - point
    return np.asarray(square * (arms - np.outer(arms @ direction, direction)))
