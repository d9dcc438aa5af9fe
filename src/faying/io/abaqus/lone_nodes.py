"""Slave surfaces of single nodes: a contact point for each, as CalculiX has it.

CalculiX (node-to-face penalty contact): the force of a node is its pressure times its share of the
exterior faces of solids that it belongs to, or, without any, the area of the master face that it
projects onto. Here that node and the place below it each carry a triangle of this area, which moves
with them without turning.
"""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Vector
from faying.interface.projection import nearest_places
from faying.interface.selection import select_facets
from faying.io.abaqus.contact import Pair
from faying.io.abaqus.surfaces import DeckSurface
from faying.io.tied_surfaces import equal_motions
from faying.model.assembly import Assembly, FaceSet
from faying.model.elements import FACES
from faying.model.surface import facet_area_vectors, facet_frames, rows_by_kind

_SHARES = {"tri6": (1 / 999, 332 / 999), "quad8": (0.01, 0.24)}
"""Of the area of a facet with mid-side nodes, as in CalculiX: corners, mid-side nodes."""

_LARGEST_DISTANCE = 1e-3
"""How far beside its facet a node may lie, over the size of the facet, as in CalculiX."""


def with_lone_nodes(
    assembly: Assembly, pairs: list[Pair], ignored: list[str]
) -> tuple[Assembly, list[Pair]]:
    """Put a contact pair for each node in place of pairs whose slave has no whole facet."""
    replaced: list[Pair] = []
    for pair in pairs:
        if pair.slave.facets or _whole(assembly, pair.slave):
            replaced.append(pair)
            continue
        assembly, points = _points(assembly, pair)
        if not points:
            pair.keyword.refuse(
                f"no node of surface '{pair.slave.name}' lies above '{pair.master.name}'", pair.row
            )
        replaced += points
        ignored.append(
            f"slave surface {pair.slave.name} has no whole facet: {len(points)} of its "
            f"{len(pair.slave.nodes)} nodes are contact points, each an interface, with its share "
            "of all exterior facets around it, as in CalculiX (Abaqus takes an area of 1)"
        )
    return assembly, replaced


def _whole(assembly: Assembly, surface: DeckSurface) -> bool:
    inside = np.zeros(len(assembly.mesh.nodes) + 1, dtype=bool)
    inside[surface.nodes] = inside[-1] = True
    return bool(inside[assembly.mesh.exterior.nodes].all(axis=1).any())


def _points(assembly: Assembly, pair: Pair) -> tuple[Assembly, list[Pair]]:
    nodes, slaves = assembly.mesh.nodes, pair.slave.nodes
    facets = select_facets(assembly, pair.master.name)
    apart = nodes[slaves][:, None] - nodes[np.unique(facets.corners)][None]
    areas = np.linalg.norm(facet_area_vectors(nodes, facets), axis=1)
    reach = np.linalg.norm(apart, axis=2).min(axis=1).max() + _LARGEST_DISTANCE * np.sqrt(
        areas.max()
    )
    places = nearest_places(nodes, slaves, facets, float(reach))
    frames = facet_frames(nodes, facets)
    shares = _shares(assembly)
    points = []
    for row, facet, columns, shape in zip(
        places.rows, places.facets, places.columns, places.shape, strict=True
    ):
        node, below = int(slaves[row]), shape @ nodes[columns]
        sideways = np.linalg.norm(frames[facet, :2] @ (nodes[node] - below))
        if sideways > _LARGEST_DISTANCE * np.sqrt(areas[facet]):
            continue
        triangle = _triangle(frames[facet], float(shares[node] or areas[facet]))
        of_place = sp.csr_array((shape, (np.zeros(len(shape), dtype=int), columns)))
        of_node = sp.csr_array(([1.0], ([0], [node])))
        assembly, minus = _carried(assembly, nodes[node] + triangle[::-1], of_node)
        assembly, plus = _carried(assembly, below + triangle, of_place)
        number = int(assembly.mesh.node_ids[node])
        sides = _sides(pair, number, minus, plus)
        named = {side.name: FaceSet(kind="tri3", nodes=side.facets["tri3"]) for side in sides}
        assembly = replace(assembly, face_sets={**assembly.face_sets, **named})
        interaction = replace(pair.interaction, name=f"{pair.interaction.name} node {number}")
        points.append(
            replace(pair, slave=sides[0], master=sides[1], interaction=interaction, lone=True)
        )
    return assembly, points


def _shares(assembly: Assembly) -> Vector:
    """Areas of nodes (n_node,), zero inside and off solids."""
    mesh = assembly.mesh
    exterior = mesh.exterior
    areas = np.linalg.norm(facet_area_vectors(mesh.nodes, exterior), axis=1)
    shares = np.zeros(len(mesh.nodes))
    for kind, rows in rows_by_kind(exterior.nodes).items():
        face = FACES[kind]
        corner, middle = _SHARES.get(kind, (1 / face.n_corners, 0.0))
        share = np.where(np.arange(face.n_nodes) < face.n_corners, corner, middle)
        np.add.at(shares, exterior.nodes[rows, : face.n_nodes], np.outer(areas[rows], share))
    return shares


def _triangle(frame: Vector, area: float) -> Vector:
    """Corners (3, 3) of an equilateral triangle about the origin, seen from outside."""
    angles = 2 * np.pi / 3 * np.arange(3)
    radius = np.sqrt(area / (0.75 * np.sqrt(3)))
    corners = radius * np.column_stack([np.cos(angles), np.sin(angles)]) @ frame[:2]
    return np.asarray(corners)


def _carried(assembly: Assembly, corners: Vector, motion: sp.csr_array) -> tuple[Assembly, Indices]:
    """Add nodes (3,) that all move as one place does, by shape functions (1, n_node)."""
    mesh = assembly.mesh
    added = len(mesh.nodes) + np.arange(3)
    first = max((equation.id for equation in assembly.equations), default=0) + 1
    follow = sp.csr_array((np.ones(3), (np.arange(3), np.zeros(3, dtype=int)))) @ motion
    follow.resize((3, len(mesh.nodes) + 3))
    minus = sp.csr_array((np.full(3, -1.0), (np.arange(3), added)), shape=follow.shape)
    ids = mesh.node_ids.max() + 1 + np.arange(3)
    return replace(
        assembly,
        mesh=replace(
            mesh,
            nodes=np.vstack([mesh.nodes, corners]),
            node_ids=np.append(mesh.node_ids, ids),
        ),
        equations=(*assembly.equations, *equal_motions(added, follow + minus, first)),
    ), added


def _sides(pair: Pair, number: int, *ends: Indices) -> list[DeckSurface]:
    surfaces = (pair.slave, pair.master)
    return [
        replace(side, name=f"{side.name} at {number}", facets={"tri3": nodes[None]}, nodes=nodes)
        for side, nodes in zip(surfaces, ends, strict=True)
    ]
