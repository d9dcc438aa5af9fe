"""Decks and meshes as a first study reads them: units, materials, named sets, nodes to hold."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faying._typing import Indices, Mask
from faying.exceptions import FormatError, refuse_study
from faying.interface.selection import select_facets
from faying.io.mesh_files import ANY_GROUP, read_mesh_file
from faying.model.assembly import Assembly, Material
from faying.model.bodies import separated
from faying.model.description import JointDescription, check_surfaces
from faying.model.mesh import Mesh
from faying.sources import SOURCES, SourceKeys
from faying.study.judgement.model_warnings import doubts
from faying.study.keys.deck_study import STUDY, check_not_ansys

UNITS = ("mm-t-s", "m-kg-s", "mm-kg-s", "mm-kg-ms", "in-slinch-s")
"""Unit systems in the order in which they are tried."""

METRES = 2.0
"""Extent of a mesh below which its unit of length is taken for the metre."""

STEELS = {
    "mm-t-s": Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9, name=ANY_GROUP),
    "m-kg-s": Material(youngs_modulus=210e9, poissons_ratio=0.3, density=7850.0, name=ANY_GROUP),
}
"""Steel for meshes without materials, by unit system."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelFile:
    """A deck or mesh that has been read.

    Attributes
    ----------
    source
        Name of the source in studies.
    units
        The first of :data:`UNITS` in which the materials are plausible, or which suits the
        size; the first of all where none fits.
    suits
        Whether any unit system fits.
    separate
        Volume groups of a mesh that share nodes with others, taken as parts that touch.
    stand_in
        Material of a mesh that has none.
    """

    path: Path
    source: str
    described: JointDescription
    units: str
    suits: bool = True
    ignore: tuple[str, ...] = ()
    separate: tuple[str, ...] = ()
    stand_in: Material | None = None

    @property
    def mesh(self) -> Mesh:
        """The nodes and solids."""
        return self.described.assembly.mesh


def read_model_file(path: Path, ignore: Sequence[str] = ()) -> ModelFile:
    """Read a deck or a mesh.

    Raises
    ------
    StudyError
        If the file is a study already, or is a mesh and ``ignore`` names something.
    FormatError, ModelError
        If it cannot be read.
    """
    check_not_ansys(path)
    if path.suffix.lower() == STUDY:
        refuse_study(f"{path} is a study already; give its deck or mesh instead")
    for source in SOURCES.values():
        if path.suffix.lower() in source.suffixes:
            keys = SourceKeys(file=path, ignore=tuple(ignore))
            described = source.read(keys)
            check_surfaces(described, path)
            materials = described.assembly.materials
            units = _unit_set(materials)
            return ModelFile(
                path=path,
                source=source.name,
                described=described,
                units=units or UNITS[0],
                suits=units is not None,
                ignore=tuple(ignore),
            )
    if ignore:
        refuse_study(f"--ignore applies to decks, and {path} is a mesh; leave --ignore out")
    return _mesh(path)


def _unit_set(materials: Mapping[int, Material]) -> str | None:
    """Return the first of :data:`UNITS` in which all materials are plausible, if any."""
    return next((units for units in UNITS if not [*doubts(materials, units)]), None)


def _mesh(path: Path) -> ModelFile:
    """Read a mesh with its materials, or with steel where it has none."""
    stand_in: Material | None = None
    try:
        assembly = read_mesh_file(path, materials={})
        units = _unit_set(assembly.materials)
    except FormatError:
        # Any other fault of the file is reported by the second reading.
        assembly = read_mesh_file(path, materials={ANY_GROUP: STEELS["mm-t-s"]})
        units = "m-kg-s" if float(np.ptp(assembly.mesh.nodes, axis=0).max()) < METRES else UNITS[0]
        stand_in = STEELS[units]
        materials = dict.fromkeys(assembly.materials, stand_in)
        assembly = replace(assembly, materials=materials)
    apart = _sharing(assembly.mesh)
    assembly = replace(assembly, mesh=separated(assembly.mesh, apart))
    return ModelFile(
        path=path,
        source="mesh",
        described=JointDescription(assembly=assembly),
        units=units or UNITS[0],
        suits=units is not None,
        separate=apart,
        stand_in=stand_in,
    )


def _sharing(mesh: Mesh) -> tuple[str, ...]:
    """Return all volume groups but the first where all solids are connected by nodes."""
    if len(np.unique(mesh.bodies[mesh.bodies >= 0])) != 1:
        return ()
    covered = np.empty(0, dtype=np.int64)
    names = []
    for name, elements in mesh.element_sets.items():
        if len(elements) and not np.isin(elements, covered).any():
            covered = np.concatenate([covered, elements])
            names.append(name)
    return tuple(names[1:])


HELD = re.compile(r"fix|clamp|held|hold|support|ground|encast|spc", re.IGNORECASE)
LOADED = re.compile(r"load|tip|force|pull|push|press|traction", re.IGNORECASE)
"""Usual names of held sets, and of loaded sets."""


@dataclass(frozen=True, kw_only=True)
class Pin:
    """One of three nodes that hold a body statically determinate."""

    node: int
    components: tuple[str, ...]


def named(mesh: Mesh, pattern: re.Pattern[str]) -> list[str]:
    """Return the node sets whose names match, empty ones left out."""
    return [name for name, nodes in mesh.node_sets.items() if pattern.search(name) and len(nodes)]


def pins(assembly: Assembly, contact: Indices) -> list[Pin]:
    """Return three nodes away from contact that hold the largest body statically determinate."""
    mesh = assembly.mesh
    usable = _outside(assembly, contact)
    label = mesh.bodies
    solid = label[label >= 0]
    largest = np.bincount(solid).argmax() if len(solid) else -1  # nodes of shells are in no body
    rows = np.flatnonzero(usable & (label == largest))
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
    """Return the id of the free surface node that is farthest from the held nodes."""
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
    """Return which nodes are surface corners without contact, coupling or equation."""
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
    """Return the face sets that are not used and not wholly in contact."""
    inside = np.zeros(len(assembly.mesh.nodes) + 1, dtype=bool)
    inside[contact] = True
    groups = []
    for name in assembly.face_sets:
        nodes = np.unique(select_facets(assembly, name).corners)
        if name not in used and not inside[nodes].all():
            groups.append(name)
    return groups
