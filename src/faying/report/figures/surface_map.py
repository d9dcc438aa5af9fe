"""Fields on an interface, drawn in the interface's own plane."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.tri import Triangulation
from scipy.spatial import cKDTree

from faying._typing import Indices, Mask, Matrix, Vector
from faying.interface.facets import shape_functions
from faying.model.elements import FACES
from faying.model.outline import outline_of
from faying.report.figures.plane import Map, Unrolled
from faying.report.style import OPEN_COLOUR
from faying.study.results.interface_surface import pair_facets
from faying.study.results.values import InterfaceRecord
from faying.units import Units

RASTER = 700
"""Pixels along the longer side of a map of contact points."""
TRIANGLES = 60_000
"""About how many triangles a smooth map is drawn with."""
FINEST = 12
"""Most subdivisions of a facet's edge: a pixel or two on a coarse mesh."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scale:
    """Colours of a map.

    Attributes
    ----------
    colours
        A colour map or its name.
    limits
        Values at its ends.
    """

    colours: str | Colormap
    limits: Normalize


def prepare(axes: Axes, record: InterfaceRecord, plane: Map, units: Units) -> None:
    """Set limits, labels and equal scales, and draw the facets as empty grey surfaces."""
    flat = np.concatenate([np.empty((0, 2)), *covered(record, plane)])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel(f"{plane.labels[0]} [{units.length}]")
    axes.set_ylabel(f"{plane.labels[1]} [{units.length}]")
    if not len(flat):
        axes.text(0.5, 0.5, "no facets", ha="center", transform=axes.transAxes)
        return
    margin = 0.03 * max(np.ptp(flat, axis=0).max(), 1e-12)
    low, high = flat.min(axis=0) - margin, flat.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    # Edges of the same colour close the hairlines between neighbours.
    axes.add_collection(
        PolyCollection(
            covered(record, plane), facecolors=OPEN_COLOUR, edgecolors=OPEN_COLOUR, lw=0.5
        )
    )


def covered(record: InterfaceRecord, plane: Map) -> list[Matrix]:
    """Return the polygons (n_corner, 2) where the two sides lie on each other, in the map."""
    flat, first = plane.project(record.pair_points), 0
    polygons: list[Matrix] = []
    for kind, nodes in pair_facets(record):
        share = None if record.face_coverage is None else record.face_coverage[first:]
        whole = slice(None) if share is None else share[: len(nodes)] >= 1
        polygons += list(plane.whole(flat[nodes[:, list(FACES[kind].ring)]])[whole])
        first += len(nodes)
    if record.overlap is not None:
        polygons += list(plane.project(record.overlap))
    return polygons


def _clipped(artist: Artist, axes: Axes, record: InterfaceRecord, plane: Map) -> None:
    """Show of an artist only what lies where the two sides lie on each other."""
    region = Outline.make_compound_path(*map(_closed, covered(record, plane)))
    patch = PathPatch(region, transform=axes.transData, facecolor="none", edgecolor="none")
    axes.add_patch(patch)
    artist.set_clip_path(patch)


def draw_averages(
    axes: Axes,
    record: InterfaceRecord,
    plane: Map,
    values: Vector,
    scale: Scale,
    *,
    open_points: Mask,
) -> Axes:
    """Draw nodal averages, interpolated over each facet; leave grey what is open.

    Parameters
    ----------
    values : (n_pair,)
    open_points : (n_point,)
        Contact points that carry nothing: the area nearest to them stays grey, for an average of
        zero is no pressure, and one of a neighbour's pressure is none of theirs.
    """
    flat = plane.project(record.pair_points)
    facets = pair_facets(record)
    count = max(sum(len(nodes) for _, nodes in facets), 1)
    fineness = int(np.clip(np.sqrt(TRIANGLES / 2 / count), 1, FINEST))
    points, data = [np.empty((0, 2))], [np.empty(0)]
    corners: list[Indices] = [np.empty((0, 3), dtype=np.int64)]
    offset = 0
    for kind, nodes in facets:
        places, pattern = subdivision(kind, fineness)
        shape = shape_functions(kind, places)
        points.append(np.einsum("pn,fnk->fpk", shape, plane.whole(flat[nodes])).reshape(-1, 2))
        data.append((values[nodes] @ shape.T).ravel())
        first = offset + len(places) * np.arange(len(nodes))
        corners.append((first[:, None, None] + pattern).reshape(-1, 3))
        offset += len(places) * len(nodes)
    if offset and not np.all(open_points):
        places, triangles = np.concatenate(points), np.concatenate(corners)
        nearest = _nearest(record, plane, places)
        # Under the grey as well nothing is drawn, or it would shine through at the border.
        apart = np.asarray(open_points)[nearest][triangles].all(axis=1)
        x, y = places.T
        field = axes.tripcolor(
            Triangulation(x, y, triangles, mask=apart),
            np.concatenate(data),
            shading="gouraud",
            cmap=scale.colours,
            norm=scale.limits,
            zorder=1.5,
        )
        if record.overlap is not None:
            _clipped(field, axes, record, plane)
    grey = ListedColormap([OPEN_COLOUR])
    cover = Scale(colours=grey, limits=Normalize(vmin=0.0, vmax=1.0))
    draw_points(axes, record, plane, np.where(open_points, 1.0, np.nan), cover)
    return axes


