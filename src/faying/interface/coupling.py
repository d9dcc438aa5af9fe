"""Mortar coupling: the motion of the plus side projected to the nodes of the minus side.

Dual Lagrange multipliers (B. I. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012) on segments
(Puso & Laursen 2004), built on the covered part of each facet so that they stay consistent at the
edge of the overlap (A. Popp, A. Seitz, M. W. Gee, W. A. Wall, Comput. Methods Appl. Mech. Engrg.
264 (2013) 67-80). The derivation is in ``docs/theory/non_matching.md``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector, read_only
from faying.digits import DECK_DIGITS, SOLVED
from faying.interface.curved_surface import corner_normals, standing_off
from faying.interface.facets import (
    LARGEST_ORDER,
    Rule,
    gauss_rule,
    reference_nodes,
    shape_functions,
    surface,
)
from faying.interface.segment_points import FacetPoints, on_side
from faying.interface.segments import Segments
from faying.linalg.pieces import pieces
from faying.model.elements import FACES
from faying.model.surface import Facets, facet_normals, rows_by_kind

_RATIONAL_DEGREES = 8
"""Added degrees for facets other than parallelograms, with shape functions beyond polynomials."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Coupling(Frozen):
    """Relative displacements of two sides, one for each corner node of the minus side.

    Attributes
    ----------
    segments
    pairs : (n_pair, 2)
        Corner nodes of the covered minus facets, each with the nearest node of the plus side.
    columns : (n_minus, 4)
        Pair of each corner of the minus facets; triangles repeat their last one.
    minus, plus : (n_pair, n_node) sparse
        Motion of each side at the pairs from translations of the nodes; the relative displacement
        is their difference.
    weights : (n_pair,) [length²]
        ∫ L dA over the covered part, L the linear shape functions.
    coverage : (n_pair,)
        These weights over ∫ L dA over the whole facets.
    masses : (n_minus, 4, 4) [length²]
        ∫ L_i L_j dA over the covered part of each facet.
    gap : (n_pair,) [length]
        Initial gap of the two surfaces; for linear facets of curved surfaces the gap of the
        smooth surfaces through their corners.
    """

    segments: Segments
    pairs: Indices
    columns: Indices
    minus: SparseMatrix
    plus: SparseMatrix
    weights: Vector
    coverage: Vector
    masses: Matrix
    gap: Vector

    def __post_init__(self) -> None:
        super().__post_init__()
        for matrix in (self.minus, self.plus):
            read_only(matrix)

    @property
    def motion(self) -> SparseMatrix:
        """Relative displacements (n_pair, n_node) from translations of the nodes."""
        return (self.plus - self.minus).tocsr()

    @property
    def face_coverage(self) -> Vector:
        """Covered share of each facet (n_face,), in the order of ``Interface.faces``."""
        order = np.concatenate(list(rows_by_kind(self.segments.minus.nodes).values()))
        share: Vector = np.minimum(self.segments.covered[order], 1.0)
        return np.where(self.segments.whole[order], 1.0, share)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Integrals:
    """Integrals over triangles of one kind of minus and one kind of plus facet.

    Triangles ``rows`` (n,); ∫ L N⁻, ∫ L N⁺ (n, 4, n_node), ∫ L L (n, 4, 4), ∫ L and ∫ L g (n, 4).
    """

    rows: Indices
    minus: Matrix
    plus: Matrix
    mass: Matrix
    weight: Matrix
    gap: Matrix


def couple(nodes: Matrix, segments: Segments) -> Coupling:
    """Return the coupling of two sides, integrated over their segments, at least one triangle.

    Nodes are (n_node, 3) [length].

    Notes
    -----
    With Ψ_A biorthogonal to the linear L_B on the covered part of each facet, the relative
    displacement is ∫ Ψ_A (u⁺ − u⁻) dA / ∫ L_A dA. Since Σ Ψ_A = 1, a constant pressure loads the
    nodes of both sides by the integrals of their own shape functions; since ∫ Ψ_A L_B vanishes
    for A ≠ B, linear motions are represented exactly. Linear in the number of segments.
    """
    parts = list(_integrals(nodes, segments))
    pairs, columns = _pairs(nodes, segments)
    n_minus, owner = len(segments.minus), segments.minus_of
    mass, weight = np.zeros((n_minus, 4, 4)), np.zeros((n_minus, 4))
    for part in parts:
        np.add.at(mass, owner[part.rows], part.mass)
        np.add.at(weight, owner[part.rows], part.weight)
    dual = _dual_coefficients(mass, weight)
    total = _sum_at_pairs(columns, weight, len(pairs))
    # Beyond a curved side shape functions are negative, and a node may have no other points.
    total = np.where(total > 0, total, np.inf)
    sides = {
        name: _operator(name, parts, segments, dual, columns, (len(pairs), len(nodes)), total)
        for name in ("minus", "plus")
    }
    gap = np.zeros(len(pairs))
    for part in parts:
        owners = owner[part.rows]
        np.add.at(gap, columns[owners], np.einsum("nab,nb->na", dual[owners], part.gap))
    return Coupling(
        segments=segments,
        pairs=pairs,
        columns=columns,
        weights=_sum_at_pairs(columns, weight, len(pairs)),
        coverage=np.where(np.isfinite(total), total, 0.0)
        / _sum_at_pairs(columns, whole_weights(nodes, segments.minus), len(pairs)),
        masses=mass,
        gap=gap / total,
        **sides,
    )


