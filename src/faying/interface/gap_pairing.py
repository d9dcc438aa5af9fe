"""Pairing of facets of declared contact surfaces across any gap between them."""

from dataclasses import replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.interface.coupling import whole_weights
from faying.interface.hidden_facets import Reach, facet_depths
from faying.interface.interface import FacePairs
from faying.interface.segments import Segments, find_segments
from faying.interface.selection import DEFAULT_TOLERANCE, candidates, select_facets
from faying.model.assembly import Assembly
from faying.model.elements import FACES
from faying.model.specs import InterfaceSpec
from faying.model.surface import Facets, facet_area_vectors, rows_by_kind

_SMALLEST_SHARE = 2.5 * DEFAULT_TOLERANCE
"""Share of a facet that its neighbours' partners may cover if nodes differ by the tolerance."""


def reach_of(assembly: Assembly, spec: InterfaceSpec, minus: Facets, plus: Facets) -> Reach | None:
    """Return the search distances of an interface; None where its sides must touch."""
    if spec.search_distance is None:
        return None
    return Reach(
        gap=spec.search_distance,
        minus=facet_depths(assembly.mesh, minus),
        plus=facet_depths(assembly.mesh, plus),
    )


def pairs_across(assembly: Assembly, spec: InterfaceSpec) -> tuple[FacePairs, ...]:
    """Return facets matched across a gap, node on node along the normals of the minus side.

    Sides are named and have a search distance. There is one entry per facet kind; none where the
    meshes do not match, or no facets face each other.

    Notes
    -----
    Facets without a partner are left out.
    """
    nodes = assembly.mesh.nodes
    facets, side = candidates(assembly, spec)
    extended = np.linalg.norm(facet_area_vectors(nodes, facets), axis=1) > 0
    minus, plus = (facets.taken(extended & (side == number)) for number in (0, 1))
    segments = find_segments(nodes, minus, plus, 0.0, reach_of(assembly, spec, minus, plus))
    minus_of, plus_of = _partners(nodes, segments)
    minus, plus = segments.minus.taken(minus_of), segments.plus.taken(plus_of)
    one_each = all(len(np.unique(of)) == len(of) for of in (minus_of, plus_of))
    same_kinds = np.array_equal(minus.nodes >= 0, plus.nodes >= 0)
    if not len(minus) or not one_each or not same_kinds:
        return ()
    entries = []
    for kind, rows in rows_by_kind(minus.nodes).items():
        n_node = FACES[kind].n_nodes
        below, above = minus.nodes[rows, :n_node], plus.nodes[rows, :n_node]
        columns = _partner_nodes(kind, nodes[below], nodes[above], segments.frames[minus_of[rows]])
        if columns is None:
            return ()
        aligned = np.take_along_axis(above, columns, axis=1)
        entries.append(FacePairs(kind=kind, minus=below, plus=aligned))
    return tuple(entries)


def _partners(nodes: Matrix, segments: Segments) -> tuple[Indices, Indices]:
    """Return the pairs of facets whose common part exceeds round-off."""
    code = segments.minus_of * len(segments.plus) + segments.plus_of
    pairs, which = np.unique(code, return_inverse=True)
    common = np.bincount(which.ravel(), segments.areas, len(pairs))
    minus_of, plus_of = np.divmod(pairs, len(segments.plus)) if len(pairs) else (pairs, pairs)
    sizes: list[Vector] = [
        np.linalg.norm(facet_area_vectors(nodes, facets), axis=1)[of]
        for facets, of in ((segments.minus, minus_of), (segments.plus, plus_of))
    ]
    covered = common > _SMALLEST_SHARE * np.minimum(*sizes)
    return minus_of[covered], plus_of[covered]


def _partner_nodes(kind: str, minus: Matrix, plus: Matrix, frames: Matrix) -> Indices | None:
    """Return the plus node (n, k) above each minus node; None unless they match one to one."""
    below, above = (np.einsum("nkd,nad->nka", x, frames[:, :2]) for x in (minus, plus))
    apart = np.linalg.norm(below[:, :, None] - above[:, None], axis=3)
    nearest: Indices = apart.argmin(axis=2)
    corners = below[:, : FACES[kind].n_corners]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    miss = np.take_along_axis(apart, nearest[..., None], axis=2)[..., 0]
    single = (np.sort(nearest, axis=1) == np.arange(minus.shape[1])).all()
    close = (miss <= DEFAULT_TOLERANCE * edges.min(axis=1, initial=np.inf)[:, None]).all()
    return nearest if single and close else None


def declared_area(assembly: Assembly, spec: InterfaceSpec) -> float | None:
    """Return the area of the smaller side that is given as faces; None if neither is.

    Sides given as elements, properties or bodies only tell what may touch, not where.
    """
    named = {*assembly.face_sets, *assembly.mesh.node_sets}
    sides = [side for side in (spec.minus, spec.plus) if isinstance(side, str) and side in named]
    areas = [
        float(whole_weights(assembly.mesh.nodes, select_facets(assembly, side)).sum())
        for side in sides
    ]
    return min(areas, default=None)


def declared(assembly: Assembly, spec: InterfaceSpec) -> InterfaceSpec:
    """Return the spec of a declared interface, with ``meshes`` set by whether they match."""
    matching = bool(pairs_across(assembly, spec))
    return replace(spec, meshes="matching" if matching else "non-matching")
