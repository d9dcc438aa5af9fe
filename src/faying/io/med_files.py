"""Salome's ``.med``: its meshes joined to one, with the names of their groups.

A file may hold several meshes, as of parts that were meshed each on its own; meshio reads one, and
numbers of families in place of the groups they belong to.
"""

from collections import Counter
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

_SOLID = ("tetra", "hexahedron", "wedge", "pyramid")


def read_med(path: Path) -> Any:
    """Return the meshes of a file as one mesh of meshio, groups as its cell sets.

    Solids that no group of a file with groups holds are a group of the name of their mesh. A name
    that groups of two meshes have gets that of the mesh in front: ``part/name``.
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
    """Return groups of cells and the families they are made of."""
    groups: dict[str, list[int]] = {}
    for family, names in part.cell_tags.items():
        for name in names:
            groups.setdefault(name.strip("\0 "), []).append(int(family))
    return groups
