"""What the cells of a mesh are to each other, wherever their nodes are: bodies, and the surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices
from faying.exceptions import ModelError
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.surface import WIDTH, Facets, padded, unique_rows


@dataclass(frozen=True, eq=False)
class Topology:
    """Cells of solid elements, and what follows from the nodes that they share.

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

        Elements belong together where they share a node. Body 0, 1, … in the order of the lowest
        node; -1 for nodes of no cell. Linear in the number of cells.
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
        """Facets that belong to one element only, and whose they are.

        Block by block, in the order of the elements' faces, by one sort of all facets.
        """
        keys, kinds = [np.empty((0, 4), dtype=np.int64)], []
        for block in self.blocks:
            if block.kind not in SOLIDS:
                message = f"there is no solid element '{block.kind}'; known: {', '.join(SOLIDS)}"
                raise ModelError(message)
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
