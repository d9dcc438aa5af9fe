"""Meshes of gmsh and other meshers, read by meshio: solids and named groups.

A ``.med`` of Salome may hold several meshes, for example of parts meshed separately. meshio reads
one of them, and numbers of families instead of their groups.
"""

import contextlib
import io
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import FormatError, refuse
from faying.files.contents import reason_of
from faying.io.aster_mail import read_mail
from faying.io.mesh_groups import FACE_NODES, Group, cells_of, dimension, groups_of, volume_groups
from faying.model.assembly import Assembly, Material
from faying.model.bodies import separated
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.elements.orientation import right_side_out
from faying.model.mesh import Mesh
from faying.model.surface import padded

ANY_GROUP = "default"
"""Name of the material for groups without their own."""

OTHER_SOURCES = {
    ".bdf": "nastran",
    ".dat": "nastran",
    ".fem": "nastran",
    ".nas": "nastran",
    ".inp": "abaqus",
}
"""Suffixes of decks, of which meshio drops couplings, beams and supports."""

SOLID_KINDS = {element.elsewhere.meshio: element for element in SOLIDS.values()}
"""Solid element kinds of faying by meshio's names."""

_REMEDIES = {
    "hexahedron27": "in gmsh set Mesh.SecondOrderIncomplete = 1 for 20-node bricks",
    "wedge18": "in gmsh set Mesh.SecondOrderIncomplete = 1 for 15-node wedges",
    "pyramid14": "mesh with tetrahedra, wedges or bricks",
}


def read_mesh_file(
    path: str | PathLike[str], *, materials: Mapping[str, Material], separate: tuple[str, ...] = ()
) -> Assembly:
    """Read solids and named groups from a mesh file: ``.msh``, ``.vtu``, ``.med`` and others.

    All formats of meshio but decks. Volume groups (gmsh: physical groups) become element sets
    with a material each: its own or ``"default"``; materials of other names serve bolts. Surface
    groups become face and node sets, line and point groups node sets. Without volume groups all
    solids form the group ``"solids"``. A mesh has no supports, bolts or loads.

    Volume groups to separate, such as parts of a fragmented geometry that share nodes where they
    touch, get their own nodes, see :func:`faying.model.bodies.separated`. Ids of nodes, elements
    and properties count from 1 in the order of the file.

    Raises
    ------
    FormatError
        If the file is missing, damaged, a deck, without solids or with unsupported solids, or
        a group has no material.
    ModelError
        If a group to separate does not exist.
    """
    path = Path(path)
    if path.suffix.lower() == ".cdb":
        from faying.io.ansys_archive import read_archive

        archive = read_archive(path, materials=materials)
        return replace(archive, mesh=separated(archive.mesh, separate))
    mesh_read = _read(path)
    points = _points(path, mesh_read)
    groups = groups_of(mesh_read)
    volumes = volume_groups(mesh_read, groups)
    blocks, turned = _blocks(path, mesh_read, points, volumes)
    element_sets, node_sets = _sets(mesh_read, groups, volumes, blocks)
    used = sorted({int(number) for block in blocks for number in np.unique(block.properties)})
    names = {group.number: group.name for group in volumes}
    whole = Mesh(
        nodes=points,
        node_ids=np.arange(1, len(points) + 1),
        blocks=blocks,
        node_sets=node_sets,
        element_sets=element_sets,
    )
    mesh, face_sets, notes = _with_faces(mesh_read, groups, whole, separated(whole, separate))
    chosen = {number: _material(path, names[number], materials) for number in used}
    others = [name for name in materials if name not in {*names.values(), ANY_GROUP}]
    chosen |= {n: materials[name] for n, name in enumerate(others, max([*names, *used]) + 1)}
    return Assembly(
        mesh=mesh,
        materials=chosen,
        face_sets=face_sets,
        name=path.stem,
        ignored=(*turned, *notes),
    )


def _read(path: Path) -> Any:
    """Return a mesh in meshio's form; meshio prints and exits where a reader should raise."""
    if not path.is_file():
        refuse(f"mesh file '{path}' does not exist; check the path")
    source = OTHER_SOURCES.get(path.suffix.lower())
    if source is not None:
        refuse(
            f"'{path}' is a deck: a mesh reader would drop its couplings, supports and sets; "
            f'use source = "{source}"'
        )
    if path.suffix.lower() == ".mail":
        return read_mail(path)
    _check_whole(path)
    meshio = meshio_of_all_solids()
    said = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(said),
            np.errstate(all="ignore"),
        ):
            return read_med(path) if path.suffix.lower() == ".med" else meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio's readers raise any error for a damaged file
        reason = " ".join(said.getvalue().split())[:200] or reason_of(error)
        message = (
            f"mesh file '{path}' cannot be read ({reason}); write it again, as .msh (4.1 or 2.2), "
            ".vtu or .med"
        )
        raise FormatError(message) from None


