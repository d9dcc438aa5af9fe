"""Maps of fields on an interface, drawn in its plane or unrolled."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline
from matplotlib.ticker import FuncFormatter
from scipy.spatial import cKDTree

from faying._typing import Indices, Matrix, Vector
from faying.display.plane import Plane as Plane
from faying.display.plane import Unrolled as Unrolled
from faying.display.plane import plane_of, unrolled
from faying.display.quantities import as_given
from faying.display.style import heading, plain
from faying.interface.mismatch import LARGEST_COSINE
from faying.interface.surface import pair_facets
from faying.model.elements import FACES
from faying.model.outline import outline_of
from faying.report.style import OPEN_COLOUR, new_figure
from faying.study.results.values import InterfaceRecord
from faying.units import Units

Map = Plane | Unrolled
"""The map of an interface."""

TICKS = FuncFormatter(lambda value, _: as_given(value, 3))
"""Numbers beside colour bars as in texts and tables, without a factor above the bar."""


def best_plane(record: InterfaceRecord) -> Map:
    """Return the map of an interface: its plane, its unrolled cylinder, or the best plane."""
    plane = plane_of(record.pair_points, record.normals, record.weights)
    return plane if plane.flat else unrolled(record.pair_points, record.normals) or plane


def looks_both_ways(record: InterfaceRecord) -> bool:
    """Return whether faces overlap in a map, as on both sides of a plate."""
    plane = best_plane(record)
    if isinstance(plane, Unrolled):
        return False
    across = record.normals @ np.cross(*plane.axes)
    return bool((across > -LARGEST_COSINE).any() and (across < LARGEST_COSINE).any())


Panel = Callable[[str, InterfaceRecord, Axes], str]
"""Function that draws an interface on axes, and returns the title of the map."""


def map_figure(
    records: Mapping[str, InterfaceRecord],
    panels: Sequence[Panel],
    width: float,
    room: float,
    title: str,
    states: Mapping[str, str] = MappingProxyType({}),
) -> Figure:
    """Return a figure with a row of maps for each interface, and a legend of states below them.

    Width, and room for titles and legend, are in inches.
    """
    heights = [_height(record, 0.83 * width / len(panels)) for record in records.values()]
    figure = new_figure(width, max(sum(heights), 2.0) + room)
    rows = figure.subplots(len(heights), len(panels), squeeze=False, height_ratios=heights)
    for row, (name, record) in zip(rows, records.items(), strict=True):
        for axes, panel in zip(row, panels, strict=True):
            axes.set_title(plain(panel(name, record, axes)), loc="left")
    if title:
        figure.suptitle(heading(title))
    if states:
        handles = [Patch(color=shade, label=state) for state, shade in states.items()]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(states))
    return figure


def _height(record: InterfaceRecord, width: float) -> float:
    """Return the height [inch] of a panel with a map of a given width and its labels."""
    flat = best_plane(record).project(record.pair_points)
    across, up = np.ptp(flat, axis=0) if len(flat) else (1.0, 1.0)
    ratio = up / across if across > 0 else 1.0
    return float(np.clip(0.8 * width * ratio, 0.8, 1.2 * width)) + 0.9


def draw_faces(record: InterfaceRecord, axes: Axes, units: Units) -> Map:
    """Draw the facets of an interface as grey surfaces, and return their map."""
    plane = best_plane(record)
    faces = covered(record, plane)
    flat = np.concatenate([np.empty((0, 2)), *faces])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel(f"{plane.labels[0]} [{units.length}]")
    axes.set_ylabel(f"{plane.labels[1]} [{units.length}]")
    if not len(flat):
        axes.text(0.5, 0.5, "no facets", ha="center", transform=axes.transAxes)
        return plane
    margin = 0.03 * max(np.ptp(flat, axis=0).max(), 1e-12)
    low, high = flat.min(axis=0) - margin, flat.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    # Edges of the same colour close the hairlines between neighbours.
    axes.add_collection(
        PolyCollection(faces, facecolors=OPEN_COLOUR, edgecolors=OPEN_COLOUR, lw=0.5)
    )
    points = plane.project(record.pair_points)
    for kind, nodes in pair_facets(record):
        ring = plane.whole(points[nodes[:, list(FACES[kind].ring)]])
        closed = np.concatenate([ring, ring[:, :1]], axis=1)
        axes.add_collection(
            LineCollection(list(closed), colors="k", linewidths=0.25, alpha=0.35, zorder=2)
        )
    return plane


def draw_map(
    record: InterfaceRecord,
    values: Vector,
    axes: Axes,
    units: Units,
    *,
    colours: str,
    limits: tuple[float, float],
    label: str,
    mark: bool = False,
) -> Axes:
    """Draw values at the contact points of an interface, each over the area nearest to it.

    Points with the value NaN are grey; ``mark`` draws a cross at the largest value.
    ``limits`` are the ends of the colour scale, which is pointed if values exceed both.
    """
    low, high = limits if limits[1] > limits[0] else (limits[0], limits[0] + 1.0)
    scale = Normalize(vmin=low, vmax=high)
    plane = draw_faces(record, axes, units)
    _draw_points(record, values, axes, plane, colours, scale)
    if mark and np.nan_to_num(values).max(initial=0.0) > 0:
        x, y = plane.project(record.points[[np.nanargmax(values)]])[0]
        axes.plot(x, y, "x", color="white", ms=9, mew=3.5, zorder=3)
        axes.plot(x, y, "x", color="black", ms=8, mew=1.5, zorder=3)
    beyond = low < 0 and bool(np.abs(values).max(initial=0.0) > high)
    _colour_bar(axes, ScalarMappable(scale, colours), label, "both" if beyond else "neither")
    return axes


def draw_states(
    record: InterfaceRecord,
    states: Indices,
    axes: Axes,
    units: Units,
    colours: Mapping[str, str],
) -> Axes:
    """Draw the state of each contact point (n_point,): the number of a named colour."""
    scale = Normalize(vmin=-0.5, vmax=len(colours) - 0.5)
    plane = draw_faces(record, axes, units)
    _draw_points(
        record, states.astype(float), axes, plane, ListedColormap([*colours.values()]), scale
    )
    return axes


def _draw_points(
    record: InterfaceRecord,
    values: Vector,
    axes: Axes,
    plane: Map,
    colours: str | Colormap,
    scale: Normalize,
) -> None:
    if not len(record.points) or not pair_facets(record):
        return
    polygons = covered(record, plane)
    corners = np.concatenate(polygons)
    low, high = corners.min(axis=0), corners.max(axis=0)
    # As many points as pixels of the panel.
    step = max((high - low).max() / max(axes.bbox.size), 1e-300)
    count = np.maximum(np.ceil((high - low) / step).astype(int), 1)
    x, y = (low[i] + (np.arange(count[i]) + 0.5) * (high - low)[i] / count[i] for i in (0, 1))
    nearest = _nearest(record, plane, np.stack(np.meshgrid(x, y), axis=-1))
    image = axes.imshow(
        np.asarray(values)[nearest],
        origin="lower",
        extent=(low[0], high[0], low[1], high[1]),
        cmap=colours,
        norm=scale,
        interpolation="nearest",
        aspect="equal",
        zorder=1.5,
    )
    # Clipped to the area in which both sides overlap.
    region = Outline.make_compound_path(*map(_closed, polygons))
    patch = PathPatch(region, transform=axes.transData, facecolor="none", edgecolor="none")
    axes.add_patch(patch)
    image.set_clip_path(patch)
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)


def covered(record: InterfaceRecord, plane: Map) -> list[Matrix]:
    """Return the polygons (n_corner, 2) of the map in which both sides overlap."""
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


def _nearest(record: InterfaceRecord, plane: Map, places: Matrix) -> Indices:
    """Return the contact points nearest to places of the map, also across its cut."""
    flat = plane.project(record.points)
    if isinstance(plane, Unrolled):
        flat = np.concatenate([flat, flat + np.array([plane.period, 0.0])])
    return np.asarray(cKDTree(flat).query(places)[1] % len(record.points))


def _closed(polygon: Matrix) -> Outline:
    """Return a closed counter-clockwise path, so that a union of facets has no holes."""
    x, y = polygon.T
    turn = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    ring = polygon if turn >= 0 else polygon[::-1]
    return Outline(np.concatenate([ring, ring[:1]]), closed=True)


def outline(record: InterfaceRecord) -> Matrix:
    """Return the boundary edges (n_edge, 2, 3) of an interface, which belong to one facet."""
    return outline_of(pair_facets(record), record.pair_points)


def _colour_bar(axes: Axes, scale: ScalarMappable, label: str, extend: str) -> None:
    """Add a colour bar beside a map, or below a long map."""
    width, height = (abs(np.diff(limits)[0]) for limits in (axes.get_xlim(), axes.get_ylim()))
    figure: Any = axes.figure
    if width > 5 * height:
        figure.colorbar(
            scale,
            ax=axes,
            label=label,
            extend=extend,
            format=TICKS,
            location="bottom",
            shrink=0.5,
            aspect=40,
        )
        return
    inset = axes.inset_axes((1.02, 0.0, 0.025, 1.0))
    figure.colorbar(scale, cax=inset, label=label, extend=extend, format=TICKS)