def whole_weights(nodes: Matrix, facets: Facets) -> Matrix:
    """Return ∫ L dA over whole facets (n_facet, 4) [length²], zero in unused columns."""
    weights = np.zeros((len(facets), 4))
    for kind, rows in rows_by_kind(facets.nodes).items():
        rule, n_corner = gauss_rule(kind), FACES[kind].n_corners
        geometry = surface(kind, nodes[facets.nodes[rows, : FACES[kind].n_nodes]], rule)
        weights[rows, :n_corner] = geometry.areas @ shape_functions(FACES[kind].linear, rule.points)
    return weights


def _pairs(nodes: Matrix, segments: Segments) -> tuple[Indices, Indices]:
    """Return corner nodes with their nearest partners (n_pair, 2), and the pair of every corner."""
    corners, columns = np.unique(segments.minus.corners, return_inverse=True)
    others = np.unique(segments.plus.nodes[segments.plus.nodes >= 0])
    nearest = others[cKDTree(nodes[others]).query(nodes[corners])[1]]
    return np.column_stack([corners, nearest]), columns.reshape(-1, 4)


def _sum_at_pairs(columns: Indices, values: Matrix, n_pair: int) -> Vector:
    total = np.zeros(n_pair)
    np.add.at(total, columns, values)
    return total


def _dual_coefficients(mass: Matrix, weight: Matrix) -> Matrix:
    """Return coefficients of the dual functions, Ψ = diag(∫ L) (∫ L L)⁻¹ L (n, 4, 4).

    Scaled by the weights the mass matrix has eigenvalues up to 1. For a small corner of a facet
    they are far smaller: there the other facets determine the linear part of the motion.
    """
    used = weight > 0
    root = np.sqrt(np.where(used, weight, 1.0))
    scaled = mass / (root[:, :, None] * root[:, None, :])
    values, vectors = np.linalg.eigh(scaled)
    inverse = np.where(values > SOLVED, 1.0 / np.maximum(values, SOLVED), 0.0)
    pseudo = np.einsum("nak,nk,nbk->nab", vectors, inverse, vectors)
    dual: Matrix = np.where(used[:, :, None] & used[:, None, :], pseudo, 0.0)
    return dual * (root[:, :, None] / root[:, None, :])


def _operator(
    side: str,
    parts: list[_Integrals],
    segments: Segments,
    dual: Matrix,
    columns: Indices,
    shape: tuple[int, int],
    total: Vector,
) -> SparseMatrix:
    """Return the motion of one side at the pairs (n_pair, n_node)."""
    facets, of = {
        "minus": (segments.minus, segments.minus_of),
        "plus": (segments.plus, segments.plus_of),
    }[side]
    entries, places = [], []
    for part in parts:
        minus_rows = segments.minus_of[part.rows]
        block = dual[minus_rows] @ getattr(part, side)
        facet_nodes = facets.nodes[of[part.rows], : block.shape[2]]
        row = np.broadcast_to(columns[minus_rows][:, :, None], block.shape)
        column = np.broadcast_to(facet_nodes[:, None, :], block.shape)
        entries.append(block.ravel())
        places.append(np.stack([row.ravel(), column.ravel()]))
    table = (np.concatenate(entries), tuple(np.concatenate(places, axis=1)))
    result = sp.coo_array(table, shape=shape).tocsr()
    result = sp.csr_array(sp.diags_array(1.0 / total) @ result)
    # Round-off of vanishing entries would fill the matrix.
    result.data[np.abs(result.data) < 1e-12] = 0.0
    result.eliminate_zeros()
    result.sort_indices()
    return result


