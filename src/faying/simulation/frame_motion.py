"""Joints on a moving support: the inertia forces of a moving frame.

Displacements u are relative to a frame in which the supports rest. Where that frame accelerates and
turns, as the arm of a machine does, a point at X of the mesh has the acceleration

    a₀ + B X,   B = ω̇× + ω× ω×,

in the axes of the frame, with a₀ of the mesh's origin. It is affine in X, so twelve fields and
their load vectors M A represent every motion of the frame. Multibody programs add the contributions
of the deformation, B u and the Coriolis part 2 ω × u̇. Relative to the terms here these are of the
order of u over the size of the joint.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Matrix
from faying.joint.model import Model

N_FIELD = 12
"""Three translations, then e_i X_j row by row."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameMotion(Frozen):
    """Motion of the frame of a joint, in the axes of that frame, instant by instant.

    Attributes
    ----------
    acceleration : (n_time, 3) [length/time²]
        Absolute acceleration of the mesh's origin, minus the acceleration of gravity if that acts.
    angular_velocity : (n_time, 3) [rad/time]
    angular_acceleration : (n_time, 3) [rad/time²]

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> rest = np.zeros((100, 3))
    >>> lifted = rest + np.array([0.0, 0.0, 9810.0])  # one g along z, in mm/s²
    >>> motion = fy.FrameMotion(
    ...     acceleration=lifted, angular_velocity=rest, angular_acceleration=rest
    ... )
    >>> motion.acceleration[0]
    array([   0.,    0., 9810.])
    """

    acceleration: Matrix
    angular_velocity: Matrix
    angular_acceleration: Matrix

    def fields(self) -> Matrix:
        """Return the factors (n_time, 12) of the twelve fields: a₀, then B row by row."""
        turning, gaining = _cross(self.angular_velocity), _cross(self.angular_acceleration)
        matrix = gaining + turning @ turning
        return np.concatenate([self.acceleration, matrix.reshape(len(matrix), 9)], axis=-1)


def affine_fields(nodes: Matrix) -> Matrix:
    """Return the twelve fields at all degrees of freedom (6 n_node, 12).

    Rotational degrees of freedom take half the curl of a field, which is exact for a rotation.
    """
    fields = np.zeros((len(nodes), 6, N_FIELD))
    axes = np.arange(3)
    fields[:, axes, axes] = 1.0
    for i in axes:
        fields[:, i, 3 + 3 * i + axes] = nodes
        first_axis, second_axis = (i + 1) % 3, (i + 2) % 3
        fields[:, 3 + i, 3 + 3 * second_axis + first_axis] = 0.5
        fields[:, 3 + i, 3 + 3 * first_axis + second_axis] = -0.5
    return fields.reshape(-1, N_FIELD)


def frame_loads(model: Model) -> Matrix:
    """Return M A (n_dof, 12): forces per factor of the twelve fields; the load is −M A times them.

    Supported nodes accelerate with the frame, and their mass acts on free neighbours too; so this
    takes the mass matrix before supports are applied.

    Notes
    -----
    One assembly.
    """
    nodal = model.nodal_mass @ affine_fields(model.assembly.mesh.nodes)
    return np.asarray(model.dofs.transformation.T @ nodal)


def mass_invariants(model: Model, vectors: Matrix, shapes: Matrix) -> Matrix:
    """Return ∫ρ a b dV of all pairs of the scalar fields 1, x, y, z and the shapes' components.

    Every inertia integral of the floating frame of reference follows from them (Shabana, Dynamics
    of Multibody Systems, 2005, §5.3). The matrix (4 + 3 n_shape, 4 + 3 n_shape) has components x,
    y, z of the first shape, then of the second, … of trial vectors (n_dof, n_shape) whose
    displacements at all nodes are (n_shape, n_node, 3).

    Notes
    -----
    The integrals of shapes with 1, x, y, z are Φᵀ M A with the full M. All others omit rotary
    inertia and take the mean over the three directions as mass between two nodes. This is exact
    for solids and point masses, and a good approximation where only a slender bolt is a beam.
    """
    M = model.nodal_mass
    loads = model.dofs.transformation.T @ (M @ affine_fields(model.assembly.mesh.nodes))
    blocks = [M[axis::6][:, axis::6] for axis in range(3)]
    mass = (blocks[0] + blocks[1] + blocks[2]) / 3.0
    nodes = model.assembly.mesh.nodes
    components = np.transpose(shapes, (1, 0, 2)).reshape(len(nodes), -1)
    fields = np.column_stack([np.ones(len(nodes)), nodes, components])
    gram = fields.T @ (mass @ fields)
    coupling = vectors.T @ loads
    gram[4:, 0] = coupling[:, :3].ravel()
    gram[4:, 1:4] = coupling[:, 3:].reshape(-1, 3)
    gram[:4, 4:] = gram[4:, :4].T
    return np.asarray((gram + gram.T) / 2)


def _cross(vectors: Matrix) -> Matrix:
    """Return v× (n, 3, 3) of vectors (n, 3)."""
    matrix = np.zeros((len(vectors), 3, 3))
    for i in range(3):
        first_axis, second_axis = (i + 1) % 3, (i + 2) % 3
        matrix[:, second_axis, first_axis] = vectors[:, i]
        matrix[:, first_axis, second_axis] = -vectors[:, i]
    return matrix
