"""Interfaces between non-matching meshes, from a mortar coupling of their two sides."""

import numpy as np

from faying._typing import Indices, Matrix
from faying.contact.laws import Law
from faying.digits import SHORT_DIGITS, SOLVED
from faying.exceptions import naming, refuse_model
from faying.interface.coupling import Coupling, couple
from faying.interface.facets import area_vectors, reference_nodes
from faying.interface.gap_pairing import reach_of
from faying.interface.interface import FacePairs, Interface
from faying.interface.mismatch import facet_place, raise_no_contact
from faying.interface.mortar_points import contact_points
from faying.interface.relative_displacement import (
    combined_displacement,
    common_normal,
    unit,
)
from faying.interface.segments import Segments, find_segments
from faying.interface.selection import candidates, touching_tolerance
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.elements import FACES
from faying.model.specs import InterfaceSpec
from faying.model.surface import Facets, facet_area_vectors, rows_by_kind


def find_couplings(assembly: Assembly, spec: InterfaceSpec) -> dict[str, Coupling]:
    """Return the couplings of the sides of an interface between non-matching meshes, by name.

    Sides are as in :func:`faying.interface.pairing.pair_facets`; the minus side carries the contact
    points. The tolerance is the largest distance of surfaces that touch. Couplings have the name of
    the interface, or ``name-1``, ``name-2``, … where both sides are ``"auto"`` and several pairs of
    bodies touch.

    Raises
    ------
    ModelError
        If a side has no facets, the sides touch nowhere, or something is covered twice.
    """
    facets, side = candidates(assembly, spec)
    # Bricks collapsed to wedges have facets without area, which cannot touch.
    extended = np.linalg.norm(facet_area_vectors(assembly.mesh.nodes, facets), axis=1) > 0
    facets, side = facets.taken(extended), side[extended]
    tolerance = touching_tolerance(assembly.mesh.nodes, facets, spec)
    parts = []
    with naming(f"interface '{spec.name}'"):
        for body in np.unique(side)[:-1]:  # bodies, of which there are few
            others = np.flatnonzero(side > body)
            minus, plus = facets.taken(side == body), facets.taken(others)
            reach = reach_of(assembly, spec, minus, plus)
            segments = find_segments(assembly.mesh.nodes, minus, plus, tolerance, reach)
            parts += _by_body(segments, facets, side)
    if not parts:
        raise_no_contact(assembly, spec, facets, side, tolerance)
    for segments in parts:
        _check_once(assembly, spec, segments)
    names = [f"{spec.name}-{i + 1}" for i in range(len(parts))] if len(parts) > 1 else [spec.name]
    with naming(f"interface '{spec.name}'"):
        return {
            name: couple(assembly.mesh.nodes, segments)
            for name, segments in zip(names, parts, strict=True)
        }


def _by_body(segments: Segments, facets: Facets, side: Indices) -> list[Segments]:
    """Divide segments by the side of their plus facets."""
    if not len(segments):
        return []
    # Sides other than 0 and 1 are bodies, so the side follows from a node.
    of_node = np.zeros(int(facets.nodes.max()) + 1, dtype=np.int64)
    of_node[facets.corners] = side[:, None]
    owner = of_node[segments.plus.nodes[segments.plus_of, 0]]
    return [segments.touched(owner == body) for body in np.unique(owner)]


def _check_once(assembly: Assembly, spec: InterfaceSpec, segments: Segments) -> None:
    twice = np.flatnonzero(segments.covered > 1 + SHORT_DIGITS)
    if twice.size:
        refuse_model(
            f"interface '{spec.name}': {twice.size} facets of the minus side are covered more than "
            f"once, for example {facet_place(assembly, segments.minus, int(twice[0]))}; the plus "
            "side overlaps itself, or the tolerance is larger than the thickness of a part"
        )


def build_mortar_interface(
    assembly: Assembly, dofs: DofMap, spec: InterfaceSpec, coupling: Coupling, law: Law
) -> Interface:
    """Return the interface of a mortar coupling, the counterpart of Eq. (15.3), (15.11), (15.14).

    By default penalty contact has Gauss points and hard contact nodal ones. Gauss points are those
    of zero-thickness elements on facets that are wholly covered, and points of the segments
    elsewhere. Nodal points are the pairs.

    Raises
    ------
    ModelError
        If the order does not fit the quadrature.
    """
    nodes = assembly.mesh.nodes
    faces = _faces(coupling)
    raw_normals = _pair_normals(nodes, coupling)
    points = contact_points(nodes, spec, coupling, raw_normals, law)
    normals, pair_normals, flat = common_normal(points.normals, points.weights, raw_normals)
    return Interface(
        name=spec.name,
        faces=faces,
        pairs=coupling.pairs,
        pair_normals=pair_normals,
        motion_operator=combined_displacement(dofs, coupling.motion),
        flat=flat,
        point_shape=points.shape,
        initial_gap=points.shape @ coupling.gap,
        weights=points.weights,
        points=points.points,
        normals=normals,
        face_of_point=points.faces,
        law=law,
        quadrature=points.rule,
        coupling=coupling,
    )


def _faces(coupling: Coupling) -> tuple[FacePairs, ...]:
    """Return corners of the minus facets with the plus node next to each."""
    entries = []
    for kind, rows in rows_by_kind(coupling.segments.minus.nodes).items():
        linear = FACES[kind].linear
        corners = coupling.columns[rows, : FACES[linear].n_nodes]
        entries.append(
            FacePairs(
                kind=linear, minus=coupling.pairs[corners, 0], plus=coupling.pairs[corners, 1]
            )
        )
    return tuple(entries)


def _pair_normals(nodes: Matrix, coupling: Coupling) -> Matrix:
    """Return the facets' mean normals at the pairs, weighted with the local Jacobian."""
    total = np.zeros((len(coupling.pairs), 3))
    facets = coupling.segments.minus
    for kind, rows in rows_by_kind(facets.nodes).items():
        corners = reference_nodes(FACES[kind].linear)
        vectors = area_vectors(kind, nodes[facets.nodes[rows, : FACES[kind].n_nodes]], corners)
        whole = facet_area_vectors(nodes, facets.taken(rows))[:, None]
        # A collapsed corner has no Jacobian, but lies in the plane of its facet.
        collapsed = np.linalg.norm(vectors, axis=2) < SOLVED * np.linalg.norm(whole, axis=2)
        vectors = np.where(collapsed[..., None], whole, vectors)
        np.add.at(total, coupling.columns[rows, : len(corners)], vectors)
    return unit(total)
