"""Shear panels: parallelograms that carry shear along their sides and nothing else.

The shear flow q is the same on all sides; half the force of a side goes to either corner. Stresses
are uniform with no normal part on any side, and their energy gives the flexibility c of the panel:
q = f · u / c with the nodal forces f of the unit flow, K = f fᵀ / c. For parallelograms this is
the panel of S. J. Garvey, "The quadrilateral shear panel", Aircraft Engineering 23 (1951) 134-135.
"""

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import ModelError
from faying.model.elements.flat_shell import FLAT_SHELLS
from faying.model.elements.shell_frames import ElementLaws

# Relative difference of opposite sides that five digits of coordinates leave.
_PARALLEL = 1e-4


def panel_matrices(local: Matrix, laws: ElementLaws, ids: Indices) -> tuple[Matrix, Matrix]:
    """Return mass and stiffness (n, 24, 24) of shear panels in their local frames.

    Corners in the frame of each are (n, 4, 3) [length].
    """
    first, second = local[:, 1] - local[:, 0], local[:, 3] - local[:, 0]
    skew = local[:, 2] - local[:, 0] - first - second
    size = np.abs(local).max(axis=(1, 2))
    wrong = np.flatnonzero(np.abs(skew).max(axis=1) > _PARALLEL * size)
    if wrong.size:
        message = (
            f"shear panel {ids[wrong[0]]} is no plane parallelogram; give it opposite sides that "
            "are parallel, or use shells"
        )
        raise ModelError(message)
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    # With x along the first side, no normal stress on either side and a unit flow along both.
    stress = np.zeros((len(local), 3))
    stress[:, 0], stress[:, 2] = 2 * second[:, 0] / second[:, 1], 1.0
    strain = np.linalg.solve(laws.stiffness[:, :3, :3], stress[..., None])[..., 0]
    flexibility = area * np.einsum("ei,ei->e", stress, strain)
    forces = np.zeros((len(local), 4, 6))
    for node, (a, b) in enumerate(((1, 1), (1, -1), (-1, -1), (-1, 1))):
        forces[:, node, :2] = -(a * first[:, :2] + b * second[:, :2]) / 2
    flat = forces.reshape(len(local), 24)
    stiffness = flat[:, :, None] * flat[:, None] / flexibility[:, None, None]
    table = FLAT_SHELLS["quad4"]
    share = np.einsum("q,qi,qj->ij", table.weights, table.values, table.values) / 4
    mass = np.einsum(
        "e,ij,ab->eiajb", laws.mass * area, share, np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    )
    return mass.reshape(len(local), 24, 24), stiffness
