"""Nodes, facets and node sets that a deck gives to matrices which come from elsewhere."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path

from faying.model.assembly import FaceSet
from faying.model.mesh import Mesh

ABAQUS = (".inp",)
NASTRAN = (".bdf", ".nas", ".fem")


def is_deck(path: str | PathLike[str]) -> bool:
    """Whether a file is told to be a deck by its suffix."""
    return Path(path).suffix.lower() in (*ABAQUS, *NASTRAN)


def read_geometry(path: str | PathLike[str]) -> tuple[Mesh, Mapping[str, FaceSet]]:
    """Read nodes, node sets and surfaces of an Abaqus, CalculiX or Nastran deck."""
    if Path(path).suffix.lower() in ABAQUS:
        from faying.io.abaqus.matrices import read_geometry

        return read_geometry(path)
    from faying.io.nastran import read_joint

    assembly = read_joint(path).assembly
    return assembly.mesh, assembly.face_sets
