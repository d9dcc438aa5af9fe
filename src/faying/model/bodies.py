"""Bodies: the parts of a mesh that share no node."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices
from faying.model.mesh import Mesh


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
    Linear in the number of cells.
    """
    n_node = len(mesh.nodes)
    first = [np.repeat(b.nodes[:, 0], b.nodes.shape[1]) for b in mesh.blocks]
    other = [b.nodes.ravel() for b in mesh.blocks]
    labels = np.full(n_node, -1, dtype=np.int64)
    if not other:
        return labels
    rows, columns = np.concatenate(first), np.concatenate(other)
    ones = np.ones(len(rows), dtype=np.int8)
    graph = sp.csr_array((ones, (rows, columns)), shape=(n_node, n_node))
    _, component = connected_components(graph, directed=False)
    solid = np.unique(columns)
    _, lowest, inverse = np.unique(component[solid], return_index=True, return_inverse=True)
    rank = np.empty(len(lowest), dtype=np.int64)
    rank[np.argsort(lowest)] = np.arange(len(lowest))
    labels[solid] = rank[inverse]
    return labels


def body_names(mesh: Mesh) -> list[str]:
    """Name each body by the last element set that is the whole of it, else ``"body 0"``, …."""
    labels = bodies(mesh)
    names = [f"body {number}" for number in range(int(labels.max(initial=-1)) + 1)]
    for name, ids in mesh.element_sets.items():
        nodes = mesh.element_nodes(ids)
        inside = np.unique(labels[nodes])
        if len(inside) == 1 and np.count_nonzero(labels == inside[0]) == len(nodes):
            names[int(inside[0])] = name
    return names
