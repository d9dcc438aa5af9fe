"""Nodes, facets and node sets that a deck gives to matrices which come from elsewhere."""

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from faying._typing import Indices, Matrix
from faying.model.assembly import FaceSet
from faying.model.mesh import Mesh

ABAQUS = (".inp",)
NASTRAN = (".bdf", ".nas", ".fem")


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckGeometry:
    """What a deck says of places, by node id.

    Attributes
    ----------
    nodes : (n_node, 3) [length]
    node_ids : (n_node,)
    faces
        Surface name to node ids (n_facet, n_node_per_facet).
    node_sets
        Name to node ids.
    """

    nodes: Matrix
    node_ids: Indices
    faces: Mapping[str, Indices]
    node_sets: Mapping[str, Indices]


def is_deck(path: str | PathLike[str]) -> bool:
    """Whether a file is told to be a deck by its suffix."""
    return Path(path).suffix.lower() in (*ABAQUS, *NASTRAN)


def read_deck_geometry(path: str | PathLike[str]) -> DeckGeometry:
    """Read nodes, surfaces and node sets of an Abaqus, CalculiX or Nastran deck."""
    if Path(path).suffix.lower() in ABAQUS:
        from faying.io.abaqus.matrices import read_geometry

        mesh, faces = read_geometry(path)
    else:
        from faying.io.nastran import read_joint

        assembly = read_joint(path).assembly
        mesh, faces = assembly.mesh, assembly.face_sets
    return _by_id(mesh, faces)


def _by_id(mesh: Mesh, faces: Mapping[str, FaceSet]) -> DeckGeometry:
    return DeckGeometry(
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        faces={name: mesh.node_ids[face_set.nodes] for name, face_set in faces.items()},
        node_sets={name: mesh.node_ids[nodes] for name, nodes in mesh.node_sets.items()},
    )
