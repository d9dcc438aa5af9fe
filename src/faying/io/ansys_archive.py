"""Ansys ``.cdb`` archives: nodes, solids, components and materials, by ansys-mapdl-reader."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask
from faying.exceptions import refuse
from faying.io.ansys_commands import (
    BRICKS_8,
    BRICKS_20,
    CONTACTS,
    NO_STRUCTURE,
    TARGETS,
    TETRAHEDRA_10,
    ArchiveCommands,
    brick_note,
    is_reduced,
    left_out_note,
    read_commands,
)
from faying.io.isolated import read_isolated
from faying.io.straight_sides import StraightSides
from faying.model.assembly import Assembly, Material
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.generate import mid_side_ends
from faying.model.mesh import Mesh

_BONDED = frozenset((2, 3, 4, 5, 6))
"""Values of KEYOPT(12) for contact that does not open, or neither opens nor slides."""

_SCRIPT = """
import sys, warnings
warnings.simplefilter("ignore")
import numpy as np
try:
    from ansys.mapdl import reader
except ImportError:
    sys.exit(3)
archive = reader.Archive(sys.argv[1], parse_vtk=False)
parts = {
    "nodes": np.asarray(archive.nodes)[:, :3],
    "node_ids": archive.nnum,
    "kinds": np.asarray(archive.ekey).reshape(-1, 2),
    "lengths": np.array([len(one) for one in archive.elem]),
    "elements": np.concatenate(list(archive.elem) or [np.zeros(0, dtype=int)]),
}
parts |= {"node:" + name: ids for name, ids in archive.node_components.items()}
parts |= {"element:" + name: ids for name, ids in archive.element_components.items()}
np.savez(sys.argv[2], **parts)
"""

# Positions in an element: material, type, real constants, ..., element number, ..., then its nodes.
_MATERIAL, _TYPE, _REAL, _NUMBER, _FIRST_NODE = 0, 1, 2, 8, 10

# Nodes of a brick: corners, bottom, top, vertical edges; faying has vertical before top edges.
# Degenerate bricks repeat nodes: K = L and O = P make a wedge, M = N = O = P a pyramid, both a
# tetrahedron.
_ORDERS: Mapping[str, list[int]] = {
    "hex8": [*range(8)],
    "wedge6": [0, 1, 2, 4, 5, 6],
    "pyramid5": [*range(5)],
    "tet4": [0, 1, 2, 4],
    "hex20": [*range(12), *range(16, 20), *range(12, 16)],
    "wedge15": [0, 1, 2, 4, 5, 6, 8, 9, 11, 16, 17, 18, 12, 13, 15],
    "pyramid13": [*range(5), *range(8, 12), *range(16, 20)],
    "tet10": [0, 1, 2, 4, 8, 9, 11, 16, 17, 18],
}


def read_archive(path: Path, *, materials: Mapping[str, Material]) -> Assembly:
    """Read the solids of an Ansys archive (CDWRITE, blocked format).

    Node and element numbers are those of Ansys, property ids its material numbers. Components
    become node and element sets, and so do the nodes of contact and target elements of each set of
    real constants (``"contact 5"``, ``"target 5"``). Supports, loads, couplings and beams are not
    read; ``ignored`` counts omitted content with advice. Materials ``"material
    1"``, … or ``"default"`` override those of the archive.
    """
    parts = read_isolated(_SCRIPT, path, "Ansys archive", "ansys")
    rows, kinds = _elements(path, parts), dict(parts["kinds"].tolist())
    routine = np.array([kinds.get(kind, 0) for kind in rows[:, _TYPE].tolist()], dtype=np.int64)
    node_ids = parts["node_ids"].astype(np.int64)
    straight = StraightSides(places=parts["nodes"], ids=node_ids)
    commands = read_commands(path)
    blocks, left_out = _blocks(path, rows, routine, straight, commands.options)
    pairs = _contact_nodes(rows, routine)
    left_out += _contact_notes(rows, routine, pairs, commands)
    left_out += commands.notes()
    numbers = sorted({int(n) for block in blocks for n in np.unique(block.properties)})
    return Assembly(
        mesh=Mesh(
            nodes=np.vstack([parts["nodes"], straight.nodes]),
            node_ids=np.concatenate([node_ids, straight.node_ids]),
            blocks=blocks,
            node_sets={
                name: np.flatnonzero(np.isin(node_ids, ids))
                for name, ids in [*_components(parts, "node:"), *pairs.items()]
            },
            element_sets={
                **{
                    f"material {n}": np.concatenate([b.ids[b.properties == n] for b in blocks])
                    for n in numbers
                },
                **{
                    name: ids[np.isin(ids, np.concatenate([block.ids for block in blocks]))]
                    for name, ids in _components(parts, "element:")
                },
            },
        ),
        materials={n: _material(path, n, commands, materials) for n in numbers},
        equations=tuple(straight.equations()),
        name=path.stem,
        ignored=tuple(left_out),
    )


def _elements(path: Path, parts: Mapping[str, npt.NDArray[Any]]) -> Indices:
    """Return elements (n, 30), padded with zeros."""
    lengths = parts["lengths"].astype(np.int64)
    width = _FIRST_NODE + 20
    if lengths.max(initial=0) > width:
        refuse(f"Ansys archive '{path}': an element has {lengths.max()} numbers; write it again")
    table = np.zeros((len(lengths), width), dtype=np.int64)
    table[np.arange(table.shape[1]) < lengths[:, None]] = parts["elements"]
    return table


def _components(parts: Mapping[str, npt.NDArray[Any]], prefix: str) -> list[tuple[str, Indices]]:
    return [
        (key.removeprefix(prefix), np.asarray(ids, dtype=np.int64))
        for key, ids in parts.items()
        if key.startswith(prefix)
    ]


def _contact_nodes(rows: Indices, routine: Indices) -> dict[str, Indices]:
    """Return the nodes of both sides of contact pairs, by real constants."""
    sides = {}
    for name, routines in (("contact", CONTACTS), ("target", TARGETS)):
        chosen = np.isin(routine, list(routines))
        for number in np.unique(rows[chosen, _REAL]).tolist():
            nodes = np.unique(rows[chosen & (rows[:, _REAL] == number), _FIRST_NODE:])
            sides[f"{name} {number}"] = nodes[nodes > 0]
    return sides


def _contact_notes(
    rows: Indices, routine: Indices, pairs: Mapping[str, Indices], commands: ArchiveCommands
) -> list[str]:
    """Return notes on contact pairs: how to name them in a study, and their key options."""
    notes = []
    contact = np.isin(routine, list(CONTACTS))
    for number in np.unique(rows[contact, _REAL]).tolist():
        if f"target {number}" not in pairs:
            notes.append(f"contact elements of real constants {number}: no TARGE170 shares these")
            continue
        of_pair = contact & (rows[:, _REAL] == number)
        kind, material = (int(rows[of_pair, column][0]) for column in (_TYPE, _MATERIAL))
        behaviour = commands.options.get(kind, {}).get(12, 0)
        said = f'an [[interface]] with minus = "contact {number}", plus = "target {number}"'
        if friction := commands.constants.get(material, {}).get("MU", 0.0):
            said += f", friction = {friction:g}"
        if behaviour in _BONDED:
            said = f"bonded (KEYOPT(12) = {behaviour}): merge the nodes, or the bodies come apart"
        notes.append(f"contact pair {number}, {int(of_pair.sum())} contact elements: {said}")
    return notes


def _blocks(
    path: Path,
    rows: Indices,
    routine: Indices,
    straight: StraightSides,
    options: Mapping[int, Mapping[int, int]],
) -> tuple[tuple[CellBlock, ...], list[str]]:
    nodes = rows[:, _FIRST_NODE:]
    brick8, brick20, tetra = (
        np.isin(routine, list(family)) for family in (BRICKS_8, BRICKS_20, TETRAHEDRA_10)
    )
    # Elements of quadratic routines without mid-side nodes are linear.
    brick8 |= brick20 & (nodes[:, 8:] == 0).all(axis=1)
    brick20 &= ~brick8
    tetra4 = tetra & (nodes[:, 4:10] == 0).all(axis=1)
    apex = (nodes[:, 4:7] == nodes[:, 5:8]).all(axis=1)
    folded = nodes[:, 2] == nodes[:, 3]
    whole20 = brick20 & ~folded & ~apex
    kinds, first = np.unique(rows[:, _TYPE], return_index=True)
    of_type = dict(zip(kinds.tolist(), routine[first].tolist(), strict=True))
    eight_points = [n for n, number in of_type.items() if is_reduced(number, options.get(n, {}))]
    reduced = whole20 & np.isin(rows[:, _TYPE], eight_points)
    chosen: dict[str, Mask] = {
        "hex8": brick8 & ~folded & ~apex,
        "wedge6": brick8 & folded & ~apex,
        "pyramid5": brick8 & ~folded & apex,
        "tet4": brick8 & folded & apex,
        "hex20": whole20 & ~reduced,
        "wedge15": brick20 & folded & ~apex,
        "pyramid13": brick20 & ~folded & apex,
        "tet10": brick20 & folded & apex,
    }
    tables = [(kind, "", which, nodes[:, _ORDERS[kind]]) for kind, which in chosen.items()]
    tables.append(("hex20", "reduced", reduced, nodes[:, _ORDERS["hex20"]]))
    tables.append(("tet4", "", tetra4, nodes[:, :4]))
    tables.append(("tet10", "", tetra & ~tetra4, nodes[:, :10]))
    blocks = tuple(
        CellBlock(
            kind=kind,
            formulation=rule,
            nodes=_indices(path, kind, table[which], rows[which, _NUMBER], straight),
            ids=rows[which, _NUMBER],
            properties=rows[which, _MATERIAL],
        )
        for kind, rule, which, table in tables
        if which.any()
    )
    if not blocks:
        refuse(
            f"Ansys archive '{path}' has no solids (SOLID185, 186, 187, 45, 95, 92); write it with "
            "CDWRITE in blocked format"
        )
    unsupported = routine[~(brick8 | brick20 | tetra) & ~np.isin(routine, list(NO_STRUCTURE))]
    routines, counts = np.unique(unsupported, return_counts=True)
    removed = len(straight.ends)
    left_out = [f"{removed} removed mid-side nodes: straight sides"] if removed else []
    types = np.unique(rows[brick8][:, _TYPE]).tolist()
    notes = dict.fromkeys(brick_note(of_type[kind], options.get(kind, {})) for kind in types)
    left_out += [note for note in notes if note]
    left_out += [
        left_out_note(kind, count)
        for kind, count in zip(routines.tolist(), counts.tolist(), strict=True)
        if kind not in CONTACTS | TARGETS
    ]
    return blocks, left_out


def _indices(
    path: Path, kind: str, node_ids: Indices, elements: Indices, straight: StraightSides
) -> Indices:
    """Return node indices (n, n_node), with new ones for removed mid-side nodes."""
    order = np.argsort(straight.ids, kind="stable")
    positions = np.searchsorted(straight.ids, node_ids, sorter=order)
    indices: Indices = order[np.minimum(positions, len(order) - 1)]
    corners = SOLIDS[kind].n_corners
    removed = node_ids == 0
    removed[:, :corners] = False
    wrong = ((straight.ids[indices] != node_ids) & ~removed).any(axis=1)
    if wrong.any():
        element = int(elements[np.flatnonzero(wrong)[0]])
        refuse(f"Ansys archive '{path}': element {element} has an unknown node; write all nodes")
    for column, (start, end) in enumerate(mid_side_ends(kind), start=corners):
        rows = removed[:, column]
        indices[rows, column] = straight.between(
            indices[rows, start], indices[rows, end], turns=False
        )
    return indices


def _material(
    path: Path, number: int, commands: ArchiveCommands, materials: Mapping[str, Material]
) -> Material:
    name = f"material {number}"
    material = materials.get(name, materials.get("default"))
    if material is not None:
        return material
    of_material = commands.constants.get(number, {})
    doubts = sorted(commands.tables.get(number, frozenset()) & {"EX", "PRXY", "NUXY", "DENS"})
    if doubts:
        refuse(
            f"Ansys archive '{path}': {', '.join(doubts)} of {name} depends on temperature; add "
            f'[material."{name}"] with E, nu and rho at that of the joint'
        )
    if sides := [
        key
        for key in ("EY", "EZ")
        if of_material.get(key, of_material.get("EX")) != of_material.get("EX")
    ]:
        refuse(
            f"Ansys archive '{path}': {' and '.join(sides)} of {name} not as EX; materials of "
            f'archives are isotropic: add [material."{name}"] with E, nu and rho, or use .full '
            "matrices"
        )
    constants = (
        of_material.get("EX"),
        of_material.get("PRXY", of_material.get("NUXY")),
        of_material.get("DENS"),
    )
    if None in constants:
        refuse(
            f"Ansys archive '{path}': {name} has no EX, PRXY (or NUXY) and DENS; add "
            f'[material."{name}"] with E, nu and rho'
        )
    modulus, ratio, density = (float(constant or 0.0) for constant in constants)
    return Material(name=name, youngs_modulus=modulus, poissons_ratio=ratio, density=density)
