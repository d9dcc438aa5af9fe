"""The plane an interface is drawn in."""

import numpy as np

from faying.display.plane import Plane as Plane
from faying.display.plane import plane_of
from faying.display.unrolled import Unrolled as Unrolled
from faying.display.unrolled import unrolled
from faying.study.results.values import InterfaceRecord

Map = Plane | Unrolled
"""Where an interface is drawn."""


def best_plane(record: InterfaceRecord) -> Map:
    """Return the map of an interface: its plane, its cylinder unrolled, or the best plane."""
    plane = plane_of(record.pair_points, record.normals, record.weights)
    return plane if plane.flat else unrolled(record.pair_points, record.normals) or plane


FACING = 0.9
"""Cosine of a normal and that of a map from which a face lies along the map."""


def looks_both_ways(record: InterfaceRecord) -> bool:
    """Say whether faces lie over each other in a map, as those of both sides of a plate."""
    plane = best_plane(record)
    if isinstance(plane, Unrolled):
        return False
    across = record.normals @ np.cross(*plane.axes)
    return bool((across > FACING).any() and (across < -FACING).any())
