"""What holds the parts and what loads them, where a file says neither."""

import re
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask
from faying.interface.selection import select_facets
from faying.model.assembly import Assembly
from faying.model.mesh import Mesh

HELD = re.compile(r"fix|clamp|held|hold|support|ground|encast|spc", re.IGNORECASE)
LOADED = re.compile(r"load|tip|force|pull|push|press|traction", re.IGNORECASE)
"""What sets are often called that are held, and that are loaded."""


@dataclass(frozen=True, kw_only=True)
class Pin:
    """A node held so that with two others it keeps a body from moving and nothing else."""

    node: int
    components: tuple[str, ...]


def named(mesh: Mesh, pattern: re.Pattern[str]) -> list[str]:
    """Return the node sets whose names match, empty ones left out."""
    return [name for name, nodes in mesh.node_sets.items() if pattern.search(name) and len(nodes)]


def pins(assembly: Assembly, contact: Indices) -> list[Pin]:
    """Hold the largest body at three nodes, statically determinate, that touch no other bodies."""
    mesh = assembly.mesh
    usable = _outside(assembly, contact)
    label = mesh.bodies
    sizes = np.bincount(label[label >= 0])
    rows = np.flatnonzero(usable & (label == sizes.argmax()))
    if len(rows) < 3:
        return []
    places = mesh.nodes[rows]
    first = int(np.linalg.norm(places - places.mean(axis=0), axis=1).argmax())
    away = places - places[first]
    second = int(np.linalg.norm(away, axis=1).argmax())
    line = away[second] / (np.linalg.norm(away[second]) or 1.0)
    aside = away - np.outer(away @ line, line)
    third = int(np.linalg.norm(aside, axis=1).argmax())
    normal = np.cross(line, aside[third])
    ids = mesh.node_ids[rows]
    names = np.array(["ux", "uy", "uz"])
    across = np.delete(names, np.abs(line).argmax())
    return [
        Pin(node=int(ids[first]), components=tuple(names.tolist())),
        Pin(node=int(ids[second]), components=tuple(across.tolist())),
        Pin(node=int(ids[third]), components=(str(names[np.abs(normal).argmax()]),)),
    ]


def far_node(assembly: Assembly, fixed: Indices, contact: Indices) -> int | None:
    """Return the id of the node of the outside that is farthest from what is held."""
    mesh = assembly.mesh
    usable = _outside(assembly, contact)
    usable[fixed] = False
    rows = np.flatnonzero(usable)
    if not len(rows):
        return None
    centre = mesh.nodes[fixed].mean(axis=0) if len(fixed) else mesh.nodes[rows].mean(axis=0)
    far = np.linalg.norm(mesh.nodes[rows] - centre, axis=1).argmax()
    return int(mesh.node_ids[rows[far]])


def _outside(assembly: Assembly, contact: Indices) -> Mask:
    """Tell which nodes are corners of outer facets, touch no other body and follow no other."""
    mesh = assembly.mesh
    usable = np.zeros(len(mesh.nodes), dtype=bool)
    usable[mesh.exterior.corners.ravel()] = True
    usable[contact] = False
    for coupling in assembly.rigid_couplings:
        usable[coupling.nodes] = False
    for equation in assembly.equations:
        usable[[node for node, _, _ in equation.terms]] = False
    return usable


def loose_groups(assembly: Assembly, used: list[str], contact: Indices) -> list[str]:
    """Return the face sets that are neither taken nor touch another body."""
    inside = np.zeros(len(assembly.mesh.nodes) + 1, dtype=bool)
    inside[contact] = True
    groups = []
    for name in assembly.face_sets:
        nodes = np.unique(select_facets(assembly, name).corners)
        if name not in used and not inside[nodes].all():
            groups.append(name)
    return groups
