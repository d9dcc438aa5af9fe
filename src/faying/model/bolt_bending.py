"""Bending moments in a bolt that is modelled by beams, or by solids that are cut."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector, read_only
from faying.digits import SOLVED
from faying.model.assembly import Assembly, Beam, Spring
from faying.model.deck_bolt import bolt_axis_element, bolt_chain, chain_ends
from faying.model.elements.beam import beam_frames, beam_matrices
from faying.model.matrices import solid_matrices
from faying.model.specs import BoltSpec


def end_moments(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (4, 6 n_node) that take displacements to the bending moments of a bolt.

    Two components across the axis where the elements of the bolt begin, then two where they end: a
    shank without lateral loads between its ends is bent most at one of them. Of a shank of solids
    both are those of the section where it is cut. None where the element at an end carries no
    moment: a spring, or a rod.
    """
    nodes = assembly.mesh.nodes
    section = section_rows(assembly, spec)
    if section is not None:
        return read_only(sp.csr_array(sp.vstack([section[4:], section[4:]])))
    values, columns = [], []
    for element, node in chain_ends(bolt_chain(assembly, spec)):
        if not isinstance(element, Beam) or not _is_bent(element):
            return None
        frames, _ = beam_frames([element], np.diff(nodes[list(element.nodes)], axis=0))
        _, stiffness = beam_matrices([element], nodes)
        first = 6 * element.nodes.index(node) + 3
        values.append(frames[0, 1:] @ stiffness[0, first : first + 3])
        dofs = (6 * np.array(element.nodes)[:, None] + np.arange(6)).ravel()
        columns += [dofs, dofs]
    entries = (np.concatenate(values).ravel(), (np.repeat(np.arange(4), 12), np.ravel(columns)))
    return read_only(sp.csr_array(entries, shape=(4, 6 * len(nodes))))


def _is_bent(beam: Beam) -> bool:
    return max(beam.section.inertia_y, beam.section.inertia_z) > 0


def are_carried(moments: SparseMatrix, K: SparseMatrix) -> bool:
    """Say whether any motion makes these moments.

    None does where they follow from the balance of degrees of freedom that nothing else touches: of
    hinges at both ends, or of a beam that stands for a section across which a bolt is tightened.
    The moments are rows (4, n_dof).
    """
    columns = np.unique(moments.indices)
    rows = K[columns]
    outside = np.ones(K.shape[1], dtype=bool)
    outside[columns] = False
    row = np.repeat(np.arange(len(columns)), np.diff(rows.indptr))
    touched = np.bincount(row[outside[rows.indices]], minlength=len(columns))
    alone = columns[touched == 0]
    loads = moments[:, columns].toarray().T
    balance = K[alone][:, columns].toarray().T
    left = loads - balance @ np.linalg.lstsq(balance, loads)[0] if len(alone) else loads
    return bool(np.abs(left).max(initial=0.0) > SOLVED * np.abs(loads).max(initial=0.0))


def section_rows(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (6, 6 n_node) that take displacements to the forces of a section.

    The axial force, tension positive, two forces across the axis, the moment about it, and the
    bending moments about the same two directions, about the centre of the section. What the
    elements of one side do to the nodes of the cut is what passes through it: nodal forces K_e u,
    in balance with all else to round-off whatever the mesh. None of a bolt that is not cut through
    solids.

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
