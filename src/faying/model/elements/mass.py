"""Consistent mass of solid elements, all elements of a batch at once."""

from faying._typing import Matrix, Vector
from faying.model.elements.geometry import cofactors, determinants, jacobians
from faying.model.elements.solid_element import SolidElement, mass_tables


def mass_coefficients(element: SolidElement, coordinates: Matrix, density: Vector) -> Matrix:
    """Integrate m_ij = ∫ ρ N_i N_j dV of a batch; the mass matrix is m_ij δ_ab.

    Parameters
    ----------
    coordinates : (n_cell, n_node, 3) [length]
    density : (n_cell,) [mass/length³]

    Returns
    -------
    ndarray (n_cell, n_node, n_node) [mass]

    Notes
    -----
    Exact for elements with straight edges. Incompatible modes carry no mass.
    """
    values, gradients = mass_tables(element)
    jacobian = jacobians(gradients, coordinates)
    determinant = determinants(jacobian, cofactors(jacobian))
    n_quad, n_node = values.shape
    products = values[:, :, None] * values[:, None, :]
    weighted = density[:, None] * element.mass_quadrature().weights * determinant
    coefficients: Matrix = weighted @ products.reshape(n_quad, n_node * n_node)
    return coefficients.reshape(-1, n_node, n_node)
