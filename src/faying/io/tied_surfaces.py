"""Tied or glued surfaces as equations."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.interface.facets import gauss_rule
from faying.interface.gap_pairing import declared_area, pairs_across
from faying.interface.mortar import find_couplings
from faying.interface.projection import nearest_places
from faying.interface.relative_displacement import tangents_of
from faying.interface.segment_points import on_side
from faying.interface.segments import Segments
from faying.interface.selection import WHOLE_AREA, candidates, select_facets
from faying.model.assembly import Assembly, Bush, Equation
from faying.model.elements import FACES
from faying.model.mesh import Mesh
from faying.model.specs import InterfaceSpec
from faying.model.surface import rows_by_kind


def moving_together(
    assembly: Assembly, specs: Iterable[InterfaceSpec]
) -> tuple[list[Equation], list[tuple[str, float]]]:
    """Return the equations with those of several ties added, and the names of incomplete ties.

    Each name comes with the share of the smaller surface that is tied.
    """
    equations: list[Equation] = []
    partial: list[tuple[str, float]] = []
    for spec in specs:
        tied, share = _tied_equations(assembly, spec)
        equations += tied
        if share < WHOLE_AREA:
            partial.append((spec.name, share))
    return equations, partial


def following(
    assembly: Assembly, node_indices: Indices, surface: str, reach: float
) -> tuple[tuple[Equation, ...], int]:
    """Return equations by which single nodes follow a surface, and the number of these nodes.

    Nodes (indices (n,)) follow within ``reach`` [length] of the surface; its own nodes
    need no equation.
    """
    facets = select_facets(assembly, surface)
    places = nearest_places(assembly.mesh.nodes, node_indices, facets, reach)
    free = ~np.isin(node_indices[places.rows], facets.nodes)
    rows = np.repeat(np.arange(int(free.sum())), places.shape.shape[1])
    shape = (int(free.sum()), len(assembly.mesh.nodes))
    follow = sp.csr_array(
        (places.shape[free].ravel(), (rows, places.columns[free].ravel())), shape=shape
    )
    follow.eliminate_zeros()
    slaves = node_indices[places.rows[free]]
    ones = np.ones(len(slaves))
    own_part = sp.csr_array((ones, (np.arange(len(slaves)), slaves)), shape=shape)
    return tuple(equal_motions(slaves, follow - own_part)), len(places.rows)


def with_elastic_layer(
    assembly: Assembly, spec: InterfaceSpec, normal: float, tangential: float
) -> Assembly:
    """Put springs between two surfaces at points where they overlap, regardless of gaps.

    At each point a new node has the relative displacement, and springs resist it: tractions per
    relative displacement, ``normal`` and ``tangential`` [force/length³]. The sides are non-matching
    and named, with a search distance.
    """
    (coupling,) = find_couplings(assembly, spec).values()
    for part in _layer_points(assembly.mesh, coupling.segments):
        mesh, count = assembly.mesh, len(part.areas)
        point_nodes = len(mesh.nodes) + np.arange(count)
        minus = sp.csr_array((-np.ones(count), (np.arange(count), point_nodes)))
        motion = part.motion.copy()
        motion.resize(minus.shape)
        across = tangents_of(part.normals)
        axes = np.stack([part.normals, across, np.cross(part.normals, across)], axis=1)
        stiffness = np.outer(part.areas, [normal, tangential, tangential, 0.0, 0.0, 0.0]).tolist()
        table = zip(point_nodes.tolist(), stiffness, axes, part.places, strict=True)
        bushes = [
            Bush.of_arrays(number, [node], springs, rows, place)
            for number, (node, springs, rows, place) in enumerate(table, assembly.largest_id + 1)
        ]
        assembly = replace(
            assembly,
            mesh=mesh.with_nodes(part.places),
            equations=(*assembly.equations, *equal_motions(point_nodes, motion + minus)),
            bushes=(*assembly.bushes, *bushes),
        )
    return assembly


class _LayerPoints(NamedTuple):
    """Points: relative displacement by nodes (n, n_node), places and normals (n, 3), areas (n,)."""

    motion: SparseMatrix
    places: Matrix
    normals: Matrix
    areas: Vector


def _layer_points(mesh: Mesh, segments: Segments) -> Iterator[_LayerPoints]:
    """Yield the Gauss points of the segments, for each pair of facet kinds."""
    nodes = mesh.nodes
    for (minus, minus_facets), (plus, others) in product(
        rows_by_kind(segments.minus.nodes).items(), rows_by_kind(segments.plus.nodes).items()
    ):
        rows = np.flatnonzero(
            np.isin(segments.minus_of, minus_facets) & np.isin(segments.plus_of, others)
        )
        if not len(rows):
            continue
        linear = all(FACES[kind].degree == 1 for kind in (minus, plus))
        rule = gauss_rule("tri3", 2 if linear else 4)
        seen = on_side("minus", minus, nodes, segments, rows, rule)
        facing = on_side("plus", plus, nodes, segments, rows, rule)
        minus_nodes = segments.minus.nodes[segments.minus_of[rows], : FACES[minus].n_nodes]
        partner = segments.plus.nodes[segments.plus_of[rows], : FACES[plus].n_nodes]
        vectors = seen.area_vectors
        slope = np.linalg.norm(vectors, axis=-1)
        frames = segments.frames[segments.minus_of[rows]]
        yield _LayerPoints(
            motion=_at_points(facing.shape, partner, nodes)
            - _at_points(seen.shape, minus_nodes, nodes),
            places=np.einsum("nqa,nad->nqd", seen.shape, nodes[minus_nodes]).reshape(-1, 3),
            normals=np.einsum("nqa,nad->nqd", vectors / slope[..., None], frames).reshape(-1, 3),
            areas=(2 * segments.areas[rows][:, None] * rule.weights * slope).ravel(),
        )


def _at_points(shape: Matrix, columns: Indices, nodes: Matrix) -> SparseMatrix:
    """Return shape functions (n, n_q, k) of nodes (n, k) as rows (n n_q, n_node)."""
    n, n_q, k = shape.shape
    rows = np.repeat(np.arange(n * n_q), k)
    every = np.repeat(columns[:, None], n_q, axis=1).ravel()
    return sp.csr_array((shape.ravel(), (rows, every)), shape=(n * n_q, len(nodes)))


def _tied_equations(assembly: Assembly, spec: InterfaceSpec) -> tuple[list[Equation], float]:
    """Return the equations of two surfaces, and the share of the smaller surface that they tie.

    Ties are node to node where the meshes match, else mortar means, with the minus side's own
    nodes first. The sides are non-matching and named, with a search distance.
    """
    pairs = _pairs(assembly, spec)
    pairs = pairs if len(pairs) else _opposite(assembly, spec)
    if len(pairs):
        return list(equal_motions(*_node_on_node(pairs, len(assembly.mesh.nodes)))), 1.0
    (coupling,) = find_couplings(assembly, spec).values()
    share = float(coupling.weights.sum()) / (declared_area(assembly, spec) or np.inf)
    return list(equal_motions(coupling.pairs[:, 0], coupling.motion)), share


def _pairs(assembly: Assembly, spec: InterfaceSpec) -> Indices:
    """Return the node pairs (n, 2) of matching surfaces; none where they do not match."""
    faces = pairs_across(assembly, spec)
    both = [np.column_stack([part.minus.ravel(), part.plus.ravel()]) for part in faces]
    return np.unique(np.concatenate([np.empty((0, 2), dtype=np.int64), *both]), axis=0)


def _opposite(assembly: Assembly, spec: InterfaceSpec) -> Indices:
    """Return the pairs (n, 2) of each minus node and the nearest plus node.

    There are none unless pairs are one to one, within the search distance, nearer than half an
    edge, and map minus facets to plus facets: meshes of one pattern in which nodes were
    moved.
    """
    none = np.empty((0, 2), dtype=np.int64)
    nodes = assembly.mesh.nodes
    facets, side = candidates(assembly, spec)
    minus, plus = (facets.nodes[side == side_number] for side_number in (0, 1))
    if not len(minus) or not len(plus):
        return none
    minus_nodes, others = (np.unique(part[part >= 0]) for part in (minus, plus))
    distance, nearest = cKDTree(nodes[others]).query(nodes[minus_nodes])
    corners = facets.taken(side == 0).corners
    edges = np.linalg.norm(nodes[np.roll(corners, 1, axis=1)] - nodes[corners], axis=2)
    reach = min(spec.search_distance or 0.0, float(edges[edges > 0].min()) / 2)
    if distance.max() > reach or len(np.unique(nearest)) < len(nearest):
        return none
    image = np.full(len(nodes) + 1, -1)
    image[minus_nodes] = others[nearest]
    if (facets.taken(side == 1).positions(image[minus]) < 0).any():
        return none
    return np.column_stack([minus_nodes, others[nearest]])


def _node_on_node(pairs: Indices, n_node: int) -> tuple[Indices, SparseMatrix]:
    rows = np.arange(len(pairs))
    ones = np.ones(len(pairs))
    plus = sp.csr_array((ones, (rows, pairs[:, 1])), shape=(len(pairs), n_node))
    return pairs[:, 0], plus - sp.csr_array((ones, (rows, pairs[:, 0])), shape=plus.shape)


def equal_motions(slave_nodes: Indices, motion: SparseMatrix) -> Iterator[Equation]:
    """Yield the equations of the relative displacements, slave nodes first."""
    table = motion.tocsr()
    for row, node in enumerate(slave_nodes.tolist()):
        part = slice(table.indptr[row], table.indptr[row + 1])
        terms = dict(zip(table.indices[part].tolist(), table.data[part].tolist(), strict=True))
        mine = terms.pop(node, 0.0)
        for c in range(3 if mine else 0):  # nodes without an opposite surface are not tied
            others = ((other, c, value) for other, value in terms.items())
            yield Equation(id=0, terms=((node, c, mine), *others))
