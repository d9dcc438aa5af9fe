"""Nodes, sets and surfaces alone: what matrices of the same program need from their deck."""

from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from faying.io.abaqus.deck import read_keyword_deck
from faying.io.abaqus.instances import with_distinct_ids
from faying.io.abaqus.mesh import LINE_TYPES, SOLID_TYPES, read_elements, read_nodes
from faying.io.abaqus.sets import read_element_sets, read_node_sets
from faying.io.abaqus.solid_sections import cells
from faying.io.abaqus.surfaces import face_sets, read_surfaces
from faying.model.assembly import FaceSet
from faying.model.mesh import Mesh

_GEOMETRY = frozenset(("NODE", "SYSTEM", "ELEMENT", "NSET", "ELSET", "SURFACE"))


def read_geometry(path: str | PathLike[str]) -> tuple[Mesh, Mapping[str, FaceSet]]:
    """Read nodes, solids, sets and surfaces; whatever else the deck says is in the matrices.

    Elements of other kinds, and sets and surfaces that name them, are passed over.
    """
    deck = read_keyword_deck(Path(path))
    supported = (*SOLID_TYPES, *LINE_TYPES)
    keywords = [
        keyword
        for keyword in with_distinct_ids(deck.keywords, deck.ignored)
        if keyword.name in _GEOMETRY
        and (keyword.name != "ELEMENT" or keyword.value("TYPE").upper() in supported)
    ]
    deck = replace(deck, keywords=keywords)
    nodes = read_nodes(deck)
    elements = read_elements(deck, nodes)
    by_element = read_element_sets(deck, elements)
    by_node = read_node_sets(deck, nodes, elements, by_element)
    ids = sum(len(block.ids) for block in elements.solids)
    mesh = Mesh(
        nodes=nodes.coordinates,
        node_ids=nodes.ids,
        blocks=tuple(cells(elements.solids, np.zeros(ids, dtype=np.int64))),
        node_sets=by_node.indices(nodes),
    )
    return mesh, face_sets(read_surfaces(deck, mesh, by_element, by_node))