def meshio_of_all_solids() -> Any:
    """Return meshio, with two kinds that meshio 5.3.5 reads but does not list as solids."""
    import meshio
    from meshio._mesh import topological_dimension

    for kind in ("wedge15", "pyramid13"):
        topological_dimension.setdefault(kind, 3)
    return meshio


def _check_whole(path: Path) -> None:
    """Refuse an incomplete gmsh file; meshio would return the part that exists."""
    if path.suffix.lower() != ".msh":
        return
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - 100, 0))
        last = file.read().split()
    if not last or not last[-1].startswith(b"$End"):
        refuse(
            f"mesh file '{path}' cannot be read: it does not end with a section's $End, so it is "
            "incomplete; write it again"
        )


def _points(path: Path, mesh: Any) -> Matrix:
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        refuse(
            f"mesh file '{path}': points of shape {points.shape}, or not all finite; expected "
            "x, y, z of every node"
        )
    return points


def _blocks(
    path: Path, mesh: Any, points: Matrix, groups: list[Group]
) -> tuple[tuple[CellBlock, ...], list[str]]:
    """Return blocks of solids, and notes of changes."""
    blocks, first, turned = [], 1, 0
    for number, block in enumerate(mesh.cells):
        if dimension(block.type) != 3:
            continue
        if block.type not in SOLID_KINDS:
            remedy = _REMEDIES.get(block.type, f"mesh with {', '.join(SOLID_KINDS)}")
            refuse(f"mesh file '{path}' has solids of kind '{block.type}'; {remedy}")
        element = SOLID_KINDS[block.type]
        connectivity = element.elsewhere.ours(_connectivity(path, block, len(points)))
        nodes, inside_out = right_side_out(element.kind, connectivity, points)
        turned += int(inside_out.sum())
        blocks.append(
            CellBlock(
                kind=element.kind,
                nodes=nodes,
                ids=np.arange(first, first + len(nodes)),
                properties=_properties(path, groups, number, len(nodes)),
            )
        )
        first += len(nodes)
    if not blocks:
        refuse(
            f"mesh file '{path}' has no solids; in gmsh mesh in three dimensions and put volumes "
            "into physical groups"
        )
    notes = [f"node order of {turned} inverted solids"] if turned else []
    return tuple(blocks), notes


def _connectivity(path: Path, block: Any, n_points: int) -> Indices:
    """Return the checked nodes of the cells of a block of solids."""
    nodes = np.asarray(block.data, dtype=np.int64)
    expected = SOLID_KINDS[block.type].n_nodes
    if nodes.ndim != 2 or nodes.shape[1] != expected:
        refuse(
            f"mesh file '{path}': a block of {block.type} of shape {nodes.shape}, expected "
            f"{expected} nodes a cell; the file is incomplete or damaged, write it again"
        )
    if nodes.size and (nodes.min() < 0 or nodes.max() >= n_points):
        refuse(f"mesh file '{path}': a {block.type} names a node that does not exist")
    return nodes


def _properties(path: Path, groups: list[Group], block: int, n_cells: int) -> Indices:
    """Return the group (n_cells,) of each solid of a block; a later group overrides."""
    properties = np.zeros(n_cells, dtype=np.int64)
    for group in groups:
        properties[group.cells[block]] = group.number
    lost = np.count_nonzero(properties == 0)
    if lost:
        refuse(
            f"mesh file '{path}': {lost} solids belong to no group, so they have no material; put "
            "every volume into a physical group, or none"
        )
    return properties


def _sets(
    mesh: Any, groups: list[Group], volumes: list[Group], blocks: tuple[CellBlock, ...]
) -> tuple[dict[str, Indices], dict[str, Indices]]:
    """Return element sets of volume groups and node sets of all groups."""
    solids = iter(blocks)
    ids = [next(solids).ids if dimension(block.type) == 3 else None for block in mesh.cells]
    element_sets: dict[str, Indices] = {}
    node_sets: dict[str, Indices] = {}
    for group in volumes:
        parts = zip(ids, group.cells, strict=True)
        element_sets[group.name] = np.concatenate([n[k] for n, k in parts if n is not None])
    for group in groups:
        if group.name not in element_sets:
            nodes = [np.ravel(block.data[cells]) for block, cells in cells_of(mesh, group)]
            node_sets[group.name] = np.unique(np.concatenate([*nodes, np.empty(0, np.int64)]))
    for name, members in mesh.point_sets.items():
        node_sets.setdefault(name, np.unique(np.asarray(members, dtype=np.int64)))
    return element_sets, node_sets


