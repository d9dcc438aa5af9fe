"""Forces of free strain: what a temperature does to bodies that expand, as loads on nodes.

A body strained freely by ε in all directions meets K u = ∫ Bᵀ D ε 1 dV. For an isotropic solid
D 1 = E / (1 - 2 ν) 1, so the force of node i is E / (1 - 2 ν) ∫ ε ∇N_i dV.
"""

from collections.abc import Callable, Mapping

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.assembly import Assembly
from faying.model.elements import block_element
from faying.model.elements.stiffness import free_strain_forces, temperature_shapes

FreeStrain = Callable[[Matrix], Matrix]

_AT_ONCE = 20_000
"""Elements in memory at a time."""


def expansion_forces(
    assembly: Assembly, strains: Mapping[int, FreeStrain], initial: Vector, final: Vector
) -> Matrix:
    """Return forces (n_node, 6) of a change of temperature.

    Parameters
    ----------
    strains
        Property of solids and beams to the free strain at a temperature, from any that has none.
    initial, final : (n_node,)
        Temperatures of the nodes.

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
                modulus = material.youngs_modulus / (1 - 2 * material.poissons_ratio)
                rows = np.flatnonzero(block.properties == number)
                for part in np.array_split(rows, len(rows) // _AT_ONCE + 1):
                    cells = block.nodes[part]
                    before, after = (one[cells] @ shapes.T for one in (initial, final))
                    strain = strains[number](after) - strains[number](before)
                    of_cells = free_strain_forces(
                        element, assembly.mesh.nodes[cells], modulus, strain
                    )
                    np.add.at(forces[:, :3], cells, of_cells)
    for beam in assembly.beams:
        if beam.property in strains:
            start, end = (assembly.mesh.nodes[node] for node in beam.nodes)
            axis = (end - start) / np.linalg.norm(end - start)
            before, after = (one[list(beam.nodes)].mean(keepdims=True) for one in (initial, final))
            strain = strains[beam.property](after) - strains[beam.property](before)
            modulus = beam.section.axial_factor * beam.material.youngs_modulus
            pull = modulus * beam.section.area * float(strain[0]) * axis
            forces[beam.nodes[0], :3] -= pull
            forces[beam.nodes[1], :3] += pull
    return forces
