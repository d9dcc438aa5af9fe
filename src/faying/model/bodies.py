"""Bodies: the parts of a mesh that share no node."""

import numpy as np

from faying.model.mesh import Mesh


def body_names(mesh: Mesh) -> list[str]:
    """Name each body by the last element set that is the whole of it, else ``"body 0"``, …."""
    labels = mesh.bodies
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
