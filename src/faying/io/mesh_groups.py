"""Groups of a mesh file's cells from names and numbers of meshio."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying._typing import Indices
from faying.model.elements import FACES

FACE_NODES = {face.meshio: face.n_nodes for face in FACES.values()}
"""Number of nodes of each kind of face, by meshio's name."""

_TAGS = ("gmsh:physical", "medit:ref", "cell_tags", "CellEntityIds", "property", "material")
"""Cell data with the numbers of the groups; the first one found counts."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Group:
    """Cells of one group: name, number, and cell indices (n_cell,) in each block of meshio."""

    name: str
    number: int
    cells: tuple[Indices, ...]


def groups_of(mesh: Any) -> list[Group]:
    """Return named groups of cells; the name of an unnamed group is its number."""
    named = {
        name: [np.empty(0) if cells is None else cells for cells in blocks]
        for name, blocks in mesh.cell_sets.items()
        if not name.startswith("gmsh:")
    }
    return [
        Group(
            name=name,
            number=number,
            cells=tuple(np.asarray(cells, dtype=np.int64) for cells in blocks),
        )
        for number, (name, blocks) in enumerate((named or _tagged(mesh)).items(), start=1)
    ]


def _tagged(mesh: Any) -> dict[str, list[Any]]:
    """Return groups by number and dimension, from cell data."""
    key = next((key for key in _TAGS if key in mesh.cell_data), None)
    if key is None:
        return {}
    names = {
        (int(label[0]), int(label[1])): name
        for name, label in mesh.field_data.items()
        if np.shape(label) == (2,)
    }
    tags = [np.asarray(values) for values in mesh.cell_data[key]]
    kinds = [dimension(block.type) for block in mesh.cells]
    present = sorted(
        {
            (size, int(tag))
            for size, values in zip(kinds, tags, strict=True)
            for tag in np.unique(values)
            if tag != 0
        }
    )
    return {
        names.get((tag, size), f"{['point', 'line', 'surface', 'volume'][size]} {tag}"): [
            np.flatnonzero((values == tag) & (kind == size))
            for kind, values in zip(kinds, tags, strict=True)
        ]
        for size, tag in present
    }


def dimension(kind: str) -> int:
    """Return the dimension of a kind of cells; 3 for unknown kinds."""
    if kind.startswith(("triangle", "quad")):
        return 2
    if kind.startswith("line"):
        return 1
    return 0 if kind == "vertex" else 3


def volume_groups(mesh: Any, groups: list[Group]) -> list[Group]:
    """Return the groups of solids; without one, a group of all solids."""
    solid = [dimension(block.type) == 3 for block in mesh.cells]
    holding = [
        group
        for group in groups
        if any(is_solid and len(cells) for is_solid, cells in zip(solid, group.cells, strict=True))
    ]
    everything = tuple(
        np.arange(len(block.data) if is_solid else 0)
        for is_solid, block in zip(solid, mesh.cells, strict=True)
    )
    return holding or [Group(name="solids", number=len(groups) + 1, cells=everything)]


def cells_of(mesh: Any, group: Group) -> Iterator[tuple[Any, Indices]]:
    """Yield blocks of meshio and the cell indices of a group in each."""
    for block, cells in zip(mesh.cells, group.cells, strict=True):
        if len(cells):
            yield block, cells
