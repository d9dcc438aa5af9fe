"""Contact points of a mortar coupling.

On wholly covered facets they are those of zero-thickness elements, so that matching meshes give the
same interface either way. Relative displacements are linear on each facet, so more points would add
nothing.
"""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix
from faying.contact.laws import Law
from faying.interface.contact_points import ContactPoints, joined, on_facets, spread
from faying.interface.coupling import Coupling, whole_weights
from faying.interface.facets import Rule, gauss_rule
from faying.interface.relative_displacement import unit
from faying.interface.segment_points import on_side
from faying.interface.zero_thickness import contact_rule
from faying.model.elements import FACES
from faying.model.specs import InterfaceSpec
from faying.model.surface import rows_by_kind

SMALLEST_COVERAGE = 0.2
"""Coverage of a node below which its contact point joins a neighbour's.

Its area is too small for a separate pressure, which hard contact would leave undetermined. A strip
narrower than 0.45 of a facet then has one row of points; with 0.05 it had two, and some of them had
four times the pressure of their neighbours around a hole.
"""


def contact_points(
    nodes: Matrix,
    spec: InterfaceSpec,
    coupling: Coupling,
    pair_normals: Matrix,
    law: Law,
) -> ContactPoints:
    """Return the contact points of a coupling.

    Nodes are (n_node, 3) [length], normals of the pairs (n_pair, 3).

    Raises
    ------
    ModelError
        If the order does not fit the quadrature.
    """
    rules = {
        kind: contact_rule(spec, kind, law) for kind in rows_by_kind(coupling.segments.minus.nodes)
    }
    if any(rule.name == "nodal" for rule in rules.values()):
        return _nodal_points(nodes, coupling, pair_normals)
    degree = spec.order or 2
    parts = _on_whole_facets(nodes, coupling, rules) + _on_segments(nodes, coupling, degree)
    points = joined(parts)
    return replace(points, faces=_facet_numbers(coupling)[points.faces])


def _facet_numbers(coupling: Coupling) -> Indices:
    """Return the number of each minus facet, counted through the entries of ``Interface.faces``."""
    order = np.concatenate(list(rows_by_kind(coupling.segments.minus.nodes).values()))
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    return number


def _on_whole_facets(
    nodes: Matrix, coupling: Coupling, rules: dict[str, Rule]
) -> list[ContactPoints]:
    facets, whole = coupling.segments.minus, coupling.segments.whole
    parts = []
    for kind, every in rows_by_kind(facets.nodes).items():
        rows, rule = every[whole[every]], rules[kind]
        if not len(rows):
            continue
        coordinates = nodes[facets.nodes[rows, : FACES[kind].n_nodes]]
        seen, columns = FACES[kind].linear, coupling.columns[rows]
        part = on_facets(kind, coordinates, rule, rows, seen, columns, len(coupling.pairs))
        parts.append(part)
    return parts


def _on_segments(nodes: Matrix, coupling: Coupling, degree: int) -> list[ContactPoints]:
    segments, rule = coupling.segments, gauss_rule("tri3", degree)
    partly = ~segments.whole[segments.minus_of]
    parts = []
    for kind, facets in rows_by_kind(segments.minus.nodes).items():
        rows = np.flatnonzero(partly & np.isin(segments.minus_of, facets))
        if not len(rows):
            continue
        minus_rows, n_q = segments.minus_of[rows], len(rule.weights)
        seen = on_side("minus", kind, nodes, segments, rows, rule)
        vectors = seen.area_vectors
        slope = np.linalg.norm(vectors, axis=-1)
        weights = 2 * segments.areas[rows][:, None] * rule.weights * slope
        weights = _corrected_weights(weights, seen.linear, minus_rows, coupling)
        normals = np.einsum("nqa,nad->nqd", vectors / slope[..., None], segments.frames[minus_rows])
        coordinates = nodes[segments.minus.nodes[minus_rows, : FACES[kind].n_nodes]]
        parts.append(
            ContactPoints(
                shape=spread(seen.linear, coupling.columns[minus_rows], len(coupling.pairs)),
                points=np.einsum("nqa,nad->nqd", seen.shape, coordinates).reshape(-1, 3),
                weights=weights.ravel(),
                normals=unit(normals.reshape(-1, 3)),
                faces=np.repeat(minus_rows, n_q),
                rule=f"segments-{degree}",
            )
        )
    return parts


