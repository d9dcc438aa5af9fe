"""Stiffness of solid elements of isotropic material, all elements of a batch at once."""

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.elements.geometry import cofactors, determinants, jacobians
from faying.model.elements.solid_element import SolidElement, centre_gradients, stiffness_gradients


def stiffness_blocks(
    element: SolidElement, coordinates: Matrix, lame: Vector, shear: Vector
) -> Matrix:
    """Integrate the stiffness of a batch of elements.

    With Q_{ia,jb} = ∫ ∂_a N_i ∂_b N_j dV the stiffness of an isotropic solid is
    K_{ia,jb} = λ Q_{ia,jb} + μ Q_{ib,ja} + μ δ_ab Σ_c Q_{ic,jc}: one matrix product per element
    instead of a 6 x 6 material law at every point.

    Parameters
    ----------
    coordinates : (n_cell, n_node, 3) [length]
        Of elements that passed :func:`faying.model.elements.geometry.check_shapes`.
    lame, shear : (n_cell,) [force/length²]
        Lamé's λ and the shear modulus μ.

    Returns
    -------
    ndarray (n_cell, n_node, n_node, 3, 3) [force/length]
        The 3 x 3 block of every pair of nodes; exactly symmetric.

    Notes
    -----
    Cost per element: n_quad (3 n_node)² multiplications; memory three arrays of the result's size.
    """
    gradients = _weighted_gradients(element, coordinates)
    n_cell, n_quad, _, n_shape = gradients.shape
    flat = gradients.reshape(n_cell, n_quad, 3 * n_shape)
    products = np.matmul(flat.transpose(0, 2, 1), flat).reshape(n_cell, 3, n_shape, 3, n_shape)
    blocks = _isotropic(products, lame, shear)
    return _condense(blocks, element.n_nodes) if n_shape > element.n_nodes else blocks


def _weighted_gradients(element: SolidElement, coordinates: Matrix) -> Matrix:
    """Physical gradients times the root of w det J: (n_cell, n_quad, 3, n_node + n_internal)."""
    rule = element.stiffness_quadrature()
    table = stiffness_gradients(element)
    jacobian = jacobians(table, coordinates)
    cofactor = cofactors(jacobian)
    determinant = determinants(jacobian, cofactor)
    inverse = cofactor.swapaxes(-1, -2) * np.sqrt(rule.weights / determinant)[..., None, None]
    gradients: Matrix = np.matmul(inverse, table)
    if element.internal_gradients is None:
        return gradients
    internal = _internal_gradients(element, coordinates, np.sqrt(rule.weights / determinant))
    return np.concatenate([gradients, internal], axis=-1)


def _internal_gradients(element: SolidElement, coordinates: Matrix, scale: Matrix) -> Matrix:
    """Gradients (det J₀ / det J) J₀⁻ᵀ ∇_ξ of the internal modes; their mean over a cell is zero."""
    if element.internal_gradients is None:
        return np.empty((*scale.shape, 3, 0))
    jacobian = jacobians(centre_gradients(element), coordinates)
    reference = element.internal_gradients(element.stiffness_quadrature().points)
    # cofactor(J₀) is det(J₀) J₀⁻ᵀ; √(w/det J) is √(w det J) / det J.
    cofactor = cofactors(jacobian).swapaxes(-1, -2)
    return np.asarray(np.matmul(cofactor, reference) * scale[..., None, None])


def _isotropic(products: Matrix, lame: Vector, shear: Vector) -> Matrix:
    """Combine Q[e, a, i, b, j] to K[e, i, j, a, b]."""
    scale = (slice(None), None, None, None, None)
    blocks: Matrix = lame[scale] * products.transpose(0, 2, 4, 1, 3)
    blocks += shear[scale] * products.transpose(0, 2, 4, 3, 1)
    trace = shear[:, None, None] * np.einsum("eaiaj->eij", products)
    for a in range(3):
        blocks[..., a, a] += trace
    return blocks


def _condense(blocks: Matrix, n_node: int) -> Matrix:
    """Eliminate the internal modes: K_uu - K_ui K_ii⁻¹ K_iu."""
    n_cell, n_shape = blocks.shape[:2]
    full = blocks.transpose(0, 1, 3, 2, 4).reshape(n_cell, 3 * n_shape, 3 * n_shape)
    n = 3 * n_node
    coupling = full[:, n:, :n]
    condensed = full[:, :n, :n] - coupling.swapaxes(1, 2) @ np.linalg.solve(
        full[:, n:, n:], coupling
    )
    condensed = 0.5 * (condensed + condensed.swapaxes(1, 2))
    return np.asarray(condensed.reshape(n_cell, n_node, 3, n_node, 3).transpose(0, 1, 3, 2, 4))
