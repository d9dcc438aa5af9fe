"""Nodal forces of loads within elements: accelerations, free strains, loads along beams.

A body with the free strain ε a obeys K u = ∫ ε Bᵀ D a dV, by default with a = 1 in all directions.
For an isotropic solid D 1 = E / (1 - 2 ν) 1.

A load along a beam does the same work at the nodes as along the beam with the deflection due to the
motions of its ends. These shapes are exact (:mod:`faying.model.elements.beam`), so motions of the
nodes are exact too, and forces and moments at the ends are those of a clamped beam, shear included.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from faying._typing import Matrix, Vector
from faying.linalg.pieces import pieces
from faying.model.assembly import Assembly, Beam
from faying.model.elastic_law import isotropic_law, prevented
from faying.model.elements import block_element
from faying.model.elements.beam import (
    beam_frames,
    beam_properties,
    bending_planes,
    bending_shapes,
)
from faying.model.elements.stiffness import free_strain_forces, temperature_shapes
from faying.model.matrices import mass_times
from faying.model.shell_matrices import shell_stiffness


def body_forces(assembly: Assembly, accelerations: Matrix) -> Matrix:
    """Return forces M a (n_node, 6) for accelerations (n_node, 3), consistent with all masses."""
    motion = np.zeros((len(assembly.mesh.nodes), 6))
    motion[:, :3] = accelerations
    return mass_times(assembly, motion)


def centrifugal(square: float, point: Vector, direction: Vector, nodes: Matrix) -> Matrix:
    """Return ω² r (n_node, 3), away from an axis, with the square ω² [1/time²].

    The axis passes through a point (3,) [length] along a unit direction.
    """
    arms = nodes - point
    return np.asarray(square * (arms - np.outer(arms @ direction, direction)))


FreeStrain = Callable[[Matrix], Matrix]

UNSEEN = (
    "forces of bolts are those of elongation and would not tell what expands in the beam that is "
    "tightened; divide the shank in three beams or more, of which the middle one does not expand"
)
_ALL_DIRECTIONS = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


def expansion_forces(
    assembly: Assembly,
    strains: Mapping[int, FreeStrain],
    initial: Vector,
    final: Vector,
    directions: Mapping[int, Vector] | None = None,
) -> Matrix:
    """Return forces (n_node, 6) due to a change of temperature of solids.

    ``strains`` give, by property, the free strain at a temperature, from any reference;
    temperatures of nodes are (n_node,). For anisotropic expansion ``directions`` are, by property,
    the strains (6,), in the order of :mod:`faying.model.elastic_law`, at a free strain of one.

    Notes
    -----
    Linear in the number of elements.
    """
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    for block in assembly.mesh.blocks:
        element = block_element(block, assembly.element)
        shapes = temperature_shapes(element)
        for number in np.unique(block.properties).tolist():
            if number in strains:
                material = assembly.materials[number]
                law = material.law or isotropic_law(
                    material.youngs_modulus, material.poissons_ratio
                )
                stress = prevented(law, (directions or {}).get(number, _ALL_DIRECTIONS))
                rows = np.flatnonzero(block.properties == number)
                for part in pieces(len(rows), (3 * element.n_nodes) ** 2):
                    cells = block.nodes[rows[part]]
                    initial_strains, final_strains = (
                        material[cells] @ shapes.T for material in (initial, final)
                    )
                    strain = strains[number](final_strains) - strains[number](initial_strains)
                    of_cells = free_strain_forces(
                        element, assembly.mesh.nodes[cells], stress, strain
                    )
                    np.add.at(forces[:, :3], cells, of_cells)
    return forces


def stretching_forces(assembly: Assembly, strains: Vector) -> Matrix:
    """Return forces (n_node, 6) for free strains (n_beam,) along beams."""
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    stretched = np.flatnonzero(strains)
    beams = [assembly.beams[i] for i in stretched.tolist()]
    ends = np.array([beam.nodes for beam in beams], dtype=np.int64).reshape(-1, 2)
    along = assembly.mesh.nodes[ends[:, 1]] - assembly.mesh.nodes[ends[:, 0]]
    stiffness = np.array(
        [
            member.section.axial_factor * member.section.area * member.material.youngs_modulus
            for member in beams
        ]
    )
    pull = (stiffness * strains[stretched] / np.linalg.norm(along, axis=1))[:, None] * along
    np.add.at(forces[:, :3], ends[:, 0], -pull)
    np.add.at(forces[:, :3], ends[:, 1], pull)
    return forces


def shell_expansion_forces(assembly: Assembly, strains: Mapping[int, Matrix]) -> Matrix:
    """Return forces (n_node, 6) for free strains of shells in their planes.

    An element can follow a uniform strain exactly, and K u of that motion is ∫ Bᵀ D ε dA. Strains
    are (n_shell, 3, 3) along basic axes, by the index of a block. For curved shells they must be
    the same in all directions.
    """
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    for position, strain in strains.items():
        block = assembly.shells[position]
        for part, places, stiffness in shell_stiffness(assembly, block):
            motion = np.einsum("eij,enj->eni", strain[part], places)
            of_shells = np.einsum("emnij,enj->emi", stiffness[..., :3], motion)
            np.add.at(forces, block.nodes[part], of_shells)
    return forces


_LOCAL_X = (0, 3)


def nodal_forces_of_beams(
    beams: Sequence[Beam], nodes: Matrix, stations: Matrix, vectors: Matrix
) -> Matrix:
    """Return the forces and moments (n_beam, 2, 6) on the ends of beams in the basic frame.

    Nodes (n_node, 3) [length] are all nodes of the mesh. Forces and moments (n_beam, n_station, 6)
    in the basic frame act at stations (n_beam, n_station): 0 at the first end, 1 at the second.

    Raises
    ------
    ModelError
        If a beam has no length or no orientation.
    """
    ends = np.array([beam.nodes for beam in beams], dtype=np.int64).reshape(-1, 2)
    frames, length = beam_frames(beams, nodes[ends[:, 1]] - nodes[ends[:, 0]])
    properties = beam_properties(beams, length)
    local = np.concatenate(
        [
            np.einsum("nij,nqj->nqi", frames, vectors[..., part])
            for part in np.split(np.arange(6), 2)
        ],
        axis=2,
    )
    result = np.zeros((len(beams), 12))
    straight = np.stack([1 - stations, stations], axis=1)
    for component in _LOCAL_X:
        result[:, [component, 6 + component]] = np.einsum(
            "nsq,nq->ns", straight, local[..., component]
        )
    for (dofs, signs), inertia, phi in bending_planes(properties):
        deflection, rotation = bending_shapes(length, phi)
        # A rod, without bending stiffness, has no slope for the deflection to follow.
        rod = inertia == 0
        deflection[rod] = [[1, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]
        rotation[rod] = [[0, 0, 0], [1, -1, 0], [0, 0, 0], [0, 1, 0]]
        powers = stations[:, None, :] ** np.arange(4)[:, None]
        forces = np.einsum("nsp,npq,nq->ns", deflection, powers, local[..., dofs[0]])
        moments = np.einsum("nsp,npq,nq->ns", rotation, powers[:, :3], local[..., dofs[1]])
        # ``signs`` turns slopes into rotations, so moments of the load into work on slopes.
        result[:, dofs] = np.array(signs) * (forces + signs[1] * moments)
    return np.asarray(
        np.einsum("nij,nbi->nbj", frames, result.reshape(len(beams), 4, 3)).reshape(-1, 2, 6)
    )
