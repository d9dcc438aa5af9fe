"""The mesh of solid elements: nodes, blocks of cells of one kind, bodies, surface, named sets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, frozen
from faying.digits import LARGEST
from faying.display.facts import listed
from faying.exceptions import check_known, refuse_model
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.surface import WIDTH, Facets, padded, unique_rows


@dataclass(frozen=True, eq=False)
class Topology:
    """Cells of solid elements, and the properties that follow from their shared nodes.

    Attributes
    ----------
    blocks
        Of any kind, also mixed; a linear and a quadratic facet on the same corners count as one
        inner facet.
    """

    blocks: tuple[CellBlock, ...] = ()

    @cached_property
    def bodies(self) -> Indices:
        """Connected component of each node (n,) up to the last that a cell has.

        Elements of one body share nodes. Body 0, 1, … in the order of the lowest node; -1 for nodes
        of no cell. Linear in the number of cells.
        """
        n_node = max((int(block.nodes.max(initial=-1)) for block in self.blocks), default=-1) + 1
        labels: Indices = np.full(n_node, -1, dtype=np.int64)
        if not n_node:
            labels.setflags(write=False)
            return labels
        first = [np.repeat(b.nodes[:, 0], b.nodes.shape[1] - 1) for b in self.blocks]
        following = [b.nodes[:, 1:].ravel() for b in self.blocks]
        rows, columns = np.concatenate(first), np.concatenate(following)
        ones = np.ones(len(rows), dtype=np.int8)
        graph = sp.csr_array((ones, (rows, columns)), shape=(n_node, n_node))
        _, component = connected_components(graph, directed=False)
        solid = np.zeros(n_node, dtype=bool)
        for block in self.blocks:
            solid[block.nodes] = True
        _, lowest, inverse = np.unique(component[solid], return_index=True, return_inverse=True)
        rank = np.empty(len(lowest), dtype=np.int64)
        rank[np.argsort(lowest)] = np.arange(len(lowest))
        labels[solid] = rank[inverse]
        labels.setflags(write=False)
        return labels

    @cached_property
    def exterior(self) -> Facets:
        """Facets that belong to one element only, with their elements.

        Block by block, in the order of the elements' faces, by one sort of all facets.
        """
        keys, kinds = [np.empty((0, 4), dtype=np.int64)], []
        for block in self.blocks:
            check_known(block.kind, SOLIDS, "solid element")
            for face, local in SOLIDS[block.kind].faces:
                corners = list(local[: face.n_corners])
                key = np.full((len(block.ids), 4), -1, dtype=np.int64)
                key[:, : len(corners)] = block.nodes[:, corners]
                key.sort(axis=1)
                keys.append(key)
                kinds.append((block, list(local)))
        _, inverse, counts = unique_rows(np.concatenate(keys))
        alone = np.split(counts[inverse] == 1, np.cumsum([len(key) for key in keys])[1:-1])
        tables, elements, properties = [np.empty((0, WIDTH), dtype=np.int64)], [], []
        for (block, columns), chosen in zip(kinds, alone, strict=True) if kinds else ():
            tables.append(padded(block.nodes[chosen][:, columns]))
            elements.append(block.ids[chosen])
            properties.append(block.properties[chosen])
        nodes = np.concatenate(tables)
        nothing = np.empty(0, dtype=np.int64)
        return Facets(
            nodes=nodes,
            elements=np.concatenate([nothing, *elements]),
            properties=np.concatenate([nothing, *properties]),
            bodies=self.bodies[nodes[:, 0]],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """Nodes and solid elements.

    Attributes
    ----------
    nodes : (n_node, 3) [length]
        Coordinates in the basic frame.
    node_ids : (n_node,)
        Node ids of the user.
    blocks
        Solid elements, one block per kind (several blocks of one kind are allowed).
    node_sets, element_sets
        Names to node *indices* and to element *ids*.
    topology
        Connectivity of the cells, shared by copies of the mesh with the same blocks, and formed
        anew for other blocks.
    """

    nodes: Matrix
    node_ids: Indices
    blocks: tuple[CellBlock, ...] = ()
    node_sets: Mapping[str, Indices] = field(default_factory=dict)
    element_sets: Mapping[str, Indices] = field(default_factory=dict)
    topology: Topology = field(default_factory=Topology)

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(self.nodes))
        object.__setattr__(self, "node_ids", frozen(self.node_ids, np.int64))
        if self.nodes.shape != (len(self.node_ids), 3):
            refuse_model(
                f"{len(self.node_ids)} node ids but coordinates of shape {self.nodes.shape}"
            )
        far = np.flatnonzero(~(np.abs(self.nodes) <= LARGEST).all(axis=1))
        if len(far):
            position = ", ".join(f"{x:g}" for x in self.nodes[far[0]])
            refuse_model(
                f"node {self.node_ids[far[0]]} is at ({position}); coordinates are at most "
                f"{LARGEST:g}, for volumes must stay within double precision; correct it"
            )

        if self.topology.blocks is not self.blocks:
            object.__setattr__(self, "topology", Topology(self.blocks))

    @property
    def bodies(self) -> Indices:
        """Body of each node (n_node,) in the order of the lowest node; -1 for nodes of no solid."""
        labels = self.topology.bodies
        return np.pad(labels, (0, len(self.nodes) - len(labels)), constant_values=-1)

    @property
    def exterior(self) -> Facets:
        """Facets that belong to one element only, block by block in the order of their faces.

        Facets that touch another body count as exterior: bodies share no nodes.
        """
        return self.topology.exterior

    @property
    def n_elements(self) -> int:
        """Number of solid elements."""
        return sum(len(block.ids) for block in self.blocks)

    @property
    def element_ids(self) -> Indices:
        """Ids of all solid elements (n_element,), block by block."""
        return _concatenated([block.ids for block in self.blocks])

    @property
    def element_properties(self) -> Indices:
        """Property ids of all solid elements (n_element,), block by block."""
        return _concatenated([block.properties for block in self.blocks])

    def element_nodes(self, element_ids: Indices) -> Indices:
        """Return the sorted indices of the nodes of solid elements, by element ids."""
        used = np.zeros(len(self.nodes), dtype=bool)
        for block in self.blocks:
            used[block.nodes[np.isin(block.ids, element_ids)]] = True
        return np.flatnonzero(used)

    def node_index(self, node_ids: Indices) -> Indices:
        """Return the indices of nodes, by their ids.

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
            refuse_model(
                f"the model has no node with id {listed(missing)}; check the id in the study or "
                "deck"
            )
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


def _concatenated(parts: Sequence[Indices]) -> Indices:
    """Return index arrays concatenated; empty if there are none."""
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])
