"""Pairing of touching facets of two bodies, and of their nodes.

The conforming interfaces of the zero-thickness elements of Eq. (15.11): every facet of one side
has one partner on the other, node on node.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from faying._typing import Indices, Mask, Matrix
from faying.exceptions import ModelError, refuse_model
from faying.interface.gap_pairing import pairs_across
from faying.interface.interface import FacePairs, Interface
from faying.interface.mismatch import check_no_mismatch, facet_place, raise_no_contact
from faying.interface.selection import candidates, touching_tolerance
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec
from faying.model.surface import WIDTH, Facets, facet_area_vectors, unique_rows


@dataclass(frozen=True, eq=False, kw_only=True)
class _Matches:
    """Coincident facets (columns of ``plus`` follow ``minus``) and their sides (n_facet, 2)."""

    minus: Facets
    plus: Facets
    sides: Indices

    def taken(self, chosen: Mask) -> "_Matches":
        return _Matches(
            minus=self.minus.taken(chosen),
            plus=self.plus.taken(chosen),
            sides=self.sides[chosen],
        )


def pair_facets(assembly: Assembly, spec: InterfaceSpec) -> tuple[FacePairs, ...]:
    """Return the matched facets of the two sides of an interface, one entry per facet kind.

    Named sides: facets of ``minus`` with a coincident facet of opposite orientation on ``plus``;
    others on either side may lie off the overlap. ``"auto"`` on both sides: all coincident exterior
    facets of different bodies, where the body with the smallest node id is the minus side.
    ``"auto"`` on one side: all facets that are not on the other side.

    Raises
    ------
    ModelError
        If a side has no facets, nothing matches, facets lie on the other side's surface without
        a partner, or the bodies overlap.

    Notes
    -----
    k-d trees and one sort of the facets; nodes match if their distance is below the tolerance, so
    the sides may also be separated by a smaller gap.
    """
    return _face_pairs(_matches(assembly, spec))


def find_interfaces(assembly: Assembly, spec: InterfaceSpec) -> dict[str, tuple[FacePairs, ...]]:
    """Match facets as :func:`pair_facets`, one interface per pair of bodies where sides are "auto".

    Interfaces have the name of the spec, or ``name-1``, ``name-2``, … for several pairs of bodies,
    in the order of their smallest node ids. Facets are matched across gaps if the spec has a search
    distance.
    """
    if spec.search_distance is not None:
        faces = pairs_across(assembly, spec)
        if not faces:
            raise ModelError(_mismatch_message(spec))
        return {spec.name: faces}
    matches = _matches(assembly, spec)
    if spec.minus != "auto" or spec.plus != "auto":
        return {spec.name: _face_pairs(matches)}
    _, group, counts = unique_rows(matches.sides)
    names = [f"{spec.name}-{i + 1}" for i in range(len(counts))] if len(counts) > 1 else [spec.name]
    return {name: _face_pairs(matches.taken(group == i)) for i, name in enumerate(names)}


def _mismatch_message(spec: InterfaceSpec) -> str:
    return (
        f"interface '{spec.name}': the facets of minus={spec.minus!r} and plus={spec.plus!r} do "
        f"not lie node on node within the search distance {spec.search_distance:g}; give it "
        'meshes = "non-matching" (mortar projection), or a larger search_distance'
    )


def _matches(assembly: Assembly, spec: InterfaceSpec) -> _Matches:
    facets, side = candidates(assembly, spec)
    nodes = assembly.mesh.nodes
    tolerance = touching_tolerance(nodes, facets, spec)
    labels = _coincident_nodes(nodes, facets, tolerance)
    # The extra last label is for the unused columns.
    keys = np.sort(np.append(labels, -1)[facets.nodes], axis=1)
    _check_not_collapsed(keys, facets, assembly, spec, tolerance)
    first, second = _coincident_facets(keys, side, facets, assembly, spec)
    _check_facing(facet_area_vectors(nodes, facets), first, second, facets, assembly, spec)
    matched = np.zeros(len(facets), dtype=bool)
    matched[first] = matched[second] = True
    check_no_mismatch(assembly, spec, facets, side, matched, tolerance)
    if not matched.any():
        raise_no_contact(assembly, spec, facets, side, tolerance)
    plus = _align_columns(labels, facets.taken(first), facets.taken(second))
    sides = np.column_stack([side[first], side[second]])
    return _Matches(minus=facets.taken(first), plus=plus, sides=sides)


def _coincident_nodes(nodes: Matrix, facets: Facets, tolerance: float) -> Indices:
    """Return labels of nodes (n_node,) that are equal for coincident nodes.

    By clusters, not nearest neighbours: at an edge of two blocks on a base three nodes coincide,
    and a nearest neighbour may be the wrong one.
    """
    used = np.unique(facets.nodes[facets.nodes >= 0])
    links = cKDTree(nodes[used]).query_pairs(tolerance, output_type="ndarray")
    ones = np.ones(len(links), dtype=np.int8)
    graph = sp.coo_array((ones, (links[:, 0], links[:, 1])), shape=(len(used), len(used)))
    labels = np.full(len(nodes), -1, dtype=np.int64)
    labels[used] = connected_components(graph.tocsr(), directed=False)[1]
    return labels


def _coincident_facets(
    keys: Indices, side: Indices, facets: Facets, assembly: Assembly, spec: InterfaceSpec
) -> tuple[Indices, Indices]:
    """Return the facets on the two sides (lower side first) whose nodes all coincide."""
    _, group, counts = unique_rows(keys)
    order = np.lexsort((side, group))
    start = np.cumsum(counts) - counts
    # Sides are sorted within a group, so a group joins different sides if its ends differ.
    low, high = order[start], order[start + counts - 1]
    mixed = side[low] != side[high]
    crowded = np.flatnonzero(mixed & (counts > 2))
    if crowded.size:
        rows = order[start[crowded[0]] : start[crowded[0]] + counts[crowded[0]]]
        refuse_model(
            f"interface '{spec.name}': {len(rows)} facets coincide "
            f"{facet_place(assembly, facets, rows[0])}; two are expected. Do the two sides "
            "select the same facets, do bodies overlap, or is the tolerance "
            "larger than the thickness of a part?"
        )
    first, second = low[mixed], high[mixed]
    by_first = np.argsort(first)
    return first[by_first], second[by_first]


def _align_columns(labels: Indices, minus: Facets, plus: Facets) -> Facets:
    """Return ``plus`` with columns permuted so that column j coincides with that of ``minus``."""
    padded = np.append(labels, -1)
    of_minus = np.argsort(padded[minus.nodes], axis=1, kind="stable")
    of_plus = np.argsort(padded[plus.nodes], axis=1, kind="stable")
    nodes = np.empty_like(plus.nodes)
    np.put_along_axis(nodes, of_minus, np.take_along_axis(plus.nodes, of_plus, axis=1), axis=1)
    return Facets(
        nodes=nodes, elements=plus.elements, properties=plus.properties, bodies=plus.bodies
    )


def _face_pairs(matches: _Matches) -> tuple[FacePairs, ...]:
    plus = matches.plus.by_kind()
    return tuple(
        FacePairs(kind=kind, minus=nodes, plus=plus[kind])
        for kind, nodes in matches.minus.by_kind().items()
    )


def _check_not_collapsed(
    keys: Indices, facets: Facets, assembly: Assembly, spec: InterfaceSpec, tolerance: float
) -> None:
    """Refuse a tolerance in which nodes of one facet coincide."""
    repeated = (keys[:, 1:] == keys[:, :-1]) & (keys[:, 1:] >= 0)
    rows = np.flatnonzero(repeated.any(axis=1))
    if rows.size:
        refuse_model(
            f"interface '{spec.name}': nodes of one facet "
            f"{facet_place(assembly, facets, rows[0])} are within the tolerance "
            f"{tolerance:g} of each other; lower the tolerance, or repair the facet"
        )


def _check_facing(
    vectors: Matrix,
    first: Indices,
    second: Indices,
    facets: Facets,
    assembly: Assembly,
    spec: InterfaceSpec,
) -> None:
    """Refuse coincident facets that are identical or face the same way."""
    keys = facets.corner_keys
    shared = np.flatnonzero((keys[first] == keys[second]).all(axis=1))
    if shared.size:
        refuse_model(
            f"interface '{spec.name}': both sides select the same {shared.size} facets, for "
            f"example {facet_place(assembly, facets, first[shared[0]])}; name one body per side"
        )
    same = np.flatnonzero(np.einsum("fd,fd->f", vectors[first], vectors[second]) >= 0)
    if same.size:
        refuse_model(
            f"interface '{spec.name}': {same.size} of {len(first)} coincident facets face the same "
            f"way, for example {facet_place(assembly, facets, first[same[0]])}; the bodies "
            "overlap, or the nodes of a face set do not run counter-clockwise seen from outside"
        )


def check_not_doubled(interfaces: Mapping[str, Interface]) -> None:
    """Refuse two interfaces that pair the same facets, in either order of the sides.

    Notes
    -----
    One sort of all paired facets.
    """
    names = list(interfaces)
    tables, owners = [], []
    for number, name in enumerate(names):
        for faces in interfaces[name].faces:
            tables.append(_facet_keys(faces.minus, faces.plus))
            owners.append(np.full(len(faces.minus), number))
    if not tables:
        return
    owner = np.concatenate(owners)
    first, group, _ = unique_rows(np.concatenate(tables))
    again = np.flatnonzero(owner[first][group] != owner)
    if again.size:
        first, second = (
            names[number] for number in sorted((owner[first[group[again[0]]]], owner[again[0]]))
        )
        refuse_model(
            f"interfaces '{first}' and '{second}' pair the same {again.size} facets, whose contact "
            "would count twice; remove one of them (a deck's contact definitions need no "
            "repetition in the study)"
        )


def _facet_keys(minus: Indices, plus: Indices) -> Indices:
    """Return the sorted nodes (n, 16) of both facets, -1 in front."""
    both = np.sort(np.hstack([minus, plus]), axis=1)
    return np.pad(both, ((0, 0), (2 * WIDTH - both.shape[1], 0)), constant_values=-1)
