"""The contact points around each bolt."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.interface.surface import ContactSurface
from faying.model.bolt import Bolt


def nearest_bolts(points: Matrix, bolts: Mapping[str, Bolt]) -> Indices:
    """Return the number of the bolt with the axis nearest to each point; 0 if all are unknown."""
    distances = np.array([axis_distances(points, bolt) for bolt in bolts.values()])
    return np.where(np.isfinite(distances).any(axis=0), distances.argmin(axis=0), 0)


def surroundings(
    surfaces: Mapping[str, ContactSurface], bolts: Mapping[str, Bolt]
) -> dict[tuple[str, str], Mask]:
    """Return the points (n_point,) of an interface nearest to a bolt, by interface and bolt.

    The masks are over all points of the joint. A bolt that is nearest to no point of an interface
    has no entry there; several bolts have none where the axis of any of them is unknown.
    """
    if not told_apart(bolts):
        return {}
    n_point = max((surface.slice[1] for surface in surfaces.values()), default=0)
    masks: dict[tuple[str, str], Mask] = {}
    for interface, surface in surfaces.items() if bolts else ():
        nearest = np.full(n_point, -1)
        nearest[slice(*surface.slice)] = nearest_bolts(surface.points, bolts)
        for number in np.unique(nearest[nearest >= 0]):
            masks[interface, list(bolts)[number]] = nearest == number
    return masks


def contact_areas(
    surfaces: Mapping[str, ContactSurface], bolts: Mapping[str, Bolt]
) -> dict[tuple[str, str], Vector]:
    """Return the weights (n_point,) [length²] of areas, by interface and bolt.

    Whole interfaces, with an empty bolt name, come first, then the areas around each bolt.
    """
    n_point = max((surface.slice[1] for surface in surfaces.values()), default=0)
    areas: dict[tuple[str, str], Vector] = {}
    for name, surface in surfaces.items():
        areas[name, ""] = np.zeros(n_point)
        areas[name, ""][slice(*surface.slice)] = surface.weights
    for (name, bolt), points in surroundings(surfaces, bolts).items():
        areas[name, bolt] = np.where(points, areas[name, ""], 0.0)
    return areas


def told_apart(bolts: Mapping[str, Bolt]) -> bool:
    """Return whether the areas around bolts are known: one bolt, or bolts with known axes."""
    return len(bolts) < 2 or all(bolt.ends is not None for bolt in bolts.values())


def axis_distances(points: Matrix, bolt: Bolt) -> Vector:
    """Return the distances (n_point,) of points from the axis of a bolt; infinite if unknown."""
    if bolt.ends is None:
        return np.full(len(points), np.inf)
    start, end = bolt.ends
    arms, along = points - start, end - start
    length = float(along @ along)
    if length > 0:
        arms = arms - np.outer(arms @ along / length, along)
    return np.asarray(np.linalg.norm(arms, axis=1))


def pressed_near(
    surfaces: Mapping[str, ContactSurface], bolt: Bolt, radius: float, points_left: Vector
) -> Mask:
    """Return the points within a radius of a bolt that are under pressure at rest (n_point,)."""
    pressed = np.zeros(len(points_left), dtype=bool)
    for surface in surfaces.values():
        pressed[slice(*surface.slice)] = axis_distances(surface.points, bolt) <= radius
    return pressed & (points_left > 0)
