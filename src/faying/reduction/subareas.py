"""Decomposition of an interface into subareas, as method A needs it (§15.3.3)."""

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import ModelError
from faying.interface.interface import Interface


def subareas(interface: Interface, count: int) -> Indices:
    """Cut an interface into parts of nearly equal area.

    The largest part is cut across its longest side, at half its area, until there are enough.

    Parameters
    ----------
    count
        Parts wanted; at most one per facet.

    Returns
    -------
    ndarray of int (n_point,)
        Part 0 … count - 1 of every contact point; facets are not divided.
    """
    if count < 1:
        message = f"{count} subareas asked for; give at least one"
        raise ModelError(message)
    # Nodal points name one of their facets each, and some facets may be named by none.
    numbers, facet = np.unique(interface.face_of_point, return_inverse=True)
    n_facet = len(numbers)
    area: Vector = np.bincount(facet, interface.weights, n_facet).astype(float)
    moment = [np.bincount(facet, interface.weights * x, n_facet) for x in interface.points.T]
    centres = np.array(moment).T / area[:, None]
    part = np.zeros(n_facet, dtype=np.int64)
    for new in range(1, min(count, n_facet)):
        size = np.bincount(part, area, new) * (np.bincount(part, minlength=new) > 1)
        members = np.flatnonzero(part == size.argmax())
        part[members[_far_half(centres[members], area[members])]] = new
    return part[facet]


def _far_half(centres: Matrix, area: Vector) -> Indices:
    """Facets beyond the plane that halves the area across the longest extent."""
    longest = int(np.ptp(centres, axis=0).argmax())
    order = np.lexsort((*np.delete(centres, longest, axis=1).T, centres[:, longest]))
    reached = np.cumsum(area[order])
    first = int(np.searchsorted(reached, reached[-1] * (0.5 + 1e-12), side="right"))
    return order[min(max(first, 1), len(order) - 1) :]
