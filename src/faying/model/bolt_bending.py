"""Bending moments in a bolt that is modelled by beams, or by solids that are cut."""

import numpy as np
import scipy.sparse as sp

from faying._typing import SparseMatrix, read_only
from faying.digits import SOLVED
from faying.model.assembly import Assembly, Beam
from faying.model.cut_section import section_rows
from faying.model.deck_bolt import bolt_chain, chain_ends
from faying.model.elements.beam import beam_frames, beam_matrices
from faying.model.specs import BoltSpec


def end_moments(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (4, 6 n_node) that take displacements to the bending moments of a bolt.

    Two components across the axis where the elements of the bolt begin, then two where they end: a
    shank without lateral loads between its ends is bent most at one of them. Of a shank of solids
    both are those of the section where it is cut.

    Returns
    -------
    SparseMatrix or None
        None where the element at an end carries no moment: a spring, or a rod.
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

    Parameters
    ----------
    moments : (4, n_dof)
    K : (n_dof, n_dof)
    """
    columns = np.unique(moments.indices)
    rows = K[columns]
    alone = columns[[np.isin(rows[[k]].indices, columns).all() for k in range(len(columns))]]
    loads = moments[:, columns].toarray().T
    balance = K[alone][:, columns].toarray().T
    left = loads - balance @ np.linalg.lstsq(balance, loads)[0] if len(alone) else loads
    return bool(np.abs(left).max(initial=0.0) > SOLVED * np.abs(loads).max(initial=0.0))
