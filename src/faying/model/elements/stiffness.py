"""Stiffness and consistent mass of solid elements, for all elements of a batch at once."""

from functools import cache

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.elements.geometry import cofactors, determinants, jacobians
from faying.model.elements.hex8 import HEX8
from faying.model.elements.solid_element import (
    SolidElement,
    centre_gradients,
    mass_tables,
    shape_values,
    stiffness_gradients,
)


def stiffness_blocks(
    element: SolidElement,
    coordinates: Matrix,
    lame: Vector,
    shear: Vector,
    tensors: Matrix | None = None,
) -> Matrix:
    """Return the stiffness of a batch of elements.

    With Q_{ia,jb} = ∫ ∂_a N_i ∂_b N_j dV the stiffness of an isotropic solid is K_{ia,jb} = λ
    Q_{ia,jb} + μ Q_{ib,ja} + μ δ_ab Σ_c Q_{ic,jc}: one matrix product per element instead of a 6 x
    6 material law at every point. For an anisotropic law it is K_{ia,jb} = Σ_cd C_acbd Q_{ic,jd}
    with the same Q. Coordinates (n_cell, n_node, 3) [length] passed
    :func:`faying.model.elements.geometry.check_shapes`. Lamé's λ, the shear modulus μ (n_cell,)
    and, for an anisotropic law, C (n_cell, 3, 3, 3, 3) are [force/length²]; λ and μ then scale
    hourglass springs alone. Blocks (n_cell, n_node, n_node, 3, 3) of every pair of nodes are
    exactly symmetric [force/length].

    Notes
    -----
    Cost per element: n_quad (3 n_node)² multiplications; memory three arrays of the result's size.
    """
    gradients = _weighted_gradients(element, coordinates)
    if element.hourglass_patterns is not None:
        gradients = _mean_gradients(element, coordinates, gradients)
    n_cell, n_quad, _, n_shape = gradients.shape
    flat = gradients.reshape(n_cell, n_quad, 3 * n_shape)
    products = np.matmul(flat.transpose(0, 2, 1), flat).reshape(n_cell, 3, n_shape, 3, n_shape)
    blocks = _isotropic(products, lame, shear) if tensors is None else _general(products, tensors)
    if element.hourglass_patterns is not None:
        youngs = shear * (3 * lame + 2 * shear) / (lame + shear)
        scale = element.hourglass_share * youngs
        springs = _hourglass(element.hourglass_patterns, coordinates, gradients[:, 0], scale)
        for a in range(3):
            blocks[..., a, a] += springs
    return _condense(blocks, element.n_nodes) if n_shape > element.n_nodes else blocks


def free_strain_forces(
    element: SolidElement, coordinates: Matrix, stress: Matrix, strain: Matrix
) -> Matrix:
    """Return the forces ∫ ε S ∇N_i dV (n_cell, n_node, 3) of a free strain.

    Coordinates are (n_cell, n_node, 3) [length]; S (3, 3) [force/length²] is the stress that would
    prevent ε = 1: E / (1 - 2 ν) 1 for isotropic solids. The strain ε (n_cell, n_quad) is at the
    points of the stiffness, see :func:`temperature_shapes`.

    Notes
    -----
    Internal modes get no forces: they exist in bricks of eight nodes only, and the mean of their
    gradients over a cell is zero.
    """
    rule, table = element.stiffness_quadrature(), stiffness_gradients(element)
    determinant = determinants(*_mapping(table, coordinates))
    at_points = strain * np.sqrt(rule.weights * determinant)
    gradients = _weighted_gradients(element, coordinates)[..., : element.n_nodes]
    return np.asarray(np.einsum("eq,eqan->ena", at_points, gradients) @ stress)


@cache
def temperature_shapes(element: SolidElement) -> Matrix:
    """Return the map from nodal temperatures to the stiffness points (n_quad, n_node).

    As in Abaqus and CalculiX this is the mean of the nodes in bricks of eight nodes, and a linear
    field through the corners in fully integrated bricks of twenty.
    """
    points = element.stiffness_quadrature().points
    if element.kind == "hex8":
        return np.full((len(points), 8), 1 / 8)
    if element.kind == "hex20" and element.formulation == "standard":
        shapes = np.zeros((len(points), 20))
        shapes[:, :8] = shape_values(HEX8, points)
        return shapes
    return shape_values(element, points)


def _mapping(table: Matrix, coordinates: Matrix) -> tuple[Matrix, Matrix]:
    jacobian = jacobians(table, coordinates)
    return jacobian, cofactors(jacobian)


def _weighted_gradients(element: SolidElement, coordinates: Matrix) -> Matrix:
    """Return gradients times √(w det J): (n_cell, n_quad, 3, n_node + n_internal)."""
    rule = element.stiffness_quadrature()
    table = stiffness_gradients(element)
    jacobian, cofactor = _mapping(table, coordinates)
    determinant = determinants(jacobian, cofactor)
    inverse = cofactor.swapaxes(-1, -2) * np.sqrt(rule.weights / determinant)[..., None, None]
    gradients: Matrix = np.matmul(inverse, table)
    if element.internal_gradients is None:
        return gradients
    internal = _internal_gradients(element, coordinates, np.sqrt(rule.weights / determinant))
    return np.concatenate([gradients, internal], axis=-1)


