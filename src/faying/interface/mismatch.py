"""Diagnosis of two surfaces whose meshes should match and do not."""

from typing import NoReturn

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Indices, Mask, Matrix
from faying.exceptions import ModelError
from faying.interface.curved_surface import arc_heights
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec
from faying.model.surface import Facets, facet_area_vectors, facet_centres

LARGEST_COSINE = -0.7
"""Largest cosine between the outward normals of facets in contact."""


def check_no_mismatch(
    assembly: Assembly,
    spec: InterfaceSpec,
    facets: Facets,
    side: Indices,
    matched: Mask,
    tolerance: float,
) -> None:
    """Refuse facets on the surface of the other side without a partner there.

    A facet lies on the other side if its centre is inside a facet of opposite orientation and
    within the tolerance of its plane; on curved surfaces the height of the arc over the facet is
    added to the tolerance. Arguments are all facets that may touch, the side of each, and whether
    it has a partner (n_facet,).
    """
    orphan = _resting(assembly.mesh.nodes, facets, side, ~matched, tolerance)
    if not orphan.any():
        return
    rows = np.flatnonzero(orphan)
    rows = rows[np.argsort(side[rows], kind="stable")]
    miss = _largest_miss(assembly.mesh.nodes, facets, side, rows)
    cause = (
        f"their nodes miss each other by up to {miss:g} (tolerance {tolerance:g})"
        if miss > tolerance
        else "their nodes coincide but form other facets (other diagonals, or linear facets "
        "against quadratic ones)"
    )
    message = (
        f"interface '{spec.name}': non-matching faces. "
        f"{_count_text(spec, side, matched, orphan)}, first "
        f"{facet_place(assembly, facets, rows[0])}; {cause}. "
        'Give the interface meshes = "non-matching" (mortar projection), mesh both sides from the '
        "same imprinted face, or raise the tolerance if this is only rounding"
    )
    raise ModelError(message)


def raise_no_contact(
    assembly: Assembly, spec: InterfaceSpec, facets: Facets, side: Indices, tolerance: float
) -> NoReturn:
    """Report sides that touch nowhere, with the smallest distance between their nodes."""
    distance, first_node, second_node = _closest_nodes(assembly, facets, side)
    ids = assembly.mesh.node_ids
    within = f"tolerance {tolerance:g}"
    if spec.search_distance is not None:
        within = f"search distance {spec.search_distance:g}"
        advice = (
            "no facet sees the other side along its outward normal; check which facets the sides "
            "select and which way they face, or search farther"
        )
    elif distance <= tolerance:
        advice = "they share only edges or points; check which facets the sides select"
    else:
        advice = "move the parts together, check the sides, or give a larger tolerance"
    message = (
        f"interface '{spec.name}' is empty: {_sides(spec)} have no facet in common; the closest "
        f"nodes, {ids[first_node]} and {ids[second_node]}, are {distance:g} apart ({within}); "
        f"{advice}"
    )
    raise ModelError(message)


def _resting(nodes: Matrix, facets: Facets, side: Indices, chosen: Mask, tolerance: float) -> Mask:
    """Return which of the chosen facets have their centre on a facet of another side."""
    rows = np.flatnonzero(chosen)
    resting = np.zeros(len(facets), dtype=bool)
    if not rows.size:
        return resting
    centres = facet_centres(nodes, facets)
    corners = nodes[facets.corners]
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    vectors = facet_area_vectors(nodes, facets)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    normals = vectors / np.where(length > 0, length, 1.0)
    arc = arc_heights(corners, facets, normals)
    neighbours = cKDTree(centres[rows]).query_ball_point(centres, 1.01 * radius + tolerance)
    host = np.repeat(
        np.arange(len(facets)), np.fromiter(map(len, neighbours), np.int64, len(neighbours))
    )
    guest = rows[np.concatenate([np.asarray(part, dtype=np.int64) for part in neighbours])]
    keep = side[host] != side[guest]
    host, guest = host[keep], guest[keep]
    offset = centres[guest] - centres[host]
    height = np.abs(np.einsum("kd,kd->k", offset, normals[host]))
    facing = np.einsum("kd,kd->k", normals[host], normals[guest]) < LARGEST_COSINE
    # With a zero tolerance round-off of decimal coordinates would decide.
    slack = tolerance + arc[host] + arc[guest] + 1e-9 * radius[host]
    on = facing & (height <= slack) & _inside(centres[guest], corners[host], normals[host])
    resting[guest[on]] = True
    return resting