def subdivision(kind: str, fineness: int) -> tuple[Matrix, Indices]:
    """Divide a reference facet into small triangles.

    Colours are interpolated between corners, so corners must be close where the value varies.

    Returns
    -------
    places : (n, 2)
        Corners in the reference facet.
    triangles : (m, 3)
        Their indices.
    """
    steps = np.arange(fineness + 1)
    i, j = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
    places = np.stack([i, j], axis=-1) / fineness
    cell = np.flatnonzero((i < fineness) & (j < fineness))
    right, up = cell + fineness + 1, cell + 1
    lower = np.stack([cell, right, up], axis=-1)
    upper = np.stack([right, right + 1, up], axis=-1)
    if kind.startswith("quad"):
        return places, np.concatenate([lower, upper])
    inside = i + j
    triangles = np.concatenate([lower[inside[cell] < fineness], upper[inside[cell] < fineness - 1]])
    return places, triangles


def draw_points(
    axes: Axes, record: InterfaceRecord, plane: Map, values: Vector, scale: Scale
) -> Axes:
    """Draw values at the contact points (n_point,), each over the area nearest to it."""
    facets = pair_facets(record)
    if not len(record.points) or not facets:
        return axes
    corners = np.concatenate(covered(record, plane))
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = max((high - low).max() / RASTER, 1e-300)
    count = np.maximum(np.ceil((high - low) / step).astype(int), 1)
    x, y = (low[i] + (np.arange(count[i]) + 0.5) * (high - low)[i] / count[i] for i in (0, 1))
    pixels = np.stack(np.meshgrid(x, y), axis=-1)
    nearest = _nearest(record, plane, pixels)
    image = axes.imshow(
        np.asarray(values)[nearest],
        origin="lower",
        extent=(low[0], high[0], low[1], high[1]),
        cmap=scale.colours,
        norm=scale.limits,
        interpolation="nearest",
        aspect="equal",
        zorder=1.5,
    )
    _clipped(image, axes, record, plane)
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    draw_edges(axes, record, plane)
    return axes


def _nearest(record: InterfaceRecord, plane: Map, places: Matrix) -> Indices:
    """Return the contact points nearest to places of the map, across its cut too."""
    flat = plane.project(record.points)
    if isinstance(plane, Unrolled):
        flat = np.concatenate([flat, flat + np.array([plane.period, 0.0])])
    nearest: Indices = cKDTree(flat).query(places)[1] % len(record.points)
    return nearest


def _closed(polygon: Matrix) -> Outline:
    """Close a path, counter-clockwise so that a union of facets has no holes."""
    x, y = polygon.T
    turn = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    ring = polygon if turn >= 0 else polygon[::-1]
    return Outline(np.concatenate([ring, ring[:1]]), closed=True)


def draw_edges(axes: Axes, record: InterfaceRecord, plane: Map) -> Axes:
    """Draw the facets' edges, thin."""
    flat = plane.project(record.pair_points)
    for kind, nodes in pair_facets(record):
        ring = plane.whole(flat[nodes[:, list(FACES[kind].ring)]])
        closed = np.concatenate([ring, ring[:, :1]], axis=1)
        axes.add_collection(
            LineCollection(list(closed), colors="k", linewidths=0.25, alpha=0.35, zorder=2)
        )
    return axes


def outline(record: InterfaceRecord) -> Matrix:
    """Return the edges (n_edge, 2, 3) that bound an interface: those of one facet only."""
    return outline_of(pair_facets(record), record.pair_points)


def colour_bar(axes: Axes, scale: Scale, label: str, *, pointed: bool = False) -> None:
    """Put a colour bar beside a map, or below a long one; pointed where values go beyond."""
    width, height = (abs(np.diff(limits)[0]) for limits in (axes.get_xlim(), axes.get_ylim()))
    figure = axes.get_figure(root=True)
    if figure is None:
        return
    mappable = ScalarMappable(scale.limits, scale.colours)
    extend = "both" if pointed else "neither"
    if width > 5 * height:
        bar: dict[str, Any] = {"location": "bottom", "shrink": 0.5, "aspect": 40}
        figure.colorbar(mappable, ax=axes, label=label, extend=extend, **bar)
        return
    inset = axes.inset_axes((1.02, 0.0, 0.025, 1.0))
    figure.colorbar(mappable, cax=inset, label=label, extend=extend)


def panel_size(record: InterfaceRecord, plane: Map, width: float) -> tuple[float, float]:
    """Return the size [inch] of a panel that holds the map at a given width, labels included."""
    flat = plane.project(record.pair_points)
    across, up = np.ptp(flat, axis=0) if len(flat) else (1.0, 1.0)
    ratio = up / across if across > 0 else 1.0
    return width, float(np.clip(0.8 * width * ratio, 0.8, 1.2 * width)) + 0.9


def scale(colours: str, largest: float, *, signed: bool = False) -> Scale:
    """Return a colour scale from zero, or symmetric about zero; never empty."""
    top = largest if largest > 0 else 1.0
    return Scale(colours=colours, limits=Normalize(vmin=-top if signed else 0.0, vmax=top))
