"""The facets of a recorded interface, in terms of its node pairs."""

import numpy as np

from faying._typing import Indices, Matrix
from faying.interface.averaging import facet_columns
from faying.interface.surface import ContactSurface


def pair_facets(record: ContactSurface) -> tuple[tuple[str, Indices], ...]:
    """Return kinds of facets of the minus side and their node pairs (n_face, n_node_per_face).

    These are indices into ``record.pairs``, one entry per facet kind, nodes in the order of the
    facets.
    """
    if not len(record.pairs):
        return ()
    return tuple(
        (faces.kind, facet_columns(record.pairs, faces.minus, faces.plus)) for faces in record.faces
    )


def nodal_average(record: ContactSurface, values: Matrix) -> Matrix:
    """Average values at all contact points (..., n_point) to the pairs (..., n_pair) of one."""
    at_points: Matrix = np.asarray(values)[..., slice(*record.slice)]
    return np.moveaxis(record.nodal_average(np.moveaxis(at_points, -1, 0)), 0, -1)