def _inside(points: Matrix, corners: Matrix, normals: Matrix) -> Mask:
    """Return whether points (k, 3), seen along the normals, lie in the polygons (k, 4, 3)."""
    edges = np.roll(corners, -1, axis=1) - corners
    across = np.cross(edges, points[:, None] - corners)
    turn = np.einsum("kcd,kd->kc", across, normals)
    scale = np.einsum("kcd,kcd->k", edges, edges)
    return np.asarray((turn >= -1e-9 * scale[:, None]).all(axis=1))


def _largest_miss(nodes: Matrix, facets: Facets, side: Indices, rows: Indices) -> float:
    """Return the largest distance of unmatched nodes of the lowest side from nodes of others."""
    labels = side[rows[0]]
    guests = _nodes(facets.taken(rows[side[rows] == labels]))
    hosts = _nodes(facets.taken(side != labels))
    return float(cKDTree(nodes[hosts]).query(nodes[guests])[0].max())


def _closest_nodes(assembly: Assembly, facets: Facets, side: Indices) -> tuple[float, int, int]:
    """Return the smallest distance between nodes of different sides, and these nodes."""
    nodes = assembly.mesh.nodes
    best = (np.inf, -1, -1)
    for body in np.unique(side)[:-1]:  # bodies, of which there are few
        inside_nodes, outside_nodes = (
            _nodes(facets.taken(side == body)),
            _nodes(facets.taken(side > body)),
        )
        distance, nearest = cKDTree(nodes[outside_nodes]).query(nodes[inside_nodes])
        index = int(distance.argmin())
        best = min(
            best,
            (float(distance[index]), int(inside_nodes[index]), int(outside_nodes[nearest[index]])),
        )
    return best


def _nodes(facets: Facets) -> Indices:
    return np.unique(facets.nodes[facets.nodes >= 0])


def _count_text(spec: InterfaceSpec, side: Indices, matched: Mask, orphan: Mask) -> str:
    """Return a message with the numbers of overlapping and of matching facets of each side."""
    overlap = matched | orphan
    if spec.minus == "auto" and spec.plus == "auto":
        return (
            f"{overlap.sum()} facets of different bodies lie on each other, {orphan.sum()} of them "
            "without a partner"
        )
    parts = [
        f"{(overlap & (side == s)).sum()} of {(side == s).sum()} facets of {name}={selection!r}"
        for s, name, selection in ((0, "minus", spec.minus), (1, "plus", spec.plus))
    ]
    return f"{' and '.join(parts)} lie on the other side, {orphan.sum()} of them without a partner"


def _sides(spec: InterfaceSpec) -> str:
    if spec.minus == "auto" and spec.plus == "auto":
        return "the bodies"
    return f"minus={spec.minus!r} and plus={spec.plus!r}"


def facet_place(assembly: Assembly, facets: Facets, row: int) -> str:
    """Return a description of the position of a facet: centre and node ids."""
    chosen = facets.taken(np.array([row]))
    x, y, z = facet_centres(assembly.mesh.nodes, chosen)[0]
    ids = assembly.mesh.node_ids[chosen.nodes[chosen.nodes >= 0]]
    return f"at ({x:g}, {y:g}, {z:g}), nodes {', '.join(map(str, ids))}"
