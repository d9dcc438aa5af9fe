"""Structured meshes: grids of bricks, divided into other shapes, with mid-side nodes."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import check_known
from faying.model.elements import SOLIDS


@dataclass(frozen=True, eq=False, kw_only=True)
class Cells:
    """Nodes (n_node, 3) and cells (n_cell, n_node_per_cell) of one kind."""

    kind: str
    nodes: Matrix
    cells: Indices

    def centroids(self) -> Matrix:
        """Mean of the nodes of each cell (n_cell, 3)."""
        return np.asarray(self.nodes[self.cells].mean(axis=1))

    def restricted(self, keep: Mask) -> "Cells":
        """Return the cells where ``keep`` (n_cell,) holds, without unused nodes."""
        used, cells = np.unique(self.cells[keep], return_inverse=True)
        shape = (int(np.count_nonzero(keep)), self.cells.shape[1])
        return Cells(kind=self.kind, nodes=self.nodes[used], cells=cells.reshape(shape))


def brick_grid(x: Vector, y: Vector, z: Vector) -> Cells:
    """Return hex8 cells between increasing grid lines of a box; z runs fastest."""
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(len(x), len(y), len(z))
    corners = [(a, b, c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    n = (len(x) - 1, len(y) - 1, len(z) - 1)
    cells = [number[a : a + n[0], b : b + n[1], c : c + n[2]].ravel() for a, b, c in corners]
    return Cells(kind="hex8", nodes=nodes, cells=np.stack(cells, axis=1))


def shaped(bricks: Cells, shape: str) -> Cells:
    """Return another kind of solids from hex8 bricks, divided as the element defines.

    Neighbours share the mid-side nodes of quadratic kinds.

    Raises
    ------
    ModelError
        If the shape is not known.
    """
    shapes = [kind for kind, element_kind in SOLIDS.items() if element_kind.brick_cells]
    check_known(shape, shapes, "solid shape")
    element = SOLIDS[shape]
    cells = bricks.cells[:, element.brick_cells].reshape(-1, element.n_corners)
    result = Cells(kind=shape, nodes=bricks.nodes, cells=cells)
    return result if element.n_corners == element.n_nodes else with_midsides(result, shape)


def with_midsides(linear: Cells, kind: str) -> Cells:
    """Return a quadratic kind from its corners, with a mid-side node for each edge of the mesh."""
    element = SOLIDS[kind]
    ends = np.array(mid_side_ends(kind))
    edges = np.sort(linear.cells[:, ends], axis=2).reshape(-1, 2)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    midsides = inverse.reshape(len(linear.cells), element.n_nodes - element.n_corners)
    return Cells(
        kind=kind,
        nodes=np.vstack([linear.nodes, linear.nodes[unique].mean(axis=1)]),
        cells=np.hstack([linear.cells, midsides + len(linear.nodes)]),
    )


def mid_side_ends(kind: str) -> list[tuple[int, int]]:
    """Return the corners on either side of each mid-side node of a kind of solid."""
    element = SOLIDS[kind]
    corners = element.reference_nodes[: element.n_corners]
    first, second = np.triu_indices(element.n_corners, k=1)
    middles = (corners[first] + corners[second]) / 2
    midsides = element.reference_nodes[element.n_corners :]
    nearest = np.abs(midsides[:, None] - middles).sum(axis=2).argmin(axis=1)
    return list(zip(first[nearest].tolist(), second[nearest].tolist(), strict=True))
