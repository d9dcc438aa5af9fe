"""Bolt: an axial spring with an initial force, which pretension determines and then locks."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector, read_only
from faying.model.assembly import Assembly, Beam
from faying.model.deck_bolt import bolt_chain, chain_ends
from faying.model.elements.beam import beam_matrices
from faying.model.specs import BoltSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class Shank(Frozen):
    """The elements of a bolt, end to end.

    Attributes
    ----------
    elements
        Ids of the elements.
    nodes : (2,)
        Indices of the nodes where the first begins and the last ends.
    ends : (2, 3) [length]
        Positions of these nodes.
    across : (6, n_dof)
        Rows of the force of the bolt on its first node per displacement, without the axial force:
        the force across its axis, and moments about the origin.
    """

    elements: tuple[int, ...]
    nodes: Indices
    ends: Matrix
    across: SparseMatrix


def shank(assembly: Assembly, spec: BoltSpec, transformation: SparseMatrix) -> Shank:
    """Return the shank of a bolt of elements, for displacements = transformation u.

    Springs carry no force across their direction. Forces of beams are taken where they begin: along
    a shank without loads between its ends they are constant.
    """
    chain, nodes = bolt_chain(assembly, spec), assembly.mesh.nodes
    (beam, first), (_, last) = chain_ends(chain)
    ends, shape = nodes[[first, last]], (6, 6 * len(nodes))
    across = sp.csr_array(shape)
    if isinstance(beam, Beam):
        _, stiffness = beam_matrices([beam], nodes)
        row = 6 * beam.nodes.index(first)
        # This is the force of the structure on the beam, opposite to that on the structure.
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
        across=read_only((across @ transformation).tocsr()),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Bolt(Frozen):
    """Axial behaviour of a bolt: force N = k e + N₀ with elongation e = elongation · u.

    The stiffness k is part of the system's K; N₀ (Young's modulus × area × initial strain) acts as
    the load −elongationᵀ N₀, which pulls head and nut together.

    Attributes
    ----------
    elongation : (n_dof,)
        Row of the elongation of the bolt per displacement.
    stiffness : [force/length]
        EA/L of the tightened element.
    initial_force : [force]
        N₀; zero for a bolt not yet tightened.
    ends : (2, 3) or None [length]
        Positions of the ends of the bolt.
    bending : (4, n_dof) or None
        Rows of the bending moments [force·length] per displacement: two components at the first
        end of the beams, two at the second; None for a bolt without beams.
    residual_bending : (4, n_relative) or None [length]
        Moments per force between the contact pairs that the trial vectors of a reduced model lack.
    shank
        Elements with their lateral forces; None for bolts in given matrices, and in reduced models.
    """

    name: str
    elongation: Vector
    stiffness: float
    initial_force: float = 0.0
    ends: Matrix | None = None
    bending: SparseMatrix | Matrix | None = None
    residual_bending: Matrix | None = None
    shank: Shank | None = None

    def force(self, displacement: Matrix) -> Matrix:
        """Return the axial force for displacements (..., n_dof); tension is positive."""
        elongation: Matrix = displacement @ self.elongation
        return self.stiffness * elongation + self.initial_force

    def locked(self, initial_force: float) -> "Bolt":
        """Return the bolt with another initial force."""
        return replace(self, initial_force=float(initial_force))

    def projected(self, vectors: Matrix) -> "Bolt":
        """Return the bolt in coordinates q of u = vectors q."""
        bending = None if self.bending is None else np.asarray(self.bending @ vectors)
        return replace(self, elongation=self.elongation @ vectors, bending=bending, shank=None)

    def at_ports(self) -> "Bolt":
        """Return the bolt without rows in any coordinates."""
        return replace(
            self, elongation=np.zeros(0), bending=None, residual_bending=None, shank=None
        )
