"""Pictures of bodies, bolts and interfaces in three dimensions (as Fig. 15.2)."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
    Line3DCollection,
    Poly3DCollection,
)

from faying._typing import Indices, Matrix, Vector
from faying.display.axes import new_axes
from faying.display.facts import MOST_SHOWN
from faying.display.style import BODY_COLOURS, BOLT_COLOUR, INTERFACE_COLOUR, heading, plain
from faying.interface.interface import Interface
from faying.model.assembly import Assembly
from faying.model.bodies import body_names
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.model.cells import CellBlock
from faying.model.elements import FACES
from faying.model.mesh import Mesh
from faying.model.outline import outline_of
from faying.units import units_of

VIEW = {"elev": 24.0, "azim": -58.0}
SLENDER_HEIGHT = 0.5
"""Height over length above which a body fills the picture and needs space for names above it."""
MANY_FACETS = 20_000
"""Number of facets above which edges would blacken the picture."""
# Light from the upper left of the viewer; enough ambient light that no side is black.
LIGHT = np.array([-0.35, -0.6, 0.72])
AMBIENT = 0.62


def plot_bodies(
    nodes: Matrix,
    blocks: Sequence[CellBlock],
    body: Indices,
    axes: Any,
) -> Any:
    """Draw the exterior facets of the solids, one colour per body (n_node,), on 3D axes.

    Nodes are drawn at (n_node, 3).
    """
    axes.computed_zorder = False
    mesh = Mesh(nodes=nodes, node_ids=np.arange(len(nodes)), blocks=tuple(blocks))
    polygons: list[Matrix] = []
    colours: list[Matrix] = []
    for kind, facets in mesh.exterior.by_kind().items():
        ring = facets[:, list(FACES[kind].ring)]
        corners = nodes[ring]
        polygons.extend(corners)
        base = np.array([to_rgb(colour) for colour in BODY_COLOURS])
        owner = base[np.maximum(body[ring[:, 0]], 0) % len(base)]
        colours.append(owner * _shade(corners)[:, None])
    edge = (0.15, 0.15, 0.15, 0.35) if len(polygons) <= MANY_FACETS else "none"
    if polygons:
        axes.add_collection3d(
            Poly3DCollection(
                polygons, facecolors=np.concatenate(colours), edgecolors=edge, lw=0.3, zorder=1
            )
        )
    frame(axes, nodes)
    return axes


def _shade(corners: Matrix) -> Vector:
    """Return the brightness of facets (n, k, 3) from their normals."""
    half = corners.shape[1] // 2
    normal = np.cross(corners[:, half] - corners[:, 0], corners[:, -1] - corners[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    unit = normal / np.where(length > 0, length, 1.0)
    light = np.clip(unit @ (LIGHT / np.linalg.norm(LIGHT)), 0.0, 1.0)
    return np.asarray(AMBIENT + (1 - AMBIENT) * light)


def frame(axes: Any, points: Matrix) -> None:
    """Show all points at equal scales, from a common point of view."""
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3),) * 2
    extent = np.maximum(high - low, 0.02 * max((high - low).max(), 1e-12))
    middle = (low + high) / 2
    for set_limits, centre, size in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, extent, strict=True
    ):
        set_limits(centre - size / 2, centre + size / 2)
    axes.set_box_aspect(extent, zoom=_zoom(extent))
    axes.view_init(**VIEW)
    axes.grid(visible=False)
    for axis, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), extent, strict=True):
        axis.pane.set_visible(False)
        # Short sides have space for few numbers.
        axis.set_major_locator(_ticks(size, extent.max()))


def _zoom(extent: Vector) -> float:
    return 0.85 if extent[2] < SLENDER_HEIGHT * extent.max() else 0.7


def _ticks(size: float, longest: float) -> Any:
    bins = 6 if size > 0.6 * longest else (4 if size > 0.25 * longest else 2)
    return MaxNLocator(nbins=bins, prune=None if bins > 4 else "both")


def _fit_labels(axes: Any) -> None:
    """Shrink the box where a label of an axis reaches over the edge of the figure."""
    page = axes.figure.bbox
    axes.figure.draw_without_rendering()
    labels = [axis.label.get_window_extent() for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
    over = max(max(label.x1 - page.x1, page.x0 - label.x0) for label in labels)
    if over > 0:
        limits = (axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d())
        extent = np.ptp(np.array(limits), axis=1)
        axes.set_box_aspect(extent, zoom=_zoom(extent) * (1 - 2 * (over + MARGIN) / page.width))


MARGIN = 10.0
"""Pixels between a label and the edge of a figure."""


def title_above(axes: Any, title: str) -> None:
    """Write a title just above the box, the bolts and their names."""
    _fit_labels(axes)
    limits = [axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d()]
    corners = np.stack(np.meshgrid(*limits), axis=-1).reshape(-1, 3)
    names = np.array([text.get_position_3d() for text in axes.texts]).reshape(-1, 3)
    axes.figure.draw_without_rendering()  # only now are axes and projection those of the picture
    box = _heights(axes, corners) + 0.03
    above = _heights(axes, names) + NAME_HEIGHT
    height = float(np.concatenate([box, above]).max())
    axes.text2D(0.5, height, title, transform=axes.transAxes, ha="center", fontsize="large")


NAME_HEIGHT = 0.06
"""Height of a name with some space above it, in axes coordinates."""


def _heights(axes: Any, points: Matrix) -> Vector:
    """Return the heights of points (n, 3) above the lower edge of the axes, over their height."""
    _, height, _ = proj3d.proj_transform(*points.T, axes.get_proj())
    drawn = axes.transData.transform(np.stack([np.zeros(len(points)), height], axis=-1))
    return np.asarray(axes.transAxes.inverted().transform(drawn)[:, 1])


def name_axes(axes: Any, length: str) -> None:
    """Label the three axes."""
    axes.set_xlabel(f"x [{length}]", labelpad=30)
    axes.set_ylabel(f"y [{length}]")
    axes.set_zlabel(f"z [{length}]")


def plot_bolt_axis(axes: Any, ends: Matrix, name: str) -> Any:
    """Draw the axis of a bolt, a little longer than between its ends."""
    middle, half = ends.mean(axis=0), (ends[1] - ends[0]) / 2
    line = np.stack([middle - 1.6 * half, middle + 1.6 * half])
    axes.plot(*line.T, color=BOLT_COLOUR, lw=1.6, ls="-.", zorder=5)
    axes.plot(*ends.T, "o", color=BOLT_COLOUR, ms=4, zorder=5)
    axes.text(*line[1], plain(f" {name}"), color=BOLT_COLOUR, zorder=6)
    return axes


BOUNDARY_COLOUR = "#0072B2"
SUPPORT_COLOUR = "0.25"
LABEL_BOX = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0}


class Pictured(Protocol):
    """The parts of a model that pictures show."""

    @property
    def name(self) -> str:
        """Name of the model."""

    @property
    def units(self) -> str:
        """Label of the consistent unit set."""

    @property
    def assembly(self) -> Assembly:
        """Bodies, beams and supports."""

    @property
    def interfaces(self) -> Mapping[str, Interface]:
        """Interfaces whose edges are drawn."""

    @property
    def bolts(self) -> Mapping[str, Bolt]:
        """Bolts to name in the legend."""

    @property
    def boundaries(self) -> Mapping[str, Boundary]:
        """Boundaries for loads."""


def plot_model(
    model: Pictured, axes: Any = None, *, bolts: Mapping[str, Matrix | None] | None = None
) -> Any:
    """Draw a model on 3D axes: bodies, interface edges, bolts, boundaries and supports.

    Bolts are drawn between their ends (2, 3), where these are known.
    """
    axes = new_axes(projection="3d", size=(9.0, 5.5)) if axes is None else axes
    assembly = model.assembly
    mesh = assembly.mesh
    plot_bodies(mesh.nodes, mesh.blocks, mesh.bodies, axes)
    name_axes(axes, units_of(model.units).length)
    beams = mesh.nodes[np.array([beam.nodes for beam in assembly.beams], dtype=int).reshape(-1, 2)]
    add_lines(axes, beams, color=BOLT_COLOUR, lw=2.0, zorder=5)
    for name, ends in (bolts or {}).items():
        if ends is not None:
            plot_bolt_axis(axes, ends, name)
    for name, interface in model.interfaces.items():
        edges = outline_of([(faces.kind, faces.minus) for faces in interface.faces], mesh.nodes)
        add_lines(axes, edges, color=INTERFACE_COLOUR, lw=1.4, zorder=4)
        if len(edges):
            anchor = _rightmost(edges.reshape(-1, 3))
            axes.text(*anchor, plain(f" {name}"), va="center", zorder=7, bbox=LABEL_BOX)
    for name, boundary in model.boundaries.items():
        points = mesh.nodes[mesh.node_index(np.unique(boundary.nodes))]
        axes.plot(*points.T, "D", color=BOUNDARY_COLOUR, ms=5, zorder=9)
        label = {"color": BOUNDARY_COLOUR, "zorder": 8, "bbox": LABEL_BOX}
        axes.text(*points.mean(axis=0), plain(f"  {name}"), **label)
    for support in assembly.supports:
        axes.plot(*mesh.nodes[support.nodes].T, ".", color=SUPPORT_COLOUR, ms=4, zorder=4)
    _add_legend(model, axes)
    title = f"{model.name}: {len(mesh.nodes)} nodes, {mesh.n_elements} solids"
    title_above(axes, heading(title))
    return axes


def _rightmost(points: Matrix) -> Vector:
    """Return the point farthest to the right in the picture."""
    azimuth = np.radians(VIEW["azim"])
    return np.asarray(points[int((points[:, :2] @ [-np.sin(azimuth), np.cos(azimuth)]).argmax())])


def _add_legend(model: Pictured, axes: Any) -> None:
    """Add a legend of colours and marks."""
    names = body_names(model.assembly.mesh)
    shown = names[:MOST_SHOWN]
    handles: list[Any] = [
        Patch(facecolor=BODY_COLOURS[number % len(BODY_COLOURS)], label=plain(name))
        for number, name in enumerate(shown)
    ]
    if len(names) > len(shown):
        handles.append(Patch(facecolor="none", label=f"{len(names) - len(shown)} more bodies"))
    marks = {
        "interface edges": (bool(model.interfaces), INTERFACE_COLOUR, "-"),
        "bolts and beams": (bool(model.assembly.beams or model.bolts), BOLT_COLOUR, "-"),
        "boundaries": (bool(model.boundaries), BOUNDARY_COLOUR, "D"),
        "supports": (bool(model.assembly.supports), SUPPORT_COLOUR, "."),
    }
    for label, (present, colour, mark) in marks.items():
        if present:
            style = {"ls": mark} if mark == "-" else {"ls": "", "marker": mark, "ms": 5}
            handles.append(Line2D([], [], color=colour, label=label, **style))
    axes.legend(handles=handles, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def add_lines(axes: Any, lines: Matrix, **style: Any) -> None:
    """Draw lines (n, 2, 3); matplotlib refuses to draw none."""
    if len(lines):
        axes.add_collection3d(Line3DCollection(lines, **style))
