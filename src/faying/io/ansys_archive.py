"""Ansys ``.cdb`` archives: nodes, solids, components and materials, by ansys-mapdl-reader."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Mask
from faying.exceptions import FormatError
from faying.io.isolated import read_isolated
from faying.io.straight_sides import StraightSides
from faying.model.assembly import Assembly, Material
from faying.model.elements import SOLIDS
from faying.model.generate import mid_side_ends
from faying.model.mesh import CellBlock, Mesh

BRICKS_8 = frozenset((45, 185))
BRICKS_20 = frozenset((95, 186))
TETRAHEDRA_10 = frozenset((92, 187))
NO_STRUCTURE = frozenset((200,))
"""Element routines: SOLID45/185, SOLID95/186, SOLID92/187; MESH200 only carries a mesh."""

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

# Positions in an element: material, type, ..., element number, ..., then its nodes.
_MATERIAL, _TYPE, _NUMBER, _FIRST_NODE = 0, 1, 8, 10

# A brick's nodes: corners, bottom edges, top edges, upright edges; ours have upright before top.
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

_PROPERTY = re.compile(
    r"^MPDATA\s*,\s*R[\d.]+\s*,\s*(\d+)\s*,\s*(\w+)\s*,\s*(\d+)\s*,\s*(\d+)\s*,\s*([^,\s]+)"
)


def read_archive(path: Path, *, materials: Mapping[str, Material]) -> Assembly:
    """Read the solids of an Ansys archive (CDWRITE, blocked format).

    Node and element numbers are those of Ansys, property ids its material numbers. Components
    become node and element sets. Supports, loads, couplings, beams and contact elements are not
    read; ``ignored`` counts the elements left out.

    Parameters
    ----------
    materials
        ``"material 1"``, … or ``"default"``; they override those of the archive.

    Raises
    ------
    FormatError
        If the file is damaged, has no solids, or a material has no constants.
    """
    parts = read_isolated(_SCRIPT, path, "Ansys archive", "ansys")
    rows, kinds = _elements(parts), dict(parts["kinds"].tolist())
    routine = np.array([kinds.get(kind, 0) for kind in rows[:, _TYPE].tolist()], dtype=np.int64)
    node_ids = parts["node_ids"].astype(np.int64)
    straight = StraightSides(places=parts["nodes"], ids=node_ids)
    blocks, left_out = _blocks(path, rows, routine, straight)
    numbers = sorted({int(n) for block in blocks for n in np.unique(block.properties)})
    own = _material_constants(path)
    return Assembly(
        mesh=Mesh(
            nodes=np.vstack([parts["nodes"], straight.nodes]),
            node_ids=np.concatenate([node_ids, straight.node_ids]),
            blocks=blocks,
            node_sets={
                name: np.flatnonzero(np.isin(node_ids, ids))
                for name, ids in _components(parts, "node:")
            },
            element_sets={
                **{f"material {n}": _of_material(blocks, n) for n in numbers},
                **{
                    name: ids[np.isin(ids, np.concatenate([block.ids for block in blocks]))]
                    for name, ids in _components(parts, "element:")
                },
            },
        ),
        materials={n: _material(path, n, own.get(n, {}), materials) for n in numbers},
        equations=tuple(straight.equations()),
        name=path.stem,
        ignored=tuple(left_out),
    )


def _elements(parts: Mapping[str, npt.NDArray[Any]]) -> Indices:
    """Elements (n, 30), filled up with zeros."""
    lengths = parts["lengths"].astype(np.int64)
    width = _FIRST_NODE + 20
    table = np.zeros((len(lengths), max(width, int(lengths.max(initial=0)))), dtype=np.int64)
    table[np.arange(table.shape[1]) < lengths[:, None]] = parts["elements"]
    return table


def _components(parts: Mapping[str, npt.NDArray[Any]], prefix: str) -> list[tuple[str, Indices]]:
    return [
        (key.removeprefix(prefix), np.asarray(ids, dtype=np.int64))
        for key, ids in parts.items()
        if key.startswith(prefix)
    ]


def _blocks(
    path: Path, rows: Indices, routine: Indices, straight: StraightSides
) -> tuple[tuple[CellBlock, ...], list[str]]:
    nodes = rows[:, _FIRST_NODE:]
    brick8, brick20, tetra = (
        np.isin(routine, list(one)) for one in (BRICKS_8, BRICKS_20, TETRAHEDRA_10)
    )
    # Elements of quadratic routines may come without any mid-side node; they are linear then.
    brick8 |= brick20 & (nodes[:, 8:] == 0).all(axis=1)
    brick20 &= ~brick8
    tetra4 = tetra & (nodes[:, 4:10] == 0).all(axis=1)
    apex = (nodes[:, 4:7] == nodes[:, 5:8]).all(axis=1)
    folded = nodes[:, 2] == nodes[:, 3]
    chosen: dict[str, Mask] = {
        "hex8": brick8 & ~folded & ~apex,
        "wedge6": brick8 & folded & ~apex,
        "pyramid5": brick8 & ~folded & apex,
        "tet4": brick8 & folded & apex,
        "hex20": brick20 & ~folded & ~apex,
        "wedge15": brick20 & folded & ~apex,
        "pyramid13": brick20 & ~folded & apex,
        "tet10": brick20 & folded & apex,
    }
    tables = [(kind, which, nodes[:, _ORDERS[kind]]) for kind, which in chosen.items()]
    tables.append(("tet4", tetra4, nodes[:, :4]))
    tables.append(("tet10", tetra & ~tetra4, nodes[:, :10]))
    blocks = tuple(
        CellBlock(
            kind=kind,
            nodes=_indices(path, kind, table[which], rows[which, _NUMBER], straight),
            ids=rows[which, _NUMBER],
            properties=rows[which, _MATERIAL],
        )
        for kind, which, table in tables
        if which.any()
    )
    if not blocks:
        message = (
            f"Ansys archive '{path}' has no solids (SOLID185, 186, 187, 45, 95, 92); write it with "
            "CDWRITE in blocked format"
        )
        raise FormatError(message)
    other = routine[~(brick8 | brick20 | tetra) & ~np.isin(routine, list(NO_STRUCTURE))]
    found, counts = np.unique(other, return_counts=True)
    removed = len(straight.ends)
    left_out = [f"{removed} removed mid-side nodes: straight sides"] if removed else []
    left_out += [
        f"{count} elements of routine {kind}; model them in the study, or use .full matrices"
        for kind, count in zip(found.tolist(), counts.tolist(), strict=True)
    ]
    return blocks, left_out


def _indices(
    path: Path, kind: str, wanted: Indices, elements: Indices, straight: StraightSides
) -> Indices:
    """Node indices (n, n_node); new ones where a mid-side node was removed."""
    order = np.argsort(straight.ids, kind="stable")
    place = np.searchsorted(straight.ids, wanted, sorter=order)
    found: Indices = order[np.minimum(place, len(order) - 1)]
    corners = SOLIDS[kind].n_corners
    removed = wanted == 0
    removed[:, :corners] = False
    wrong = ((straight.ids[found] != wanted) & ~removed).any(axis=1)
    if wrong.any():
        element = int(elements[np.flatnonzero(wrong)[0]])
        message = (
            f"Ansys archive '{path}': element {element} names a node that is not there; write all "
            "nodes"
        )
        raise FormatError(message)
    for column, (start, end) in enumerate(mid_side_ends(kind), start=corners):
        here = removed[:, column]
        found[here, column] = straight.between(found[here, start], found[here, end], turns=False)
    return found


def _of_material(blocks: tuple[CellBlock, ...], number: int) -> Indices:
    return np.concatenate([block.ids[block.properties == number] for block in blocks])


def _material_constants(path: Path) -> dict[int, dict[str, float]]:
    """Material number to constants, those given at one temperature."""
    found: dict[int, dict[str, float]] = {}
    with path.open(encoding="latin-1") as file:
        for line in file:
            match = _PROPERTY.match(line)
            if match is None:
                continue
            try:
                value = float(match[5])
            except ValueError:
                continue
            if match[1] == "1" and match[4] == "1":
                found.setdefault(int(match[3]), {})[match[2].upper()] = value
    return found


def _material(
    path: Path, number: int, own: Mapping[str, float], materials: Mapping[str, Material]
) -> Material:
    name = f"material {number}"
    given = materials.get(name, materials.get("default"))
    if given is not None:
        return given
    constants = (own.get("EX"), own.get("PRXY", own.get("NUXY")), own.get("DENS"))
    if None in constants:
        message = (
            f"Ansys archive '{path}': {name} has no EX, PRXY (or NUXY) and DENS; add "
            f'[material."{name}"] with E, nu and rho'
        )
        raise FormatError(message)
    modulus, ratio, density = (float(one or 0.0) for one in constants)
    return Material(name=name, youngs_modulus=modulus, poissons_ratio=ratio, density=density)
