"""Connections between the nodes of an assembly, and the parts that they form."""

from collections.abc import Collection
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices
from faying.model.assembly import Assembly, Beam, Spring

LINKS = {
    "beams": "beam",
    "bushes": "bush",
    "springs": "spring",
    "masses": "point mass",
    "scalar_masses": "scalar mass",
    "rigid_couplings": "rigid coupling",
    "average_couplings": "average coupling",
    "equations": "equation",
}
"""Families of connections in an assembly, and the name of a member of each."""


def joined_nodes(assembly: Assembly) -> list[tuple[Any, Indices]]:
    """Return what joins several nodes, with these nodes; masses at single nodes join nothing."""
    return [
        (member, linked_nodes(family, member))
        for family in LINKS
        if not family.endswith("masses")
        for member in getattr(assembly, family)
    ]


def linked_nodes(family: str, member: Any) -> Indices:
    """Return the nodes of a member of a family of connections."""
    if family == "masses":
        return np.array([member.node], dtype=np.int64)
    if family in ("springs", "scalar_masses"):
        return np.array([node for node, _ in member.ends], dtype=np.int64)
    if family == "equations":
        return np.array([node for node, _, _ in member.terms], dtype=np.int64)
    own = [member.reference] if family.endswith("couplings") else []
    return np.array([*member.nodes, *own], dtype=np.int64)


def connected_parts(assembly: Assembly, without: Collection[int] = ()) -> Indices:
    """Return labels of parts connected by elements, couplings, equations, matrices and supports.

    Contact and sticking areas connect nothing, nor do beams and springs whose ids are ``without``.
    There is a label for each node, and for the ground last (n_node + 1,).

    Notes
    -----
    Linear in the size of the assembly.
    """
    ground = len(assembly.mesh.nodes)
    starts, ends = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]

    def join(first: Indices | int, others: Indices) -> None:
        others = np.asarray(others, dtype=np.int64).ravel()
        starts.append(np.broadcast_to(np.asarray(first, dtype=np.int64), others.shape))
        ends.append(others)

    cells = [block.nodes for block in assembly.mesh.blocks]
    for members in (*cells, *(block.nodes for block in assembly.shells)):
        join(np.repeat(members[:, 0], members.shape[1]), members)
    for member, nodes in joined_nodes(assembly):
        if not (isinstance(member, Beam | Spring) and member.id in without):
            join(nodes[0], nodes[1:] if len(nodes) > 1 else np.array([ground]))
    for support in assembly.supports:
        join(ground, support.nodes)
    if assembly.matrices is not None:
        entries = assembly.matrices.K.tocoo()
        join(assembly.matrices.nodes[entries.row], assembly.matrices.nodes[entries.col])
    rows, columns = np.concatenate(starts), np.concatenate(ends)
    ones = np.ones(len(rows), dtype=np.int8)
    graph = sp.csr_array((ones, (rows, columns)), shape=(ground + 1, ground + 1))
    _, labels = connected_components(graph, directed=False)
    return np.asarray(labels, dtype=np.int64)
