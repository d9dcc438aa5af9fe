"""Blocks of every solid kind for the tests: a box cut into cells, distorted if wanted."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from faying._typing import Indices, Matrix
from faying.model.assembly import Assembly, Material
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.generate import Cells
from faying.model.mesh import Mesh

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.29, density=7.82e-9)
# A brick cut into two wedges along the diagonal 0-2, and into six tetrahedra around 0-6.
WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))
BRICK_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)


def solid_block(kind: str, divisions: tuple[int, int, int], size: Matrix, distortion: float = 0.0):
    """Mesh of a box; interior corners move randomly by ``distortion`` × cell size."""
    nodes, bricks = brick_grid(divisions, size)
    if distortion:
        nodes = distorted(nodes, size, distortion * np.asarray(size) / divisions)
    cells = {
        "hex": lambda: bricks,
        "wed": lambda: bricks[:, WEDGES].reshape(-1, 6),
        "tet": lambda: bricks[:, six_tetrahedra()].reshape(-1, 4),
        "pyr": lambda: six_pyramids(bricks, len(nodes)),
    }[kind[:3]]()
    if kind.startswith("pyr"):
        nodes = np.vstack([nodes, nodes[bricks].mean(axis=1)])
    if SOLIDS[kind].n_nodes > cells.shape[1]:
        nodes, cells = with_midsides(kind, nodes, cells)
    block = CellBlock(
        kind=kind,
        nodes=cells,
        ids=np.arange(len(cells)) + 1,
        properties=np.ones(len(cells), dtype=int),
    )
    return Mesh(nodes=nodes, node_ids=np.arange(len(nodes)) + 1, blocks=(block,))


def stacked(*parts: Cells, names: Sequence[str] = (), beside: ArrayLike = ()) -> Mesh:
    """Mesh of bodies that share no node, and of nodes beside them.

    Bodies are counted from 1: each has a block, a property and an element set of its own, which is
    called "part 1" and so on unless named.
    """
    nodes = np.vstack([*(part.nodes for part in parts), np.reshape(beside, (-1, 3))])
    node = np.cumsum([0, *(len(part.nodes) for part in parts)])
    cell = np.cumsum([1, *(len(part.cells) for part in parts)])
    blocks = tuple(
        CellBlock(
            kind=part.kind,
            nodes=part.cells + node[place],
            ids=np.arange(cell[place], cell[place + 1]),
            properties=np.full(len(part.cells), place + 1),
        )
        for place, part in enumerate(parts)
    )
    names = names or [f"part {place + 1}" for place in range(len(parts))]
    return Mesh(
        nodes=nodes,
        node_ids=np.arange(1, len(nodes) + 1),
        blocks=blocks,
        element_sets={name: block.ids for name, block in zip(names, blocks, strict=True)},
    )


def solid_assembly(mesh: Mesh, formulation: str = "standard", material: Material = STEEL):
    return Assembly(mesh=mesh, materials={1: material}, element=formulation)


def brick_grid(divisions: tuple[int, int, int], size: Matrix) -> tuple[Matrix, Indices]:
    counts = np.asarray(divisions) + 1
    lattice = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    nodes = lattice.reshape(-1, 3) * (np.asarray(size) / divisions)
    first = np.stack(np.meshgrid(*map(np.arange, divisions), indexing="ij"), axis=-1)
    corner = first.reshape(-1, 1, 3) + BRICK_CORNERS
    bricks = (corner[..., 0] * counts[1] + corner[..., 1]) * counts[2] + corner[..., 2]
    return nodes, bricks


def distorted(nodes: Matrix, size: Matrix, step: Matrix) -> Matrix:
    inside = np.all((nodes > 1e-9) & (nodes < np.asarray(size) - 1e-9), axis=1)
    shift = np.random.default_rng(7).uniform(-1, 1, nodes.shape) * step
    return nodes + inside[:, None] * shift


def six_tetrahedra() -> Indices:
    """Kuhn's division: one tetrahedron for each order in which the three steps are taken."""
    lookup = {tuple(corner): i for i, corner in enumerate(BRICK_CORNERS.tolist())}
    cells = []
    for order in permutations(range(3)):
        path = np.vstack([np.zeros(3, int), np.cumsum(np.eye(3, dtype=int)[list(order)], axis=0)])
        cell = [lookup[tuple(point)] for point in path.tolist()]
        if np.linalg.det(np.diff(path, axis=0)) < 0:
            cell[1], cell[2] = cell[2], cell[1]
        cells.append(cell)
    return np.array(cells)


def six_pyramids(bricks: Indices, first: int) -> Indices:
    """Division around a node in the middle, of which the first brick's is ``first``."""
    sides = bricks[:, [[0, 1, 2, 3], [0, 4, 5, 1], [0, 3, 7, 4]]]
    others = bricks[:, [[4, 7, 6, 5], [2, 1, 5, 6], [3, 2, 6, 7]]]
    bases = np.concatenate([sides, others], axis=1)
    apex = np.broadcast_to(first + np.arange(len(bricks))[:, None, None], (*bases.shape[:2], 1))
    return np.concatenate([bases, apex], axis=2).reshape(-1, 5)


def edge_ends(kind: str) -> Indices:
    """The two local corners between which each mid-side node lies: (n_midside, 2)."""
    reference, n_corner = SOLIDS[kind].reference_nodes, SOLIDS[kind].n_corners
    i, j = np.triu_indices(n_corner, 1)
    middles = (reference[i] + reference[j]) / 2
    hit = [np.abs(middles - place).max(axis=1).argmin() for place in reference[n_corner:]]
    return np.stack([i[hit], j[hit]], axis=1)


def with_midsides(kind: str, nodes: Matrix, cells: Indices) -> tuple[Matrix, Indices]:
    """Add one node in the middle of every edge."""
    pairs = np.sort(cells[:, edge_ends(kind)], axis=2)
    edges, which = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    extra = len(nodes) + which.reshape(len(cells), -1)
    return np.vstack([nodes, nodes[edges].mean(axis=1)]), np.hstack([cells, extra])


def one_sheared_cell(mesh: Mesh) -> Mesh:
    """First cell of a block alone, with sheared and tapered corners and straight edges."""
    block = mesh.blocks[0]
    nodes = mesh.nodes[block.nodes[0]]
    x, y, z = nodes.T
    moved = np.stack([x + 0.2 * y, y + 0.1 * z, z * (1 + 0.1 * x)], axis=1)
    n_corner = SOLIDS[block.kind].n_corners
    if len(nodes) > n_corner:
        moved[n_corner:] = moved[edge_ends(block.kind)].mean(axis=1)
    cell = CellBlock(
        kind=block.kind, nodes=np.arange(len(nodes))[None], ids=np.array([1]), properties=[1]
    )
    return Mesh(nodes=moved, node_ids=np.arange(len(nodes)), blocks=(cell,))


def solid_dofs(n_node: int) -> Indices:
    """Degrees of freedom 0..2 of every node."""
    return (6 * np.arange(n_node)[:, None] + np.arange(3)).ravel()
