"""Stiffness of the part of a structure that determines some of its rows."""

from dataclasses import replace

import numpy as np

from faying._typing import Indices, Mask, SparseMatrix
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.matrices import assemble_matrices


def stiffness_around(assembly: Assembly, dofs: DofMap, nodes: Mask) -> SparseMatrix:
    """Return K (n_dof, n_dof) of all but the solids without any of some nodes (n_node,).

    Rows at these nodes are those of the whole K.
    """
    touching = [np.flatnonzero(nodes[block.nodes].any(axis=1)) for block in assembly.mesh.blocks]
    blocks = tuple(
        block.taken(cells)
        for block, cells in zip(assembly.mesh.blocks, touching, strict=True)
        if len(cells)
    )
    part = replace(assembly, mesh=replace(assembly.mesh, blocks=blocks))
    return dofs.projected(assemble_matrices(part).K)


def rigid_stiffness(assembly: Assembly, dofs: DofMap) -> SparseMatrix:
    """Return K (n_dof, n_dof) without solids whose nodes are all free.

    These do not resist rigid motions of their body, so the energy of such motions is that of K.
    """
    T = dofs.transformation
    single = np.flatnonzero(np.diff(T.indptr) == 1)
    first = T.indptr[single]
    unit = single[(dofs.free[T.indices[first]] == single) & (T.data[first] == 1.0)]
    free = np.zeros(T.shape[0], dtype=bool)
    free[unit] = True
    supported: Mask = np.asarray(~free.reshape(-1, 6)[:, :3].all(axis=1))
    return stiffness_around(assembly, dofs, supported)


def stiffness_at(assembly: Assembly, dofs: DofMap, nodes: Indices) -> SparseMatrix:
    """Return K (n_dof, n_dof) with all rows that move some nodes, constraints included."""
    T = dofs.transformation
    rows = (6 * nodes[:, None] + np.arange(6)).ravel()
    moving = np.zeros(T.shape[1], dtype=bool)
    moving[T[rows].indices] = True
    owner = np.repeat(np.arange(T.shape[0]), np.diff(T.indptr))
    touched = np.zeros(dofs.n_nodes, dtype=bool)
    touched[owner[moving[T.indices]] // 6] = True
    return stiffness_around(assembly, dofs, touched)
