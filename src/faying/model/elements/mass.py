"""Consistent mass of solid elements, all elements of a batch at once."""

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.elements.geometry import cofactors, determinants, jacobians
from faying.model.elements.solid_element import SolidElement, mass_tables


def mass_coefficients(element: SolidElement, coordinates: Matrix, density: Vector) -> Matrix:
    """Integrate m_ij = ∫ ρ N_i N_j dV of a batch (n_cell, n_node, n_node); the mass is m_ij δ_ab.

    Coordinates are (n_cell, n_node, 3) [length], densities (n_cell,) [mass/length³].

    Notes
    -----
    Exact for elements with straight edges. Incompatible modes carry no mass.
    """
    values, gradients = mass_tables(element)
    jacobian = jacobians(gradients, coordinates)
    determinant = determinants(jacobian, cofactors(jacobian))
    weighted = density[:, None] * element.mass_quadrature().weights * determinant
    # One triangle, mirrored: half the work, and symmetric to the last bit.
    rows, columns = np.triu_indices(values.shape[1])
    coefficients = np.empty((len(coordinates), values.shape[1], values.shape[1]))
    coefficients[:, rows, columns] = weighted @ (values[:, rows] * values[:, columns])
    coefficients[:, columns, rows] = coefficients[:, rows, columns]
    return coefficients
