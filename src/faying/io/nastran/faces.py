"""Faces of solid elements, found by element id and corner grids, many at a time."""

from collections.abc import Callable, Sequence

import numpy as np

from faying._typing import Indices, Mask
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.surface import WIDTH, padded

Fits = Callable[[Indices, str, str, Indices], Mask]
"""Which of some requests (m,) mean a face: the requests, the kinds of the element and of the
face, and the face's corners (m, 3 or 4)."""


def find_faces(blocks: Sequence[CellBlock], elements: Indices, fits: Fits) -> tuple[Indices, Mask]:
    """Return the face of each requested element that fits.

    Parameters
    ----------
    elements : (n,)
        Element ids; several requests may name one element.

    Returns
    -------
    faces : (n, 8)
        Node indices, corners then mid-sides, counter-clockwise seen from outside, -1 behind the
        last; all -1 where not exactly one face fits.
    fitting : (n,)
        Whether the id is a solid element.
    """
    faces = np.full((len(elements), WIDTH), -1, dtype=np.int64)
    count = np.zeros(len(elements), dtype=np.int64)
    fitting = np.zeros(len(elements), dtype=bool)
    for block in blocks:
        order = np.argsort(block.ids, kind="stable")
        positions = np.searchsorted(block.ids, elements, sorter=order)
        row = order[np.minimum(positions, len(order) - 1)]
        members = np.flatnonzero(block.ids[row] == elements)
        fitting[members] = True
        nodes = block.nodes[row[members]]
        for face, local in SOLIDS[block.kind].faces:
            corners = nodes[:, list(local[: face.n_corners])]
            chosen = fits(members, block.kind, face.name, corners)
            faces[members[chosen]] = padded(nodes[chosen][:, list(local)])
            count[members[chosen]] += 1
    faces[count != 1] = -1
    return faces, fitting
