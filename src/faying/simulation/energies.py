"""Energies of a model with contact, for many instants at once."""

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.contact import Contact
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import System, boundary_dofs, elongations


def half_form(matrix: SparseMatrix | Matrix, vectors: Matrix) -> Vector:
    """½ xᵀ A x of each row x (n_time, n)."""
    return np.asarray(0.5 * np.einsum("tn,tn->t", vectors, (matrix @ vectors.T).T))


def contact_energy(contact: Contact, forces: Matrix, shear: Matrix) -> Vector:
    """Energy of contact forces: energy stored by the laws, and ½ λᵀ R λ of residual compliance.

    Forces are (n_time, n_point), tangential ones (n_time, n_tangent, n_point) [force].
    """
    every, times = np.concatenate([forces[:, None], shear], axis=1), len(forces)
    energy = np.zeros(times)
    for name, points in contact.slices.items():
        law, weights = contact.laws[name], np.tile(contact.weights[points], times)
        law_forces = every[:, : law.components, points].swapaxes(0, 1).reshape(law.components, -1)
        energy += law.energy(law_forces, weights).reshape(times, -1).sum(axis=1)
    if contact.residual_compliance is None:
        return energy
    at_pairs = contact.at_pairs(forces, shear).T
    return energy + half_form(contact.residual_compliance, at_pairs)


def input_displacements(system: System, states: Matrix) -> Matrix:
    """Displacements (n_time, n_input) on which the inputs do work; N₀ shortens its bolt."""
    at_boundary, n_dof = states[:, boundary_dofs(system.boundaries)], states.shape[1]
    along = (-elongations(system.bolts, n_dof), pattern_forces(system.load_patterns, n_dof))
    return np.hstack([at_boundary, *(states @ rows.T for rows in along)])
