"""Checks of solid cells, without their matrices."""

import numpy as np

from faying._typing import Indices
from faying.display.facts import listed
from faying.exceptions import refuse_model
from faying.linalg.pieces import pieces
from faying.model.assembly import Assembly, Material
from faying.model.cells import CellBlock
from faying.model.elements import SolidElement, block_element
from faying.model.elements.geometry import check_shapes, inverted_corners
from faying.model.surface import unique_rows


def materials_of(assembly: Assembly, block: CellBlock) -> tuple[list[Material], Indices]:
    """Return the materials of a block, and the index of each element's material."""
    properties, which = np.unique(block.properties, return_inverse=True)
    for position, number in enumerate(properties.tolist()):
        if number not in assembly.materials:
            element = block.ids[int(np.argmax(which == position))]
            refuse_model(
                f"property {number} (of element {element}, {block.kind}) has no material; give "
                "E, nu and rho in the deck or in a [material] table of the study"
            )
    return [assembly.materials[number] for number in properties.tolist()], which


def check_nodes(block: CellBlock, element: SolidElement, n_node: int) -> None:
    """Refuse cells with another number of nodes than their element."""
    if block.nodes.ndim != 2 or block.nodes.shape[1] != element.n_nodes:
        refuse_model(
            f"a block of {block.kind} elements has nodes of shape {block.nodes.shape}; "
            f"each element needs {element.n_nodes} nodes"
        )
    if block.nodes.min(initial=0) < 0 or block.nodes.max(initial=-1) >= n_node:
        outside = (block.nodes < 0) | (block.nodes >= n_node)
        cell, position = np.argwhere(outside)[0]
        refuse_model(
            f"element {block.ids[cell]} ({block.kind}) uses node index "
            f"{block.nodes[cell, position]}; the mesh has {n_node} nodes, counted from 0"
        )


def check_cells(assembly: Assembly) -> None:
    """Refuse solids whose matrices cannot be formed."""
    for block in assembly.mesh.blocks:
        element = block_element(block, assembly.element)
        check_nodes(block, element, len(assembly.mesh.nodes))
        materials_of(assembly, block)
        for part in pieces(len(block.ids), 9 * element.n_nodes):
            check_shapes(element, assembly.mesh.nodes[block.nodes[part]], block.ids[part])
    _check_once(assembly)


def tangled(assembly: Assembly) -> str:
    """Return a message on solids inverted at a corner alone; empty if there are none."""
    ids: list[int] = []
    for block in assembly.mesh.blocks:
        element = block_element(block, assembly.element)
        for part in pieces(len(block.ids), 9 * element.n_nodes):
            inverted = inverted_corners(element, assembly.mesh.nodes[block.nodes[part]])
            ids += block.ids[part][inverted].tolist()
    return (
        f"{len(ids)} solid elements are inside out at a corner ({listed(ids)}): matrices are "
        "formed, as elsewhere, but stresses and contact near them are not to be trusted; remesh"
        if ids
        else ""
    )


def _check_once(assembly: Assembly) -> None:
    """Refuse two cells on the same corners, whose stiffness and mass would count twice."""
    blocks = assembly.mesh.blocks
    corners = [
        block.nodes[:, : block_element(block, assembly.element).n_corners] for block in blocks
    ]
    for count in sorted({table.shape[1] for table in corners}):
        same = [i for i, table in enumerate(corners) if table.shape[1] == count]
        rows = np.sort(np.concatenate([corners[i] for i in same]), axis=1)
        _, group, sizes = unique_rows(rows)
        if (sizes > 1).any():
            ids = np.concatenate([blocks[i].ids for i in same])
            pair = np.flatnonzero(group == np.argmax(sizes > 1))[:2]
            refuse_model(
                f"elements {ids[pair[0]]} and {ids[pair[1]]} have the same corners: stiffness and "
                f"mass would count twice there; remove one ({int((sizes - 1).sum())} such in all; "
                "a .msh of version 2 lists cells of two physical groups twice: write version 4)"
            )