def _integrals(nodes: Matrix, segments: Segments) -> Iterator[_Integrals]:
    """Yield integrals over the triangles, for each combination of facet kinds."""
    kinds = [rows_by_kind(facets.nodes) for facets in (segments.minus, segments.plus)]
    sides = (segments.minus, segments.plus)
    flat = all(_is_flat(nodes, facets) for facets in sides)
    normals = [None if flat else corner_normals(nodes, facets) for facets in sides]
    for (minus_kind, minus_rows), (plus_kind, plus_rows) in product(
        kinds[0].items(), kinds[1].items()
    ):
        chosen = np.isin(segments.minus_of, minus_rows) & np.isin(segments.plus_of, plus_rows)
        rows = np.flatnonzero(chosen)
        if not len(rows):
            continue
        rule = gauss_rule("tri3", _degree(nodes, segments, (minus_kind, plus_kind), rows))
        for part in pieces(len(rows), len(rule.weights)):
            yield _integrate(nodes, segments, (minus_kind, plus_kind), rows[part], rule, normals)


def _degree(nodes: Matrix, segments: Segments, kinds: tuple[str, str], rows: Indices) -> int:
    """Return the degree of the products to be integrated over triangles ``rows``."""
    degree = FACES[FACES[kinds[0]].linear].total_degree
    degree += max(FACES[kind].total_degree for kind in kinds)
    affine = _affine(nodes, segments.minus, segments.minus_of[rows])
    if affine and _affine(nodes, segments.plus, segments.plus_of[rows]):
        return degree
    return min(degree + _RATIONAL_DEGREES, LARGEST_ORDER)


def _integrate(
    nodes: Matrix,
    segments: Segments,
    kinds: tuple[str, str],
    rows: Indices,
    rule: Rule,
    normals: list[Matrix | None],
) -> _Integrals:
    minus_facets, plus_facets = segments.minus_of[rows], segments.plus_of[rows]
    minus, plus = (
        on_side(side, kind, nodes, segments, rows, rule)
        for side, kind in zip(("minus", "plus"), kinds, strict=True)
    )
    size = 2 * segments.areas[rows][:, None] * rule.weights
    size = size * np.linalg.norm(minus.area_vectors, axis=-1)
    gap = plus.heights - minus.heights
    if normals[0] is not None and normals[1] is not None:
        gap -= _arc_heights(minus, nodes, segments.minus, minus_facets, normals[0])
        gap -= _arc_heights(plus, nodes, segments.plus, plus_facets, normals[1])
    linear = minus.linear
    linear = np.pad(linear, ((0, 0), (0, 0), (0, 4 - linear.shape[2])))
    weighted = (size[..., None] * linear).transpose(0, 2, 1)
    return _Integrals(
        rows=rows,
        minus=weighted @ minus.shape,
        plus=weighted @ plus.shape,
        mass=weighted @ linear,
        weight=weighted.sum(axis=2),
        gap=np.einsum("naq,nq->na", weighted, gap),
    )


def _affine(nodes: Matrix, facets: Facets, rows: Indices) -> bool:
    """Return whether facets are triangles or parallelograms, with mid-side nodes half way."""
    used = facets.taken(np.unique(rows))
    for kind, members in rows_by_kind(used.nodes).items():
        x = nodes[used.nodes[members, : FACES[kind].n_nodes]]
        corners = x[:, : FACES[kind].n_corners]
        away = np.zeros(1)
        if FACES[kind].n_corners == 4:
            away = np.abs(corners[:, 0] - corners[:, 1] + corners[:, 2] - corners[:, 3])
        if x.shape[1] > FACES[kind].n_corners:
            middle = shape_functions(FACES[kind].linear, reference_nodes(kind)) @ corners
            away = np.append(away, np.abs(middle - x))
        if away.max() > SOLVED * np.ptp(corners, axis=1).max():
            return False
    return True


def _arc_heights(
    side: FacetPoints, nodes: Matrix, facets: Facets, rows: Indices, normals: Matrix
) -> Matrix:
    """Return the height of the smooth surface over linear facets (n, n_q), else zero."""
    if FACES[side.kind].linear != side.kind:
        return np.zeros(side.shape.shape[:2])
    n_corner = FACES[side.kind].n_corners
    corners = nodes[facets.nodes[rows, :n_corner]]
    return standing_off(side.shape, corners, normals[rows, :n_corner])


def _is_flat(nodes: Matrix, facets: Facets) -> bool:
    normals = facet_normals(nodes, facets)
    return bool(np.linalg.norm(normals - normals[0], axis=1).max() <= DECK_DIGITS)
