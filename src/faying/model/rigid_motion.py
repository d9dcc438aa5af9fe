"""Free motions of a structure with rigid bodies, which no stiffness resists."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.digits import ROUND_OFF, SOLVED
from faying.linalg.singular import MECHANISM
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.matrices import rigid_body_motions
from faying.model.shell_matrices import PANEL
from faying.model.shells import ShellBlock

MOST_UNKNOWNS = 2000
"""Most unknowns of the dense eigenvalue problem, which then takes a minute."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeMotions:
    """The free motions of a structure.

    Attributes
    ----------
    motions : (n_dof, n_motion)
        Displacements at the free degrees of freedom without strain energy, orthonormal: the size
        of each node's motion in all of them is unique.
    labels : (n_node,)
        Rigid part of each node, -1 for single nodes.
    searched
        False where there are too many parts for a search.
    """

    motions: Matrix
    labels: Indices
    searched: bool = True


def free_motions(assembly: Assembly, dofs: DofMap, K: SparseMatrix) -> FreeMotions:
    """Return the motions without strain energy in which every body is rigid.

    These are all mechanisms of a structure except hinges inside a body. Contact and initial forces
    hold nothing. K (n_dof, n_dof) is at the free degrees of freedom.

    Notes
    -----
    The unknowns are six per body, and the degrees of freedom of nodes of beams, springs and
    couplings; given matrices count as one body per connected part. One dense eigenvalue problem;
    with more than 2000 unknowns there is no search.
    """
    labels = rigid_parts(assembly)
    shapes = _rigid_shapes(assembly, dofs, labels)
    if not 0 < shapes.shape[1] <= MOST_UNKNOWNS:
        nothing = np.zeros((len(dofs.free), 0))
        return FreeMotions(
            motions=nothing, labels=labels, searched=shapes.shape[1] <= MOST_UNKNOWNS
        )
    stiffness = (shapes.T @ (K @ shapes)).toarray()
    singly = shapes.power(2).T @ K.diagonal()
    scale = 1 / np.sqrt(np.maximum(singly, np.finfo(float).eps * singly.max(initial=1.0)))
    energies, vectors = np.linalg.eigh(stiffness * scale[:, None] * scale)
    free = vectors[:, energies < MECHANISM]
    motions: Matrix = np.linalg.qr(shapes @ (scale[:, None] * free))[0]
    return FreeMotions(motions=motions, labels=labels)


def whole_motions(points: Matrix, free: Indices, K: SparseMatrix) -> Matrix:
    """Return the free motions (n_dof, n <= 6) of the structure as one rigid body.

    Points are (n_node, 3), free degrees of freedom rows 6 i + c (n_dof,); K (n_dof, n_dof) is that
    of the structure, or without solids that resist no rigid motion.
    """
    node, component = np.divmod(free, 6)
    if not len(free):
        return np.zeros((0, 0))
    centre = points[node].mean(axis=0)
    motions = rigid_motions(points[node], component, centre)
    motions[:, 3:] /= np.linalg.norm(points[node] - centre, axis=1).max() or 1.0
    entries = abs(K) @ np.abs(motions).max(axis=1)
    resisted = (K @ motions) / np.where(entries > 0, entries, 1.0)[:, None]
    _, size, ways = np.linalg.svd(np.linalg.qr(resisted, mode="r"))
    size = np.append(size, np.zeros(6))[:6]
    # Zero motions, as rotations about a line of nodes, meet no resistance either.
    # A grounded spring at one node resists by its stiffness over that of the elements there.
    whole = motions @ ways[size < ROUND_OFF].T
    left, seen, _ = np.linalg.svd(whole, full_matrices=False)
    # If all are zero, round-off remains; it is compared with motions of the structure.
    return left[:, seen > SOLVED * np.linalg.norm(motions)]


def rigid_parts(assembly: Assembly, cuts: Sequence[Indices] = ()) -> Indices:
    """Return labels of rigid parts: bodies of solids, shells, connected parts of given matrices.

    A node of several parts belongs to the first; a hinge between them costs no energy. Entries of
    matrices directly between the two nodes of a cut connect nothing.
    """
    labels = _with_shells(assembly, np.array(assembly.mesh.bodies))
    block = assembly.matrices
    if block is None:
        return labels
    n_node = len(labels)
    entries = sp.coo_array(block.K)
    ends = np.stack([block.nodes[entries.row], block.nodes[entries.col]])
    for cut in cuts:
        ends = ends[:, ~np.isin(ends, cut).all(axis=0)]
    graph = sp.csr_array((np.ones(ends.shape[1]), tuple(ends)), shape=(n_node, n_node))
    _, part = connected_components(graph, directed=False)
    return _continued(labels, block.nodes, part)


