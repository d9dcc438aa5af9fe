"""Mass and stiffness of shells and shear panels, and the sparsity of a block of elements.

Shear panels are parallelograms that carry only shear along their sides. The shear flow q is the
same on all sides; half the force of a side acts at either corner. Stresses are uniform, without
normal stress on any side, and their energy gives the flexibility c of the panel: q = f · u / c with
the nodal forces f of the unit flow, K = f fᵀ / c. For parallelograms this is the panel of S. J.
Garvey, "The quadrilateral shear panel", Aircraft Engineering 23 (1951) 134-135.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.exceptions import check_known, refuse_model
from faying.linalg.pieces import pieces
from faying.model.assembly import Assembly
from faying.model.elements.curved_shell import (
    CURVED_SHELLS,
    curved_matrices,
    directors,
    points_of,
    without_shear_strains,
)
from faying.model.elements.flat_shell import FLAT_SHELLS, flat_matrices
from faying.model.elements.shell_frames import (
    ElementLaws,
    carried,
    check_area,
    flat_frames,
    laws_in,
    on_nodes,
)
from faying.model.shells import ShellBlock


@dataclass(frozen=True, eq=False)
class NodePairs:
    """The pairs of nodes that share an element.

    Attributes
    ----------
    rows_start : (n_node + 1,)
    columns : (n_pair,)
        Pairs in compressed rows.
    slots : (n_cell, n_node_per_cell²)
        Number of the pair for each two nodes of an element.
    """

    rows_start: Indices
    columns: Indices
    slots: Indices

    @staticmethod
    def of(cells: Indices, n_node: int) -> "NodePairs":
        """Return the pairs of a block of cells (n_cell, n_node_per_cell)."""
        keys = (cells[:, :, None] * n_node + cells[:, None, :]).reshape(len(cells), -1)
        unique, slots = np.unique(keys, return_inverse=True)
        start = np.searchsorted(unique, np.arange(n_node + 1, dtype=np.int64) * n_node)
        return NodePairs(start, unique % max(n_node, 1), slots.reshape(keys.shape))

    @property
    def n_pairs(self) -> int:
        """Number of different pairs."""
        return len(self.columns)

    def add(self, total: Matrix, part: slice, values: Matrix) -> None:
        """Add values (n_cell_of_part · n_node_per_cell², n) of a batch to their pairs."""
        slots = self.slots[part].ravel()
        low, high = int(slots.min()), int(slots.max()) + 1
        shape = (high - low, len(slots))
        scatter = sp.csc_array((np.ones(len(slots)), slots - low, np.arange(len(slots) + 1)), shape)
        total[low:high] += scatter @ values

    def expanded(self, blocks: Matrix) -> SparseMatrix:
        """Return the matrix with a 3 x 3 block (n_pair, 9) per pair, on six dofs per node."""
        n_node = len(self.rows_start) - 1
        matrix = sp.bsr_array(
            (blocks.reshape(-1, 3, 3), self.columns, self.rows_start),
            shape=(3 * n_node, 3 * n_node),
        ).tocsr()
        return _on_six(matrix, n_node)

    def expanded_six(self, blocks: Matrix) -> SparseMatrix:
        """Return the matrix with a 6 x 6 block (n_pair, 36) per pair, without its zeros."""
        size = 6 * (len(self.rows_start) - 1)
        parts = (blocks.reshape(-1, 6, 6), self.columns, self.rows_start)
        matrix = sp.bsr_array(parts, shape=(size, size)).tocsr()
        matrix.eliminate_zeros()
        return matrix

    def expanded_diagonal(self, coefficients: Vector) -> SparseMatrix:
        """Return the matrix with coefficient · I₃ (n_pair,) per pair, on six dofs per node."""
        n_node = len(self.rows_start) - 1
        nodal = sp.csr_array((coefficients, self.columns, self.rows_start), shape=(n_node, n_node))
        return _on_six(sp.kron(nodal, sp.eye_array(3), format="csr"), n_node)


def _on_six(matrix: SparseMatrix, n_node: int) -> SparseMatrix:
    """Return a matrix of three dofs per node on six dofs per node."""
    index_type = matrix.indices.dtype
    columns = (matrix.indices + 3 * (matrix.indices // 3)).astype(index_type)
    counts = np.zeros((n_node, 6), dtype=np.int64)
    counts[:, :3] = np.diff(matrix.indptr).reshape(n_node, 3)
    start = np.concatenate([[0], np.cumsum(counts)]).astype(index_type)
    return sp.csr_array((matrix.data, columns, start), shape=(6 * n_node, 6 * n_node))


# Relative difference of opposite sides for coordinates of five digits.
_PARALLEL = 1e-4


def panel_matrices(local: Matrix, laws: ElementLaws, ids: Indices) -> tuple[Matrix, Matrix]:
    """Return mass and stiffness (n, 24, 24) of shear panels in their local frames.

    Corners in the frame of each panel are (n, 4, 3) [length].
    """
    first, second = local[:, 1] - local[:, 0], local[:, 3] - local[:, 0]
    skew = local[:, 2] - local[:, 0] - first - second
    size = np.abs(local).max(axis=(1, 2))
    wrong = np.flatnonzero(np.abs(skew).max(axis=1) > _PARALLEL * size)
    if wrong.size:
        refuse_model(
            f"shear panel {ids[wrong[0]]} is no plane parallelogram; give it opposite sides that "
            "are parallel, or use shells"
        )
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    # With x along the first side, zero normal stress on both sides and a unit flow along both.
    stress = np.zeros((len(local), 3))
    stress[:, 0], stress[:, 2] = 2 * second[:, 0] / second[:, 1], 1.0
    strain = np.linalg.solve(laws.stiffness[:, :3, :3], stress[..., None])[..., 0]
    flexibility = area * np.einsum("ei,ei->e", stress, strain)
    forces = np.zeros((len(local), 4, 6))
    for node, (a, b) in enumerate(((1, 1), (1, -1), (-1, -1), (-1, 1))):
        forces[:, node, :2] = -(a * first[:, :2] + b * second[:, :2]) / 2
    flat = forces.reshape(len(local), 24)
    stiffness = flat[:, :, None] * flat[:, None] / flexibility[:, None, None]
    table = FLAT_SHELLS["quad4"]
    share = np.einsum("q,qi,qj->ij", table.weights, table.values, table.values) / 4
    mass = np.einsum(
        "e,ij,ab->eiajb", laws.mass * area, share, np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    )
    return mass.reshape(len(local), 24, 24), stiffness


PANEL = "panel4"
"""A shear panel, the one kind without membrane or bending stiffness."""


def shell_matrices(assembly: Assembly, block: ShellBlock) -> tuple[SparseMatrix, SparseMatrix]:
    """Return mass and stiffness (6 n_node, 6 n_node) of a block of shells.

    Raises
    ------
    ModelError
        If a shell is collapsed, of an unknown kind, or its property has no section.

    Notes
    -----
    About 60 µs a shell.
    """
    _check_kind(block)
    integrate = _integrator(block)
    pattern = NodePairs.of(block.nodes, len(assembly.mesh.nodes))
    M, K = np.zeros((pattern.n_pairs, 36)), np.zeros((pattern.n_pairs, 36))
    for part in pieces(len(block.ids), (6 * block.nodes.shape[1]) ** 2):
        mass, stiffness = integrate(assembly, block, part)
        pattern.add(M, part, mass.reshape(-1, 36))
        pattern.add(K, part, stiffness.reshape(-1, 36))
    return pattern.expanded_six(M), pattern.expanded_six(K)


def shell_stiffness(
    assembly: Assembly, block: ShellBlock
) -> Iterator[tuple[slice, Matrix, Matrix]]:
    """Yield shells, positions (n, n_node, 3), and stiffness (n, node, node, 6, 6)."""
    for part in pieces(len(block.ids), (6 * block.nodes.shape[1]) ** 2):
        places = assembly.mesh.nodes[block.nodes[part]]
        if block.kind in CURVED_SHELLS:
            places = places + block.offsets[part, None, None] * directors(block.kind, places)
        yield part, places, _integrator(block)(assembly, block, part)[1]


def _integrator(
    block: ShellBlock,
) -> Callable[[Assembly, ShellBlock, slice], tuple[Matrix, Matrix]]:
    return _curved if block.kind in CURVED_SHELLS else _flat


def _check_kind(block: ShellBlock) -> None:
    check_known(block.kind, (*FLAT_SHELLS, *CURVED_SHELLS, PANEL), "shell")


def _flat(assembly: Assembly, block: ShellBlock, part: slice) -> tuple[Matrix, Matrix]:
    coordinates = assembly.mesh.nodes[block.nodes[part]]
    frames, local = flat_frames(coordinates, block.ids[part])
    laws = laws_in(block, part, frames, assembly.shell_sections)
    if block.kind == PANEL:
        mass, stiffness = panel_matrices(local, laws, block.ids[part])
    else:
        mass, stiffness = flat_matrices(block.kind, local[..., :2], laws)
    # Arms from the nodes to the flat surface, and from there to the reference surface.
    rise = block.offsets[part, None] - local[..., 2]
    motion = carried(frames, rise[..., None] * frames[:, None, 2])
    return on_nodes(mass, motion), on_nodes(stiffness, motion)


def _curved(assembly: Assembly, block: ShellBlock, part: slice) -> tuple[Matrix, Matrix]:
    coordinates = assembly.mesh.nodes[block.nodes[part]]
    ids = block.ids[part]
    director = directors(block.kind, coordinates)
    check_area(np.asarray(np.isfinite(director).all(axis=(1, 2))), ids)
    arms = block.offsets[part, None, None] * director
    tables = {}
    for name, rule in CURVED_SHELLS[block.kind].rules.items():
        points = points_of(rule, coordinates + arms)
        # A surface folded over within an element has normals in opposite directions.
        along = np.einsum("eqc,eic->eqi", points.frames[:, :, 2], director)
        check_area((along > 0).all(axis=(1, 2)) & (points.area > 0).all(axis=1), ids)
        laws = laws_in(block, part, points.frames, assembly.shell_sections)
        tables[name] = (points, without_shear_strains(laws))
    mass, stiffness = curved_matrices(block.kind, coordinates + arms, director, tables)
    axes = np.broadcast_to(np.eye(3), (*arms.shape[:2], 3, 3))
    motion = carried(axes, arms)
    return on_nodes(mass, motion), on_nodes(stiffness, motion)
