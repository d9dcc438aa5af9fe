"""Facets: shape functions, quadrature and geometry of contact surfaces.

Reference facets are scikit-fem's: the triangle (0,0), (1,0), (0,1) and the square [0, 1]². Nodes
run corners first, then mid-sides, counter-clockwise.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from faying._typing import Frozen, Indices, Matrix, Vector
from faying.exceptions import refuse_model
from faying.model.elements import FACES

LARGEST_ORDER = 12
"""Largest order of quadrature on facets: skfem has more, but no interface needs them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rule(Frozen):
    """Quadrature on the reference facet.

    Attributes
    ----------
    name
        ``"gauss-<order>"`` or ``"nodal"``.
    points : (n_q, 2)
    weights : (n_q,)
        Positive; their sum is the area of the reference facet.
    nodes : (n_q,)
        Local node at a point, -1 for a point away from nodes.
    """

    name: str
    points: Matrix
    weights: Vector
    nodes: Indices


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """Geometry of facets at quadrature points.

    Attributes
    ----------
    points : (n_face, n_q, 3) [length]
    areas : (n_face, n_q) [length²]
        Quadrature weight times surface Jacobian.
    normals : (n_face, n_q, 3)
        Unit normals, on the side from which the nodes run counter-clockwise.
    """

    points: Matrix
    areas: Matrix
    normals: Matrix


def reference_nodes(kind: str) -> Matrix:
    """Return the nodes of the reference facet, (n_node_per_face, 2)."""
    return np.asarray(_element(kind).doflocs, dtype=float)


def shape_functions(kind: str, points: Matrix) -> Matrix:
    """Return the shape functions (n_q, n_node_per_face) at reference points (n_q, 2).

    The kind is a name of a :class:`~faying.model.elements.face_kind.FaceKind`.
    """
    element, local = _element(kind), np.asarray(points).T
    values = [element.lbasis(local, i)[0] for i in range(len(element.doflocs))]
    return np.stack([np.broadcast_to(value, local.shape[1:]) for value in values], axis=-1)


def shape_gradients(kind: str, points: Matrix) -> Matrix:
    """Return derivatives of the shape functions by the coordinates (n_q, n_node_per_face, 2)."""
    element, local = _element(kind), np.asarray(points).T
    values = [np.asarray(element.lbasis(local, i)[1]) for i in range(len(element.doflocs))]
    full = [np.broadcast_to(value.reshape(2, -1), local.shape) for value in values]
    return np.stack(full, axis=0).transpose(2, 0, 1)


@cache
def gauss_rule(kind: str, order: int | None = None) -> Rule:
    """Return Gauss points of a facet, all strictly inside it and with positive weights.

    The order is the number of points per direction (quadrilaterals) or the degree of exactness
    (triangles). None is the lowest one that integrates pressure times shape functions exactly on a
    flat facet with straight sides and evenly spaced nodes.
    """
    chosen = FACES[kind].gauss_order if order is None else order
    if not 1 <= chosen <= LARGEST_ORDER:
        refuse_model(
            f"quadrature order {chosen} for {kind} facets; "
            f"give a whole number from 1 to {LARGEST_ORDER}"
        )
    points, weights = (
        _square_gauss(chosen) if FACES[kind].n_corners == 4 else _triangle_gauss(chosen)
    )
    nodes = np.full(len(weights), -1, dtype=np.int64)
    return Rule(name=f"gauss-{chosen}", points=points, weights=weights, nodes=nodes)


@cache
def nodal_rule(kind: str) -> Rule:
    """Return a quadrature whose points are nodes of the facet, with positive weights.

    tri3 has its vertices and quad4 its corners; the weight of a corner is ∫N dA, which on a
    distorted facet is not its 2 × 2 Lobatto weight but balances uniform pressure. tri6 has the
    mid-sides with a third of the area each: the vertices have weight zero. quad8 has 3 × 3 Lobatto
    points with the centre, because with its eight nodes alone the weight of the corners is -A/12,
    and a contact point cannot have a negative area.
    """
    weights = np.array(FACES[kind].nodal_weights)
    nodes = reference_nodes(kind)
    points = np.vstack([nodes, [[0.5, 0.5]]])[: len(weights)]
    index = np.append(np.arange(len(nodes)), -1)[: len(weights)]
    used = weights > 0
    return Rule(name="nodal", points=points[used], weights=weights[used], nodes=index[used])


def surface(kind: str, coordinates: Matrix, rule: Rule) -> Surface:
    """Return the interpolated surface of facets (n_face, n_node_per_face, 3) at a rule's points.

    Areas use the true Jacobian |∂x/∂ξ × ∂x/∂η| of the curved facet.
    """
    points = np.einsum("qa,fad->fqd", shape_functions(kind, rule.points), coordinates)
    if kind == FACES[kind].linear and rule.name == "nodal":
        vectors = _corner_areas(kind, coordinates)
    else:
        vectors = area_vectors(kind, coordinates, rule.points) * rule.weights[:, None]
    areas = np.linalg.norm(vectors, axis=-1)
    # A collapsed facet has no normal; the zero vector lets callers detect it.
    normals = vectors / np.where(areas > 0, areas, 1.0)[..., None]
    return Surface(points=points, areas=areas, normals=normals)


def _corner_areas(kind: str, coordinates: Matrix) -> Matrix:
    """Return ∫ N n dA of every corner (n_face, n_node, 3)."""
    exact = gauss_rule(kind)
    share = shape_functions(kind, exact.points) * exact.weights[:, None]
    return np.asarray(
        np.einsum("ga,fgd->fad", share, area_vectors(kind, coordinates, exact.points))
    )


def area_vectors(kind: str, coordinates: Matrix, points: Matrix) -> Matrix:
    """Return ∂x/∂ξ × ∂x/∂η of facets (n_face, n_q, 3) [length²] at reference points (n_q, 2).

    Coordinates of their nodes are (n_face, n_node_per_face, 3).
    """
    tangents = np.einsum("qaj,fad->jfqd", shape_gradients(kind, points), coordinates)
    return np.cross(tangents[0], tangents[1])


@cache
def _element(kind: str):  # type: ignore[no-untyped-def]  # skfem ships no types
    import skfem.element  # importing it takes a third of a second

    return getattr(skfem.element, FACES[kind].shape_functions)()


def _square_gauss(order: int) -> tuple[Matrix, Vector]:
    """Return the Gauss-Legendre product rule on [0, 1]²; points run along ξ first."""
    x, w = np.polynomial.legendre.leggauss(order)
    x, w = (x + 1) / 2, w / 2
    points = np.column_stack([np.tile(x, order), np.repeat(x, order)])
    return points, np.outer(w, w).ravel()


def _triangle_gauss(degree: int) -> tuple[Matrix, Vector]:
    """Return the lowest rule of at least this degree, points inside and weights positive."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    points, weights = get_quadrature(RefTri, degree)
    if weights.min() <= 0:
        return _triangle_gauss(degree + 1)
    # The tables have round-off of 1e-15, which the sum of the weights should not have.
    return points.T, weights * (0.5 / weights.sum())
