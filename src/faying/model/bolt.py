"""Bolt: an axial spring with an initial force that pretension sets and then locks."""

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

    def transformed(self, transformation: SparseMatrix) -> "Shank":
        """Return the shank by other degrees of freedom u, displacements = transformation u."""
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


@dataclass(frozen=True, eq=False, kw_only=True)
class Bolt(Frozen):
    """Axial behaviour of a bolt: force N = k e + N₀ with elongation e = elongation · u.

    Its stiffness k is part of the system's K; N₀ (Young's modulus × area × initial strain) acts as
    the load −elongationᵀ N₀, which pulls head and nut together.

    Attributes
    ----------
    elongation : (n_dof,)
        Row that takes displacements to the elongation of the bolt.
    stiffness : [force/length]
        EA/L of the element that is tightened.
    initial_force : [force]
        N₀; zero for a bolt not yet tightened.
    ends : (2, 3) or None [length]
        Where what is tightened begins and ends.
    bending : (4, n_dof) or None
        Rows that take displacements to the bending moments [force·length]: two components where
        the beams of the bolt begin, two where they end; None of a bolt without beams.
    residual_bending : (4, n_relative) or None [length]
        Moments per force between the contact pairs that the trial vectors of a reduced model lack.
    shank
        What it carries across its axis; None of bolts in given matrices, and in reduced models.
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
        """Axial force for displacements of shape (..., n_dof); tension is positive."""
        elongation: Matrix = displacement @ self.elongation
        return self.stiffness * elongation + self.initial_force

    def locked(self, initial_force: float) -> "Bolt":
        """Return the bolt with another initial force."""
        return replace(self, initial_force=float(initial_force))

    def projected(self, vectors: Matrix) -> "Bolt":
        """Return the bolt as seen by coordinates q of u = vectors q."""
        bending = None if self.bending is None else np.asarray(self.bending @ vectors)
        return replace(self, elongation=self.elongation @ vectors, bending=bending, shank=None)

    def at_ports(self) -> "Bolt":
        """Return what is known of the bolt without any coordinates."""
        return replace(
            self, elongation=np.zeros(0), bending=None, residual_bending=None, shank=None
        )
