"""A toy source: two equal boxes on one another, told by a text file of six numbers."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from faying.model.assembly import Assembly, Material
from faying.model.generate import brick_grid
from faying.model.mesh import CellBlock, Mesh


def read_boxes(path: Path, *, materials: Mapping[str, Material]) -> Assembly:
    """Read length, width and height of one box, and the numbers of bricks along them."""
    numbers = np.array(path.read_text(encoding="utf-8").split(), dtype=float)
    lines = [np.linspace(0, size, int(n) + 1) for size, n in numbers.reshape(2, 3).T]
    lower = brick_grid(*lines)
    upper = lower.nodes + np.array([0.0, 0.0, numbers[2]])
    cells = np.concatenate([lower.cells, lower.cells + len(upper)])
    block = CellBlock(
        kind=lower.kind,
        nodes=cells,
        ids=np.arange(len(cells)) + 1,
        properties=np.ones(len(cells), dtype=np.int64),
    )
    nodes = np.concatenate([lower.nodes, upper])
    mesh = Mesh(nodes=nodes, node_ids=np.arange(len(nodes)) + 1, blocks=(block,))
    return Assembly(mesh=mesh, materials={1: next(iter(materials.values()))}, name=path.stem)
