"""Bodies: the parts of a mesh that share no nodes, and their separation where they do."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Indices, Mask
from faying.exceptions import refuse_model
from faying.model.cells import CellBlock
from faying.model.mesh import Mesh


def body_names(mesh: Mesh) -> list[str]:
    """Return the name of each body: the last element set that equals it, else ``"body 0"``, …."""
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


def separated(mesh: Mesh, groups: Sequence[str]) -> Mesh:
    """Return a mesh in which groups of solids share no nodes with other solids.

    A mesh of parts fragmented against each other is conforming: touching parts share nodes and act
    as one. Separated, they touch in matching facets, node on node. Groups are names of element
    sets. Shared nodes of two groups go to the one named first; the other group keeps the originals,
    as solids of no group do. A group without shared nodes does not change. Node sets contain the
    copies too.

    Notes
    -----
    Linear in the number of cells for each group.
    """
    for group in groups:
        if group not in mesh.element_sets:
            names = ", ".join(f"'{name}'" for name in mesh.element_sets) or "none"
            refuse_model(f"there is no element set '{group}' to separate; known are {names}")
        mesh = _separate_group(mesh, group)
    return mesh


def _separate_group(mesh: Mesh, group: str) -> Mesh:
    inside = [np.isin(block.ids, mesh.element_sets[group]) for block in mesh.blocks]
    inside_nodes, outside_nodes = (
        _used_nodes(mesh, chosen) for chosen in (inside, [~mask for mask in inside])
    )
    shared = np.flatnonzero(inside_nodes & outside_nodes)
    if not len(shared):
        return mesh
    copy = np.arange(len(mesh.nodes))
    copy[shared] = len(mesh.nodes) + np.arange(len(shared))
    wider = mesh.with_nodes(mesh.nodes[shared])
    return replace(
        wider,
        blocks=tuple(
            _renumber(block, chosen, copy)
            for block, chosen in zip(mesh.blocks, inside, strict=True)
        ),
        node_sets={
            name: np.concatenate([nodes, copy[nodes[np.isin(nodes, shared)]]])
            for name, nodes in mesh.node_sets.items()
        },
    )


def _used_nodes(mesh: Mesh, chosen: Sequence[Mask]) -> Mask:
    """Return the nodes (n_node,) that the chosen cells of each block use."""
    used = np.zeros(len(mesh.nodes), dtype=bool)
    for block, these in zip(mesh.blocks, chosen, strict=True):
        used[block.nodes[these]] = True
    return used


def _renumber(block: CellBlock, chosen: Mask, copy: Indices) -> CellBlock:
    nodes = np.where(chosen[:, None], copy[block.nodes], block.nodes)
    return replace(block, nodes=nodes)
