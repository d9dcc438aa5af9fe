"""The gap between two measured surfaces, as far as a mesh resolves it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.ndimage as ndi
from scipy.spatial import cKDTree

from faying._typing import Matrix, Vector
from faying.exceptions import ModelError, refuse_model
from faying.interface.interface import Interface
from faying.interface.surface_scan import Scan
from faying.linalg.memory import require_room

EDGES_PER_WAVE = 4.0
"""Least number of facet edges per wave: fewer would alias it."""

CELLS_PER_WAVE = 32.0
"""Cells of the filter's grid in a wave of the cut-off.

Their position changes a bump of twice this width by 3e-4 of its height.
"""

ALPHA = float(np.sqrt(np.log(2) / np.pi))
"""Constant of the Gaussian filter of ISO 16610-21: waves at the cut-off keep half their height."""

LARGEST_HOLE = 0.2
"""Share of an interface without samples above which a scan is refused as another interface's."""

MOST_FILLED = 0.5
"""Distance to the nearest sample, over the cut-off, above which a point lies in a hole."""


@dataclass(frozen=True, kw_only=True)
class ScanPlacement:
    """Position of a scan on an interface, and its processing.

    Attributes
    ----------
    of
        The side that was scanned, or ``"gap"``.
    origin : (3,) [length]
        Position of its x = 0, y = 0.
    along : (3,)
        Direction of its x. Its y completes right-handed axes with heights, out of the scanned
        material, as the third; heights of a gap point out of the minus side.
    tilt
        ``"remove"``: the best-fitting plane is subtracted, and the sides touch at one point;
        ``"keep"``: heights are not changed.
    wavelength : [length]
        Shorter waves are filtered out; ``"auto"`` is four edges of facets.
    scale
        Factor from the scan's values to lengths of the model, 1e-3 for micrometres to millimetres.
    """

    of: Literal["minus", "plus", "gap"]
    origin: tuple[float, float, float]
    along: tuple[float, float, float]
    tilt: Literal["remove", "keep"] = "remove"
    wavelength: float | Literal["auto"] = "auto"
    scale: float = 1.0


def topography(
    interface: Interface, scans: Sequence[tuple[Scan, ScanPlacement]]
) -> tuple[Vector, list[str]]:
    """Return the gap (n_point,) from scans of one side, both or the gap, and what was done to each.

    A polynomial of second degree is the form of a scan. The rest of it is smoothed by the Gaussian
    filter of ISO 16610-21 in both directions, on a grid and weighted by the samples there, so that
    holes and edges have no weight. Points in holes larger than the filter have the form alone. The
    smallest value is zero where a tilt was removed: the sides are brought together until they
    touch. The result is added to the gap of the geometry.

    Raises
    ------
    ModelError
        If a scan leaves a fifth of the contact points without samples, or directions do not fit.
    """
    total, notes = np.zeros(interface.n_points), list[str]()
    for scan, placement in scans:
        heights, note = _heights(interface, scan, placement)
        total += heights if placement.of == "gap" else -heights
        notes.append(f"topography of interface '{interface.name}', {placement.of}: {note}")
    if any(placement.tilt == "remove" for _, placement in scans):
        total -= total.min()
    return total, notes


def _heights(interface: Interface, scan: Scan, placement: ScanPlacement) -> tuple[Vector, str]:
    """Return filtered heights at the contact points, and a description of the processing."""
    if scan.is_gap != (placement.of == "gap"):
        said = "gaps" if scan.is_gap else "heights of a side"
        message = f"interface '{interface.name}': the scan holds {said}, and is of '{placement.of}'"
        raise ModelError(message)
    points = _scan_coordinates(interface, placement)
    cutoff = _cutoff(interface, placement)
    away = cKDTree(scan.places).query(points)[0]
    bare = away > MOST_FILLED * cutoff
    share = float(interface.weights @ bare / interface.weights.sum())
    if share > LARGEST_HOLE:
        refuse_model(
            f"interface '{interface.name}': {share:.0%} of its area lies off the samples of the "
            f"scan of '{placement.of}', up to {away.max():.3g} away; check origin, along and units"
        )
    centre, size = points.mean(axis=0), np.ptp(points, axis=0).max()
    over = np.all(np.abs(scan.places - centre) <= size, axis=1)
    places, values = scan.places[over], placement.scale * scan.values[over]
    form = np.linalg.lstsq(_quadratic_terms(places, centre, size), values, rcond=None)[0]
    residual = values - _quadratic_terms(places, centre, size) @ form
    filtered = _gaussian_mean(places, residual, points, cutoff)
    heights = _quadratic_terms(points, centre, size) @ form + np.where(bare, 0.0, filtered)
    tilted = ""
    if placement.tilt == "remove":
        plane = _quadratic_terms(points, centre, size)[:, :3]
        fitted = np.linalg.lstsq(
            plane * np.sqrt(interface.weights)[:, None],
            heights * np.sqrt(interface.weights),
            rcond=None,
        )[0]
        heights = heights - plane @ fitted
        tilted = f", a tilt of {np.linalg.norm(fitted[1:]) / size:.2g} removed"
    filled = f", {share:.1%} of the area in holes has its form alone" if bare.any() else ""
    holes = f" ({scan.holes} without a value)" if scan.holes else ""
    note = (
        f"{len(scan.values)} samples{holes}, waves below {cutoff:.3g} filtered away: "
        f"rms {np.sqrt(np.mean(residual**2)):.3g} about its form before, "
        f"{np.sqrt(np.mean(filtered[~bare] ** 2)):.3g} after{tilted}{filled}"
    )
    return heights, note


