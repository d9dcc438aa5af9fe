"""Section forces of bolts of solids, where a mesh is cut across the shank to tighten it.

What the elements of one side do to the nodes of the cut is what passes through the section: nodal
forces K_e u of these elements, in balance with all else to round-off whatever the mesh.
"""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.model.assembly import Assembly, Spring
from faying.model.deck_bolt import bolt_axis_element
from faying.model.matrices import solid_matrices
from faying.model.specs import BoltSpec


def section_rows(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (6, 6 n_node) that take displacements to the forces of a section.

    The axial force, tension positive, two forces across the axis, the moment about it, and the
    bending moments about the same two directions, about the centre of the section.

    Returns
    -------
    SparseMatrix or None
        None of a bolt that is not cut through solids.

    Notes
    -----
    Free strains of the elements beside the cut, as of temperature, are not taken off.
    """
    spring = bolt_axis_element(assembly, spec)
    if not isinstance(spring, Spring) or spring.axis is None:
        return None
    side = _side(assembly, spring)
    if not len(side):
        return None
    ends, size = np.array(spring.axis), 6 * len(assembly.mesh.nodes)
    weights = _weights(assembly.mesh.nodes[side] - ends.mean(axis=0), ends[1] - ends[0])
    dofs = (6 * side[:, None] + np.arange(3)).ravel()
    which = np.repeat(np.arange(6), len(dofs))
    sums = sp.csr_array((weights.ravel(), (which, np.tile(dofs, 6))), shape=(6, size))
    rows = sp.csr_array((6, size))
    for block in assembly.mesh.blocks:
        touching: Mask = np.asarray(np.isin(block.nodes, side).any(axis=1))
        if touching.any():
            rows = rows + sums @ solid_matrices(assembly, block.taken(touching))[1]
    return sp.csr_array(rows)


def _side(assembly: Assembly, spring: Spring) -> Indices:
    """Return the nodes of a cut that follow the other side and the end of its spring."""
    moving = spring.ends[1][0]
    followers = {
        equation.terms[0][0]
        for equation in assembly.equations
        if any(node == moving for node, _, _ in equation.terms[2:])
    }
    return np.array(sorted(followers), dtype=np.int64)


def _weights(arms: Matrix, along: Vector) -> Matrix:
    """Return what forces at places (n, 3) from the centre add to sums (6, n, 3)."""
    normal = along / np.linalg.norm(along)
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    frame = np.array([normal, first, np.cross(normal, first)])
    forces = np.repeat(frame[:, None], len(arms), axis=1)
    # t · (r × f) = (t × r) · f
    moments = np.cross(frame[:, None], arms[None])
    return np.concatenate([forces, moments])