def _mean_gradients(element: SolidElement, coordinates: Matrix, gradients: Matrix) -> Matrix:
    """Return the mean gradients b_i times the root of the volume (n_cell, 1, 3, n_node)."""
    rule = element.stiffness_quadrature()
    weights = rule.weights * determinants(*_mapping(stiffness_gradients(element), coordinates))
    total = np.einsum("eqan,eq->ean", gradients, np.sqrt(weights))
    return np.asarray((total / np.sqrt(weights.sum(axis=1))[:, None, None])[:, None])


def _hourglass(patterns: Matrix, coordinates: Matrix, means: Matrix, scale: Vector) -> Matrix:
    """Return the stiffness (n_cell, n_node, n_node) against motions without uniform strain.

    Patterns are made orthogonal to linear motions: γ = h - b · (x · h).
    """
    moments = np.einsum("nm,enc->emc", patterns, coordinates)
    # b · x is one in each direction, so this is the root of the volume, the scale of the means.
    root = np.einsum("ean,ena->e", means, coordinates) / 3
    gamma = patterns - np.einsum("ean,ema->enm", means, moments) / root[:, None, None]
    springs = scale * np.einsum("ean,ean->e", means, means)
    return np.asarray(springs[:, None, None] * (gamma @ gamma.swapaxes(1, 2)))


def _internal_gradients(element: SolidElement, coordinates: Matrix, scale: Matrix) -> Matrix:
    """Return gradients (det J₀ / det J) J₀⁻ᵀ ∇_ξ of internal modes, with zero mean."""
    if element.internal_gradients is None:
        return np.empty((*scale.shape, 3, 0))
    jacobian = jacobians(centre_gradients(element), coordinates)
    reference = element.internal_gradients(element.stiffness_quadrature().points)
    # cofactor(J₀) is det(J₀) J₀⁻ᵀ; √(w/det J) is √(w det J) / det J.
    cofactor = cofactors(jacobian).swapaxes(-1, -2)
    return np.asarray(np.matmul(cofactor, reference) * scale[..., None, None])


def _isotropic(products: Matrix, lame: Vector, shear: Vector) -> Matrix:
    """Return K[e, i, j, a, b] from Q[e, a, i, b, j]."""
    scale = (slice(None), None, None, None, None)
    blocks: Matrix = lame[scale] * products.transpose(0, 2, 4, 1, 3)
    blocks += shear[scale] * products.transpose(0, 2, 4, 3, 1)
    trace = shear[:, None, None] * np.einsum("eaiaj->eij", products)
    for a in range(3):
        blocks[..., a, a] += trace
    return blocks


def _general(products: Matrix, tensors: Matrix) -> Matrix:
    """Return K[e, i, j, a, b] from Q[e, c, i, d, j] and C[e, a, c, b, d]."""
    n_cell, _, n_shape = products.shape[:3]
    pairs = products.transpose(0, 2, 4, 1, 3).reshape(n_cell, n_shape**2, 9)
    laws = tensors.transpose(0, 2, 4, 1, 3).reshape(n_cell, 9, 9)
    return np.asarray((pairs @ laws).reshape(n_cell, n_shape, n_shape, 3, 3))


def _condense(blocks: Matrix, n_node: int) -> Matrix:
    """Return the stiffness without internal modes: K_uu - K_ui K_ii⁻¹ K_iu."""
    n_cell, n_shape = blocks.shape[:2]
    full = blocks.transpose(0, 1, 3, 2, 4).reshape(n_cell, 3 * n_shape, 3 * n_shape)
    n = 3 * n_node
    coupling = full[:, n:, :n]
    condensed = full[:, :n, :n] - coupling.swapaxes(1, 2) @ np.linalg.solve(
        full[:, n:, n:], coupling
    )
    condensed = 0.5 * (condensed + condensed.swapaxes(1, 2))
    return np.asarray(condensed.reshape(n_cell, n_node, 3, n_node, 3).transpose(0, 1, 3, 2, 4))


def mass_coefficients(element: SolidElement, coordinates: Matrix, density: Vector) -> Matrix:
    """Return m_ij = ∫ ρ N_i N_j dV of a batch (n_cell, n_node, n_node); the mass is m_ij δ_ab.

    Coordinates are (n_cell, n_node, 3) [length], densities (n_cell,) [mass/length³].

    Notes
    -----
    Exact for elements with straight edges. Incompatible modes have no mass.
    """
    values, gradients = mass_tables(element)
    jacobian = jacobians(gradients, coordinates)
    determinant = determinants(jacobian, cofactors(jacobian))
    weighted = density[:, None] * element.mass_quadrature().weights * determinant
    # One triangle, mirrored: half the work, and exactly symmetric.
    rows, columns = np.triu_indices(values.shape[1])
    coefficients = np.empty((len(coordinates), values.shape[1], values.shape[1]))
    coefficients[:, rows, columns] = weighted @ (values[:, rows] * values[:, columns])
    coefficients[:, columns, rows] = coefficients[:, rows, columns]
    return coefficients