def _continued(labels: Indices, nodes: Indices, part: Indices) -> Indices:
    """Label nodes that have no label yet by the parts (n_node,) they are of."""
    new = np.intersect1d(nodes, np.flatnonzero(labels < 0))
    _, number = np.unique(part[new], return_inverse=True)
    labels[new] = labels.max(initial=-1) + 1 + number.ravel()
    return labels


def _surfaces(assembly: Assembly) -> list[ShellBlock]:
    """Return the shells that resist rotations; shear panels have more motions than rigid ones."""
    return [block for block in assembly.shells if block.kind != PANEL]


def _with_shells(assembly: Assembly, labels: Indices) -> Indices:
    """Return labels with those of connected shells added, at nodes without solids."""
    if not _surfaces(assembly):
        return labels
    n_node = len(labels)
    first = np.concatenate(
        [np.roll(block.nodes, 1, axis=1).ravel() for block in _surfaces(assembly)]
    )
    second = np.concatenate([block.nodes.ravel() for block in _surfaces(assembly)])
    # Shells that are connected by a solid alone may rotate there separately.
    apart = (labels[first] < 0) & (labels[second] < 0)
    ends = (first[apart], second[apart])
    graph = sp.csr_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(n_node, n_node))
    _, part = connected_components(graph, directed=False)
    return _continued(labels, second, part)


def _rigid_shapes(assembly: Assembly, dofs: DofMap, labels: Indices) -> SparseMatrix:
    """Return rigid motions of all parts and unit motions of all others (n_dof, n_unknown)."""
    node, component = np.divmod(dofs.free, 6)
    # Solids do not resist rotations of their nodes, shells do, given matrices may.
    turning = np.full(len(labels), assembly.matrices is not None)
    for shells in _surfaces(assembly):
        turning[shells.nodes] |= assembly.mesh.bodies[shells.nodes] < 0
    rigid = (labels[node] >= 0) & ((component < 3) | turning[node])
    single = np.flatnonzero(~rigid)
    groups = [(single, np.ones((len(single), 1)), np.arange(len(single))[:, None])]
    n_column = len(single)
    for label in range(int(labels.max(initial=-1)) + 1):
        rows = np.flatnonzero(rigid & (labels[node] == label))
        motions = _independent_motions(assembly.mesh.nodes[node[rows]], component[rows])
        columns = np.broadcast_to(n_column + np.arange(motions.shape[1]), motions.shape)
        groups.append((rows, motions, columns))
        n_column += motions.shape[1]
    return _group_matrix(groups, (len(node), n_column))


def _group_matrix(
    groups: list[tuple[Indices, Matrix, Indices]], shape: tuple[int, int]
) -> SparseMatrix:
    """Return a sparse matrix from groups of rows, with entries and columns of each group."""
    count = np.zeros(shape[0], dtype=np.int64)
    for rows, values, _ in groups:
        count[rows] = values.shape[1]
    start = np.concatenate([[0], np.cumsum(count)])
    data, indices = np.empty(start[-1]), np.empty(start[-1], dtype=np.int64)
    for rows, values, columns in groups:
        columns_of_rows = start[rows][:, None] + np.arange(values.shape[1])
        data[columns_of_rows], indices[columns_of_rows] = values, columns
    return sp.csr_array((data, indices, start), shape=shape)


def _independent_motions(points: Matrix, components: Indices) -> Matrix:
    """Return independent rigid motions at the given components (n, k <= 6)."""
    if not len(points):
        return np.zeros((0, 0))
    motions = rigid_motions(points, components, points.mean(axis=0))
    lengths = np.linalg.norm(motions, axis=0)
    left, size, _ = np.linalg.svd(
        motions / np.where(lengths > 0, lengths, 1.0), full_matrices=False
    )
    # Rotations about a line through all nodes vanish.
    return left[:, size > SOLVED * size[0]]


def rigid_motions(points: Matrix, components: Indices, origin: Vector) -> Matrix:
    """Return component ``components[i]`` of the six rigid motions at ``points[i]`` (n, 6)."""
    every = rigid_body_motions(points, origin).reshape(-1, 6, 6)
    return every[np.arange(len(points)), components]