def _corrected_weights(weights: Matrix, shape: Matrix, rows: Indices, coupling: Coupling) -> Matrix:
    """Return weights (n, n_q) corrected so that they integrate L as the coupling does.

    A low rule is slightly inexact where the shape functions are no polynomials, and a constant
    pressure would then load the two sides differently. The factor is linear on each facet.
    """
    n_corner = shape.shape[2]
    sums, masses = np.zeros((len(coupling.masses), 4)), np.zeros_like(coupling.masses)
    weighted = weights[..., None] * shape
    np.add.at(sums[:, :n_corner], rows, weighted.sum(axis=1))
    np.add.at(masses[:, :n_corner, :n_corner], rows, np.einsum("nqa,nqb->nab", weighted, shape))
    missing = coupling.masses.sum(axis=2) - sums
    inverse = np.linalg.pinv(masses[rows], rcond=1e-9, hermitian=True)
    factors = np.einsum("nab,nb->na", inverse, missing[rows])[:, :n_corner]
    factor = 1.0 + np.einsum("nqa,na->nq", shape, factors)
    # If this fails on a very distorted facet, its weights stay uncorrected, which are positive.
    smallest = np.ones(len(masses))
    np.minimum.at(smallest, rows, factor.min(axis=1))
    return np.where(smallest[rows][:, None] > 0, weights * factor, weights)


def _nodal_points(nodes: Matrix, coupling: Coupling, pair_normals: Matrix) -> ContactPoints:
    """Return one contact point at each pair, with the mean gap near it over the covered part.

    On a facet with the covered share c, ∫ L_A g is c (∫ L_A) g_A + (1 - c) Σ ∫ L_A L_B g_B: the
    values of the pairs where it is wholly covered, and towards the corner of a facet the mean over
    the covered part, because the pairs may lie far outside it there.
    """
    segments, n_pair = coupling.segments, len(coupling.pairs)
    share = np.minimum(segments.covered, 1.0)
    share[segments.whole] = 1.0
    weights = coupling.masses.sum(axis=2)
    weights[segments.whole] = whole_weights(nodes, segments.minus)[segments.whole]
    corner_columns = np.arange(4)
    blocks = (1.0 - share)[:, None, None] * coupling.masses
    blocks[:, corner_columns, corner_columns] += share[:, None] * weights
    rows = np.repeat(coupling.columns[:, :, None], 4, axis=2).ravel()
    columns = np.repeat(coupling.columns[:, None, :], 4, axis=1).ravel()
    mean = sp.csr_array((blocks.ravel(), (rows, columns)), shape=(n_pair, n_pair))
    mean.eliminate_zeros()
    host = _shared_points(coupling)
    hosts, which = np.unique(host, return_inverse=True)
    join = sp.csr_array((np.ones(n_pair), (which, np.arange(n_pair))), shape=(len(hosts), n_pair))
    joined = sp.csr_array(join @ mean)
    area = np.asarray(joined.sum(axis=1)).ravel()
    shape = sp.csr_array(sp.diags_array(1.0 / area) @ joined)
    first = np.full(n_pair, len(segments.minus))
    np.minimum.at(first, coupling.columns, np.repeat(_facet_numbers(coupling)[:, None], 4, axis=1))
    return ContactPoints(
        shape=shape,
        points=shape @ nodes[coupling.pairs[:, 0]],
        weights=area,
        normals=unit(shape @ pair_normals),
        faces=first[hosts],
        rule="nodal",
    )


def _shared_points(coupling: Coupling) -> Indices:
    """Return the pair whose contact point each pair (n_pair,) shares; itself if covered enough."""
    n_pair = len(coupling.pairs)
    host = np.arange(n_pair)
    # Ranks are distinct, so that no two pairs choose each other.
    rank = np.argsort(np.argsort(coupling.coverage, kind="stable"), kind="stable")
    best = coupling.columns[np.arange(len(coupling.columns)), rank[coupling.columns].argmax(axis=1)]
    order = np.argsort(rank[best], kind="stable")
    neighbour = host.copy()
    # The last write wins: the best of all facets around a pair.
    neighbour[coupling.columns[order].ravel()] = np.repeat(best[order], 4)
    small = coupling.coverage < SMALLEST_COVERAGE
    host[small] = neighbour[small]
    while not np.array_equal(host[host], host):
        host = host[host]
    return host
