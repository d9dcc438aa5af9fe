"""The mesh of solid elements: nodes, blocks of cells of one kind, named sets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices, Matrix, frozen
from faying.exceptions import ModelError

FARTHEST = 1e30
"""Largest coordinate: products of several measures must stay within double precision."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CellBlock:
    """Solid elements of one kind.

    Attributes
    ----------
    kind
        A key of :data:`faying.model.elements.SOLIDS`, as in ``"hex8"``.
    nodes : (n_cell, n_node_per_cell) [into n_node]
        Node indices, in the Nastran order of the element.
    ids : (n_cell,) [1]
        Element ids as the user knows them; unique over all blocks of a mesh.
    properties : (n_cell,) [1]
        Property ids; they name the material through ``Assembly.materials``.
    formulation
        Of these elements, as in ``"reduced"``; empty for that of the assembly.
    """

    kind: str
    nodes: Indices
    ids: Indices
    properties: Indices
    formulation: str = ""

    def __post_init__(self) -> None:
        for name in ("nodes", "ids", "properties"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """Nodes and solid elements.

    Attributes
    ----------
    nodes : (n_node, 3) [length]
        Coordinates in the basic frame.
    node_ids : (n_node,)
        Node ids as the user knows them.
    blocks
        Solid elements, one block per kind (several blocks of one kind are allowed).
    node_sets, element_sets
        Names to node *indices* and to element *ids*.
    """

    nodes: Matrix
    node_ids: Indices
    blocks: tuple[CellBlock, ...] = ()
    node_sets: Mapping[str, Indices] = field(default_factory=dict)
    element_sets: Mapping[str, Indices] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(self.nodes))
        object.__setattr__(self, "node_ids", frozen(self.node_ids, np.int64))
        if self.nodes.shape != (len(self.node_ids), 3):
            message = f"{len(self.node_ids)} node ids but coordinates of shape {self.nodes.shape}"
            raise ModelError(message)
        far = np.flatnonzero(~(np.abs(self.nodes) <= FARTHEST).all(axis=1))
        if len(far):
            position = ", ".join(f"{x:g}" for x in self.nodes[far[0]])
            message = (
                f"node {self.node_ids[far[0]]} is at ({position}); coordinates are at most "
                f"{FARTHEST:g}, for volumes must stay within double precision; correct it"
            )
            raise ModelError(message)

    @property
    def n_elements(self) -> int:
        """Number of solid elements."""
        return sum(len(block.ids) for block in self.blocks)

    @property
    def element_ids(self) -> Indices:
        """Ids of all solid elements (n_element,), block by block."""
        return _joined([block.ids for block in self.blocks])

    @property
    def element_properties(self) -> Indices:
        """Property ids of all solid elements (n_element,), block by block."""
        return _joined([block.properties for block in self.blocks])

    def element_nodes(self, element_ids: Indices) -> Indices:
        """Return the indices of the nodes of solid elements given by id, each once, sorted."""
        used = np.zeros(len(self.nodes), dtype=bool)
        for block in self.blocks:
            used[block.nodes[np.isin(block.ids, element_ids)]] = True
        return np.flatnonzero(used)

    def node_index(self, node_ids: Indices) -> Indices:
        """Return the indices of nodes given by id.

        Raises
        ------
        ModelError
            If an id does not exist; the message names it.
        """
        ids = np.atleast_1d(np.asarray(node_ids, dtype=np.int64))
        order = np.argsort(self.node_ids, kind="stable")
        position = np.searchsorted(self.node_ids, ids, sorter=order)
        index: Indices = order[np.minimum(position, len(order) - 1)]
        missing = ids[self.node_ids[index] != ids]
        if missing.size:
            shown = ", ".join(map(str, missing[:5]))
            message = f"the model has no node with id {shown}; check the id in the study or deck"
            raise ModelError(message)
        return index

    def with_nodes(self, points: Matrix) -> "Mesh":
        """Return a copy with nodes (n, 3) appended; their ids follow the largest one."""
        points = np.atleast_2d(points)
        new_ids = self.node_ids.max(initial=0) + 1 + np.arange(len(points))
        return replace(
            self,
            nodes=np.vstack([self.nodes, points]),
            node_ids=np.concatenate([self.node_ids, new_ids]),
        )

    def with_node_set(self, name: str, nodes: Indices) -> "Mesh":
        """Return a copy with the named set of node indices added."""
        return replace(self, node_sets={**self.node_sets, name: frozen(nodes, np.int64)})


def _joined(parts: Sequence[Indices]) -> Indices:
    """Concatenate any number of index arrays, also none."""
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])
