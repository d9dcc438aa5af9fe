"""The plane an interface is drawn in."""

import numpy as np

from faying.display.plane import Plane as Plane
from faying.display.plane import plane_of
from faying.study.results import InterfaceRecord


def best_plane(record: InterfaceRecord) -> Plane:
    """Return the plane of a flat interface, or the best one of a curved interface."""
    return plane_of(record.pair_points, record.normals, record.weights)


FACING = 0.9
"""Cosine of a normal and that of a map from which a face lies along the map."""


def looks_both_ways(record: InterfaceRecord) -> bool:
    """Say whether faces lie over each other in a map, as those of both sides of a plate."""
    across = record.normals @ np.cross(*best_plane(record).axes)
    return bool((across > FACING).any() and (across < -FACING).any())
