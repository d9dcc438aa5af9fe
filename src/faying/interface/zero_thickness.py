"""Zero-thickness elements: the linear gap operator of an interface from matched facets."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix
from faying.contact.laws import Law
from faying.exceptions import refuse_model
from faying.interface.contact_points import ContactPoints, joined, on_facets
from faying.interface.facets import (
    Rule,
    area_vectors,
    gauss_rule,
    nodal_rule,
    reference_nodes,
)
from faying.interface.interface import FacePairs, Interface
from faying.interface.relative_displacement import (
    common_normal,
    relative_displacement,
    unit,
)
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.specs import InterfaceSpec


def build_interface(
    assembly: Assembly,
    dofs: DofMap,
    spec: InterfaceSpec,
    faces: tuple[FacePairs, ...],
    law: Law,
) -> Interface:
    """Return the zero-thickness elements of an interface, Eq. (15.3), (15.11), (15.14).

    Geometry (points, areas, normals) is that of the surface midway between the two sides. By
    default penalty contact has Gauss points and hard contact nodal ones. Linear facets have no more
    nodal points than node pairs, so that hard contact forces are unique. With nodal quadrature the
    points shared by facets are one point with the sum of areas; ``face_of_point`` is the first of
    these facets.

    Notes
    -----
    Linear in the number of contact points. The two sides of a pair have exactly opposite entries,
    so Newton's third law, Eq. (15.4), holds to the last bit.
    """
    if not faces:
        refuse_model(f"interface '{spec.name}' has no facets; pair the facets of its sides first")
    nodes = assembly.mesh.nodes
    rules = [contact_rule(spec, entry.kind, law) for entry in faces]
    pairs, columns = _node_pairs(faces, len(nodes))
    middle = nodes[pairs].mean(axis=1)
    points = _merge_points(*_all_points(spec.name, faces, columns, rules, middle))
    normals, pair_normals, flat = common_normal(
        points.normals, points.weights, pair_normals_of(faces, columns, middle)
    )
    separation = points.shape @ (nodes[pairs[:, 1]] - nodes[pairs[:, 0]])
    return Interface(
        name=spec.name,
        faces=faces,
        pairs=pairs,
        pair_normals=pair_normals,
        motion_operator=relative_displacement(dofs, pairs),
        flat=flat,
        point_shape=points.shape,
        initial_gap=np.einsum("kd,kd->k", normals, separation),
        weights=points.weights,
        points=points.points,
        normals=normals,
        face_of_point=points.faces,
        law=law,
        quadrature=points.rule,
    )


def contact_rule(spec: InterfaceSpec, kind: str, law: Law) -> Rule:
    """Return the quadrature rule of the contact points of a facet."""
    quadrature = spec.quadrature or ("nodal" if np.isinf(law.penalty) else "gauss")
    if quadrature == "gauss":
        return gauss_rule(kind, spec.order)
    if spec.order is not None:
        refuse_model(
            f"interface '{spec.name}': order {spec.order} is given but nodal quadrature has none; "
            "leave the order out or take quadrature = 'gauss'"
        )
    return nodal_rule(kind)


def _node_pairs(faces: tuple[FacePairs, ...], n_node: int) -> tuple[Indices, list[Indices]]:
    """Return unique pairs (n_pair, 2) and, per entry of faces, the pair of each of its nodes."""
    codes = np.concatenate([(f.minus * n_node + f.plus).ravel() for f in faces])
    unique, inverse = np.unique(codes, return_inverse=True)
    ends = np.cumsum([f.minus.size for f in faces])[:-1]
    shapes = [f.minus.shape for f in faces]
    split = np.split(inverse.ravel(), ends)
    columns = [part.reshape(shape) for part, shape in zip(split, shapes, strict=True)]
    return np.column_stack(np.divmod(unique, n_node)), columns


def _all_points(
    name: str,
    faces: tuple[FacePairs, ...],
    columns: list[Indices],
    rules: list[Rule],
    middle: Matrix,
) -> tuple[ContactPoints, Indices]:
    """Return the points of all facets, and the pair at each point, -1 for none."""
    parts, at_pair, first_face = [], [], 0
    for entry, local, rule in zip(faces, columns, rules, strict=True):
        kind, numbers = entry.kind, first_face + np.arange(len(local))
        part = on_facets(kind, middle[local], rule, numbers, kind, local, len(middle))
        empty = np.flatnonzero(part.weights <= 0)
        if len(empty):
            x, y, z = middle[local[empty[0] // len(rule.weights)]].mean(axis=0)
            refuse_model(
                f"interface '{name}': a {kind} facet at ({x:g}, {y:g}, {z:g}) has no area; "
                "repair the mesh there"
            )
        parts.append(part)
        at_pair.append(np.where(rule.nodes >= 0, local[:, rule.nodes], -1).ravel())
        first_face += len(local)
    return joined(parts), np.concatenate(at_pair)


def _merge_points(raw: ContactPoints, at_pair: Indices) -> ContactPoints:
    """Return points with those at one node pair joined: they share one gap, and need one force."""
    alone = len(raw.weights) + np.arange(len(raw.weights))
    key = np.where(at_pair >= 0, at_pair, alone)
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    ones = np.ones(len(key))
    join = sp.csr_array(
        (ones, (rank[group.ravel()], np.arange(len(key)))), shape=(len(order), len(key))
    )
    first_rows = first[order]
    return replace(
        raw,
        shape=raw.shape[first_rows],
        points=raw.points[first_rows],
        weights=join @ raw.weights,
        normals=unit(join @ (raw.weights[:, None] * raw.normals)),
        faces=raw.faces[first_rows],
    )


def pair_normals_of(faces: tuple[FacePairs, ...], columns: list[Indices], middle: Matrix) -> Matrix:
    """Return the facets' mean normals at the pairs, weighted with the local Jacobian."""
    total = np.zeros((len(middle), 3))
    for entry, local in zip(faces, columns, strict=True):
        vectors = area_vectors(entry.kind, middle[local], reference_nodes(entry.kind))
        np.add.at(total, local, vectors)
    return unit(total)