def _with_faces(
    mesh_read: Any, groups: list[Group], whole: Mesh, mesh: Mesh
) -> tuple[Mesh, dict[str, Indices], list[str]]:
    """Turn surface groups into outward facets of the solids.

    A mesher's orientation follows the geometry, not the body. Groups of faces between solids
    remain node sets. Where bodies were separated, a group has the nodes of
    the bodies whose faces it names, also of both where they touch.
    """
    origin = np.arange(len(mesh.nodes) + 1)
    origin[-1] = -1
    for separate_block, block in zip(mesh.blocks, whole.blocks, strict=True):
        origin[separate_block.nodes] = block.nodes
    copied = (origin[mesh.exterior.nodes] != mesh.exterior.nodes).any(axis=1)
    exterior = mesh.exterior.taken(np.argsort(copied, kind="stable"))
    as_read = replace(exterior, nodes=origin[exterior.nodes])
    face_sets: dict[str, Indices] = {}
    node_sets, notes = dict(mesh.node_sets), list[str]()
    for group in groups:
        tables = [
            padded(np.asarray(block.data[cells], dtype=np.int64))
            for block, cells in cells_of(mesh_read, group)
            if np.shape(block.data)[1:] == (FACE_NODES.get(block.type),)
        ]
        if not tables:
            continue
        owner = np.unique(as_read.positions(np.concatenate(tables)))
        if owner.min(initial=0) >= 0:
            face_sets[group.name] = exterior.nodes[owner]
            sides = exterior.nodes[as_read.taken(owner).positions(as_read.nodes) >= 0]
            members = node_sets[group.name]
            elsewhere = np.isin(origin[members], origin[sides]) & ~np.isin(members, sides)
            node_sets[group.name] = members[~elsewhere]
        else:
            notes.append(
                f"surface group '{group.name}' is not made of outer faces: taken as a set of nodes"
            )
    return replace(mesh, node_sets=node_sets), face_sets, notes


def _material(path: Path, group: str, materials: Mapping[str, Material]) -> Material:
    material = materials.get(group, materials.get(ANY_GROUP))
    if material is None:
        refuse(
            f"mesh file '{path}': group '{group}' has no material; add [material.{group}] or "
            f"[material.{ANY_GROUP}] with E, nu and rho"
        )
    return material


_SOLID = ("tetra", "hexahedron", "wedge", "pyramid")


def read_med(path: Path) -> Any:
    """Return the meshes of a file as one mesh of meshio, groups as its cell sets.

    In a file with groups, solids without a group form a group named after their mesh. A group name
    that occurs in two meshes gets the name of the mesh as prefix: ``part/name``.
    """
    import h5py
    import meshio

    parts = {}
    with h5py.File(path, "r") as file:
        for name in file["ENS_MAA"]:
            alone = BytesIO()
            with h5py.File(alone, "w") as copy:
                for folder in ("ENS_MAA", "FAS"):
                    if name in file.get(folder, ()):
                        file.copy(f"{folder}/{name}", copy.require_group(folder), name=name)
            parts[name] = meshio.med._med.read(alone)
    if len(parts) == 1 and not any(map(_named, parts.values())):
        return next(iter(parts.values()))
    points: list[Any] = []
    cells: list[Any] = []
    sets: dict[str, dict[int, Any]] = {}
    count = Counter(name for part in parts.values() for name in _named(part))
    n_point = 0
    for part_name, part in parts.items():
        grouped = _named(part)
        for k, block in enumerate(part.cells):
            position = len(cells)
            cells.append(meshio.CellBlock(block.type, block.data + n_point))
            tags = part.cell_data.get("cell_tags", [np.zeros(len(c.data)) for c in part.cells])[k]
            free = np.ones(len(block.data), dtype=bool)
            for name, families in grouped.items():
                inside = np.isin(tags, families)
                free &= ~inside
                if inside.any():
                    whole = name if count[name] == 1 else f"{part_name}/{name}"
                    sets.setdefault(whole, {})[position] = np.flatnonzero(inside)
            if free.any() and block.type.startswith(_SOLID):
                sets.setdefault(part_name, {})[position] = np.flatnonzero(free)
        points.append(part.points)
        n_point += len(part.points)
    return meshio.Mesh(
        np.vstack(points),
        cells,
        cell_sets={
            name: [members.get(k, np.zeros(0, dtype=np.int64)) for k in range(len(cells))]
            for name, members in sets.items()
        },
    )


def _named(part: Any) -> dict[str, list[int]]:
    """Return the families of each group of cells."""
    groups: dict[str, list[int]] = {}
    for family, names in part.cell_tags.items():
        for name in names:
            groups.setdefault(name.strip("\0 "), []).append(int(family))
    return groups
