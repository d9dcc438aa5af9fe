"""Projection of single nodes onto a surface: the nearest facet, and the position on it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Indices, Matrix, Vector
from faying.interface.facets import shape_functions
from faying.interface.inverse_map import reference_coordinates
from faying.model.elements import FACES
from faying.model.surface import Facets, facet_centres, facet_frames, rows_by_kind


@dataclass(frozen=True, eq=False, kw_only=True)
class Places:
    """Positions of nodes on a surface; nodes too far from it are left out.

    Attributes
    ----------
    rows : (n,)
        Number of the node of each position.
    facets : (n,)
        Facet of each position.
    columns : (n, 8)
        Nodes of that facet; unused columns repeat the first.
    shape : (n, 8)
        Their shape functions there, whose sum is one; zero in unused columns.
    """

    rows: Indices
    facets: Indices
    columns: Indices
    shape: Matrix


def nearest_places(nodes: Matrix, points: Indices, facets: Facets, reach: float) -> Places:
    """Return the position on a surface nearest to each of some nodes, within reach [length].

    Nodes are (n_node, 3) [length], points (n,) the indices of those to project. For nodes beside
    the surface the position is on its edge.

    Notes
    -----
    Each facet near a node is tried along its normal, by its corners; on the nearest of them the
    position is refined if it has mid-side nodes. Linear in the number of facets near each node.
    """
    row, which = _near(nodes, points, facets, reach)
    frames = facet_frames(nodes, facets)[:, :2]
    distance = np.full(len(row), np.inf)
    for kind, members in rows_by_kind(facets.nodes).items():
        chosen = np.flatnonzero(np.isin(which, members))
        columns = facets.nodes[which[chosen], : FACES[kind].n_corners]
        shape = _shape_functions_at(
            FACES[kind].linear, nodes, columns, points[row[chosen]], frames[which[chosen]]
        )
        away = np.einsum("na,nad->nd", shape, nodes[columns]) - nodes[points[row[chosen]]]
        distance[chosen] = np.linalg.norm(away, axis=1)
    order = np.lexsort((distance, row))
    _, first = np.unique(row[order], return_index=True)
    best = order[first]
    best = best[distance[best] <= reach]
    columns = np.repeat(facets.nodes[which[best], :1], facets.nodes.shape[1], axis=1)
    shape = np.zeros(columns.shape)
    for kind, members in rows_by_kind(facets.nodes).items():
        chosen = np.flatnonzero(np.isin(which[best], members))
        n, facet_rows = FACES[kind].n_nodes, which[best[chosen]]
        columns[chosen, :n] = facets.nodes[facet_rows, :n]
        shape[chosen, :n] = _shape_functions_at(
            kind, nodes, columns[chosen, :n], points[row[best[chosen]]], frames[facet_rows]
        )
    return Places(rows=row[best], facets=which[best], columns=columns, shape=shape)


def _near(nodes: Matrix, points: Indices, facets: Facets, reach: float) -> tuple[Indices, Indices]:
    """Return the pairs of nodes (by row) and facets whose sphere is within reach."""
    centres, radii = facet_centres(nodes, facets), _radii(nodes, facets)
    around = cKDTree(centres).query_ball_point(nodes[points], reach + radii.max(initial=0.0))
    counts = np.fromiter(map(len, around), np.int64, len(around))
    empty = np.empty(0, dtype=np.int64)
    which = np.concatenate([empty, *(np.asarray(part, dtype=np.int64) for part in around)])
    row = np.repeat(np.arange(len(points)), counts)
    away = np.linalg.norm(nodes[points[row]] - centres[which], axis=1)
    close = away <= reach + radii[which]
    return row[close], which[close]


def _radii(nodes: Matrix, facets: Facets) -> Vector:
    away = nodes[facets.corners] - facet_centres(nodes, facets)[:, None]
    return np.asarray(np.linalg.norm(away, axis=2).max(axis=1, initial=0.0))


def _shape_functions_at(
    kind: str, nodes: Matrix, columns: Indices, points: Indices, frames: Matrix
) -> Matrix:
    """Return shape functions (n, k) of facets (n, k) at points (n,), restricted to the facets."""
    if not len(columns):
        return np.zeros(columns.shape)
    flat = np.einsum("nkd,nad->nka", nodes[columns], frames)
    seen = np.einsum("nd,nad->na", nodes[points], frames)
    coordinates = reference_coordinates(kind, flat, seen[:, None])[:, 0]
    if FACES[kind].n_corners == 4:
        coordinates = np.clip(coordinates, 0.0, 1.0)
    else:
        shares = np.maximum(np.column_stack([1.0 - coordinates.sum(axis=1), coordinates]), 0.0)
        coordinates = (shares / shares.sum(axis=1, keepdims=True))[:, 1:]
    shape = shape_functions(kind, coordinates)
    # Round-off of shape functions that vanish at nodes would fill equations.
    return np.where(np.abs(shape) < 1e-12, 0.0, shape)
