"""Bodies: the parts of a mesh that share no node."""

from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices
from faying.model.mesh import CellBlock, Mesh


def bodies(mesh: Mesh) -> Indices:
    """Label the connected components of the solid elements.

    Parameters
    ----------
    mesh
        Solids of any kind; elements belong together where they share a node.

    Returns
    -------
    ndarray (n_node,)
        Body 0, 1, … in the order of the lowest node; -1 for nodes of no solid.

    Notes
    -----
    Linear in the number of cells, once for meshes of the same cells.
    """
    return labelled(mesh.blocks, len(mesh.nodes))


@lru_cache(maxsize=1)
def labelled(blocks: tuple[CellBlock, ...], n_node: int) -> Indices:
    """Label the nodes (n_node,) of cells as :func:`bodies`."""
    labels: Indices = np.full(n_node, -1, dtype=np.int64)
    if not blocks:
        labels.setflags(write=False)
        return labels
    first = [np.repeat(b.nodes[:, 0], b.nodes.shape[1] - 1) for b in blocks]
    following = [b.nodes[:, 1:].ravel() for b in blocks]
    rows, columns = np.concatenate(first), np.concatenate(following)
    ones = np.ones(len(rows), dtype=np.int8)
    graph = sp.csr_array((ones, (rows, columns)), shape=(n_node, n_node))
    _, component = connected_components(graph, directed=False)
    solid = np.zeros(n_node, dtype=bool)
    for block in blocks:
        solid[block.nodes] = True
    _, lowest, inverse = np.unique(component[solid], return_index=True, return_inverse=True)
    rank = np.empty(len(lowest), dtype=np.int64)
    rank[np.argsort(lowest)] = np.arange(len(lowest))
    labels[solid] = rank[inverse]
    labels.setflags(write=False)
    return labels


def body_names(mesh: Mesh) -> list[str]:
    """Name each body by the last element set that is the whole of it, else ``"body 0"``, …."""
    labels = bodies(mesh)
    names = [f"body {number}" for number in range(int(labels.max(initial=-1)) + 1)]
    ids = mesh.element_ids
    order = np.argsort(ids, kind="stable")
    owner = np.concatenate([labels[:0], *(labels[block.nodes[:, 0]] for block in mesh.blocks)])
    for name, members in mesh.element_sets.items() if len(ids) else ():
        rows = order[np.minimum(np.searchsorted(ids, members, sorter=order), len(ids) - 1)]
        inside = owner[rows[ids[rows] == members]]
        if not len(inside) or inside.min() != inside.max():
            continue
        if np.count_nonzero(labels == inside[0]) == len(mesh.element_nodes(members)):
            names[int(inside[0])] = name
    return names
