"""What a bolt carries across its axis, beside the axial force that clamps."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, frozen, read_only
from faying.model.assembly import Assembly, Beam
from faying.model.deck_bolt import bolt_chain, chain_ends
from faying.model.elements.beam import beam_matrices
from faying.model.specs import BoltSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class Shank:
    """The elements of a bolt, end to end.

    Attributes
    ----------
    elements
        Their ids.
    nodes : (2,)
        Indices of the nodes where the first begins and the last ends.
    ends : (2, 3) [length]
        Where these are.
    across : (6, n_dof)
        Rows that take displacements to what the bolt does to its first node without its axial
        force: the force across its axis, and moments about the origin.
    """

    elements: tuple[int, ...]
    nodes: Indices
    ends: Matrix
    across: SparseMatrix

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(self.nodes, np.int64))
        object.__setattr__(self, "ends", frozen(self.ends))

    def transformed(self, transformation: SparseMatrix) -> "Shank":
        """Return the same for other degrees of freedom, displacements = transformation u."""
        return replace(self, across=read_only((self.across @ transformation).tocsr()))


def shank(assembly: Assembly, spec: BoltSpec) -> Shank:
    """Return the shank of a bolt of elements, its rows (6, 6 n_node) at the nodes.

    Springs carry nothing across their direction. What beams carry is taken where they begin: it is
    the same all along a shank on which nothing acts between its ends.
    """
    chain, nodes = bolt_chain(assembly, spec), assembly.mesh.nodes
    (beam, first), (_, last) = chain_ends(chain)
    ends, shape = nodes[[first, last]], (6, 6 * len(nodes))
    across = sp.csr_array(shape)
    if isinstance(beam, Beam):
        _, stiffness = beam_matrices([beam], nodes)
        row = 6 * beam.nodes.index(first)
        # The structure does this to the beam, and the beam the opposite to the structure.
        force, moment = -stiffness[0, row : row + 3], -stiffness[0, row + 3 : row + 6]
        axis = nodes[list(beam.nodes)][1] - nodes[list(beam.nodes)][0]
        force = force - np.outer(axis, axis @ force) / (axis @ axis)
        moment = moment + np.cross(ends[0], force, axisb=0, axisc=0)
        columns = (6 * np.array(beam.nodes)[:, None] + np.arange(6)).ravel()
        rows = np.repeat(np.arange(6), 12)
        values = np.vstack([force, moment]).ravel()
        across = sp.csr_array((values, (rows, np.tile(columns, 6))), shape=shape)
    return Shank(
        elements=tuple(element.id for element in chain),
        nodes=np.array([first, last]),
        ends=ends,
        across=across,
    )
