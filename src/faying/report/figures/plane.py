"""The plane an interface is drawn in."""

from faying.display.plane import Plane as Plane
from faying.display.plane import plane_of
from faying.study.results import InterfaceRecord


def best_plane(record: InterfaceRecord) -> Plane:
    """Return the plane of a flat interface, or the best one of a curved interface."""
    return plane_of(record.pair_points, record.normals, record.weights)
