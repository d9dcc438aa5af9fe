"""Faces of elements by id and number or corners, and pressures on them, many at a time."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.interface.facets import area_vectors, gauss_rule, shape_functions
from faying.model.cells import CellBlock
from faying.model.elements import FACES, SOLIDS
from faying.model.shells import ShellBlock
from faying.model.surface import WIDTH, padded

Fits = Callable[[Indices, str, str, Indices], Mask]
"""Function that returns which requests (m,) mean a face, from requests, kinds of element and
face, and the face's corners (m, 3 or 4)."""


_Block = TypeVar("_Block", CellBlock, ShellBlock)


def on_blocks(blocks: Sequence[_Block], ids: Indices) -> Iterator[tuple[_Block, Indices, Indices]]:
    """Yield each block that has some of the ids (n,), indices of these ids, and their nodes."""
    for block in blocks:
        order = np.argsort(block.ids, kind="stable")
        row = order[np.minimum(np.searchsorted(block.ids, ids, sorter=order), len(order) - 1)]
        members = np.flatnonzero(block.ids[row] == ids)
        if len(members):
            yield block, members, block.nodes[row[members]]


def numbered_faces(blocks: Sequence[CellBlock], elements: Indices, numbers: Indices) -> Indices:
    """Return the faces (n, 8) S1, S2, ... of elements by id, padded with -1."""
    faces = np.full((len(elements), WIDTH), -1, dtype=np.int64)
    for block, members, nodes in on_blocks(blocks, elements):
        for number, (_, local) in enumerate(SOLIDS[block.kind].faces, start=1):
            chosen = numbers[members] == number
            faces[members[chosen]] = padded(nodes[chosen][:, list(local)])
    return faces


def find_faces(blocks: Sequence[CellBlock], elements: Indices, fits: Fits) -> tuple[Indices, Mask]:
    """Return the face (n, 8) of each requested element (n,) that fits, and whether it is a solid.

    Several requests may name one element. Faces are node indices, corners then mid-sides,
    counter-clockwise seen from outside, padded with -1; all -1 unless exactly one face fits.
    """
    faces = np.full((len(elements), WIDTH), -1, dtype=np.int64)
    count = np.zeros(len(elements), dtype=np.int64)
    fitting = np.zeros(len(elements), dtype=bool)
    for block, members, nodes in on_blocks(blocks, elements):
        fitting[members] = True
        for face, local in SOLIDS[block.kind].faces:
            corners = nodes[:, list(local[: face.n_corners])]
            chosen = fits(members, block.kind, face.name, corners)
            faces[members[chosen]] = padded(nodes[chosen][:, list(local)])
            count[members[chosen]] += 1
    faces[count != 1] = -1
    return faces, fitting


def shell_facets(block: ShellBlock, chosen: Indices | Mask, turned: Mask) -> Indices:
    """Return shells as facets (n, n_node), seen from the side of their normal or turned (n,)."""
    corners, count = 3 if block.kind.startswith("tri") else 4, block.nodes.shape[1]
    middle = [*range(corners, count)][::-1]
    # Backwards from the last corner; the mid-side node of the last two corners comes first.
    order = [*range(corners)][::-1] + middle[1:] + middle[:1]
    nodes = block.nodes[chosen]
    return np.where(turned[:, None], nodes[:, order], nodes)


def face_areas(kind: str, places: Matrix) -> Matrix:
    """Return area vectors (n, n_q, 3) of faces at the points where pressures are integrated."""
    return area_vectors(kind, places, gauss_rule(kind, FACES[kind].pressure_order).points)


def nodal_forces(kind: str, traction: Matrix) -> Matrix:
    """Return consistent forces (n, n_node, 3) of tractions (n, n_q, 3) at Gauss points."""
    rule = gauss_rule(kind, FACES[kind].pressure_order)
    shape = shape_functions(kind, rule.points)
    return np.asarray(np.einsum("qa,q,fqd->fad", shape, rule.weights, traction))