def _scan_coordinates(interface: Interface, placement: ScanPlacement) -> Matrix:
    """Return the contact points (n_point, 2) in the axes of a scan."""
    normal = interface.weights @ interface.normals
    length = np.linalg.norm(normal)
    if length < np.sqrt(0.5) * interface.weights.sum():
        refuse_model(
            f"interface '{interface.name}' bends by more than a scan over a plane shows; give gaps "
            "at its nodes by initial_gap"
        )
    outward = normal / length * (-1.0 if placement.of == "plus" else 1.0)
    along = np.asarray(placement.along, dtype=float)
    along = along - outward * (along @ outward)
    if not np.linalg.norm(along) > 1e-3 * np.linalg.norm(placement.along):
        refuse_model(
            f"interface '{interface.name}': along = {list(placement.along)} points across the "
            "interface; give the direction in it where the scan's x points"
        )
    x = along / np.linalg.norm(along)
    away = interface.points - np.asarray(placement.origin, dtype=float)
    return np.asarray(away @ np.column_stack([x, np.cross(outward, x)]))


def _cutoff(interface: Interface, placement: ScanPlacement) -> float:
    if placement.wavelength != "auto":
        return float(placement.wavelength)
    n_face = len(np.unique(interface.face_of_point))
    return EDGES_PER_WAVE * float(np.sqrt(interface.weights.sum() / n_face))


def _quadratic_terms(places: Matrix, centre: Vector, size: float) -> Matrix:
    """Return 1, x, y, x², xy, y² of places (n, 6)."""
    x, y = ((places - centre) / size).T
    return np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])


def _gaussian_mean(places: Matrix, values: Vector, points: Matrix, cutoff: float) -> Vector:
    """Return the weighted Gaussian mean of samples at points (n_point,)."""
    cell = cutoff / CELLS_PER_WAVE
    low = np.minimum(places.min(axis=0), points.min(axis=0)) - cell
    cells = np.ceil((np.maximum(places.max(axis=0), points.max(axis=0)) - low) / cell) + 2
    require_room(
        48.0 * cells.prod(),  # six grids at once: sums, weights, and each of them blurred in turn
        f"the cells of a filter with a cut-off of {cutoff:.3g}",
        "give a longer wavelength, or leave it to the mesh",
    )
    shape = cells.astype(int)
    whole = np.floor((places - low) / cell).astype(int)
    part = (places - low) / cell - whole
    spread = ALPHA * cutoff / np.sqrt(2 * np.pi) / cell
    blurred, weight = np.zeros(shape), np.zeros(shape)
    # Each sample is divided among the four grid points around it, which keeps its position.
    for corner in ((0, 0), (0, 1), (1, 0), (1, 1)):
        flat = np.ravel_multi_index(tuple((whole + corner).T), tuple(shape))
        shares = np.prod(np.where(corner, part, 1 - part), axis=1)
        for field, amount in ((blurred, shares * values), (weight, shares)):
            field += np.bincount(flat, amount, minlength=shape.prod()).reshape(shape)
    blurred, weight = (
        ndi.gaussian_filter(field, spread, mode="constant", truncate=6.0)
        for field in (blurred, weight)
    )
    where = ((points - low) / cell).T
    total, share = (
        ndi.map_coordinates(field, where, order=3, mode="nearest") for field in (blurred, weight)
    )
    return np.asarray(total / np.maximum(share, np.finfo(float).tiny))


@dataclass(frozen=True, kw_only=True)
class Crown:
    """Gap h (|s|/d)ⁿ at the distance s from a line.

    Attributes
    ----------
    origin : (3,) [length]
        A point of the line, s = 0.
    along : (3,)
        Direction of s, in the interface; the line is perpendicular to it.
    distance : [length]
        d, distance from the line at which the gap is h.
    height : [length]
        h; negative where the surfaces are hollow.
    exponent
        n; 2 is a cylinder.
    """

    origin: tuple[float, float, float]
    along: tuple[float, float, float]
    distance: float
    height: float
    exponent: float = 2.0


def crown_gap(interface: Interface, crowns: Sequence[Crown]) -> Vector:
    """Return the gap (n_point,) [length] between crowned surfaces at first touch.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0).interfaces["joint"]
    >>> middle = tuple(joint.points.mean(axis=0))
    >>> bowed = Crown(origin=middle, along=(1.0, 0.0, 0.0), distance=20.0, height=0.05)
    >>> gap = crown_gap(joint, [bowed])
    >>> float(gap.min()), bool(gap.max() > 0.02)
    (0.0, True)
    """
    total = np.zeros(interface.n_points)
    for crown in crowns:
        direction = np.asarray(crown.along, dtype=float)
        length = float(np.linalg.norm(direction))
        if not length > 0:
            refuse_model(
                f"interface '{interface.name}': along = {list(crown.along)} is no direction; give "
                "where the gap of the crown grows"
            )
        s = (interface.points - np.asarray(crown.origin)) @ direction / length
        total += crown.height * (np.abs(s) / crown.distance) ** crown.exponent
    return np.asarray(total - total.min())
