"""Segments: the overlaps of the facets of two non-matching meshes.

Each pair of touching facets is projected onto the plane of the minus facet and clipped there
(M. A. Puso, T. A. Laursen, A mortar segment-to-segment contact method for large deformation solid
mechanics, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629). That plane is fixed here, because
displacements are small.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.digits import DECK_DIGITS, SOLVED
from faying.interface.cells import Cells, divided
from faying.interface.clipping import areas, clip, fans
from faying.interface.hidden_facets import Reach, facing_cells, hidden
from faying.interface.mismatch import LARGEST_COSINE
from faying.model.surface import Facets, facet_area_vectors, facet_centres, facet_frames

COVERED_SHARE = 1 - 1e-5
"""Covered share of a minus facet that counts as whole, within round-off of coordinates."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Segments(Frozen):
    """Triangles on which a minus and a plus facet overlap.

    Attributes
    ----------
    minus, plus
        Facets of the two sides that touch.
    origins : (n_minus, 3) [length]
    frames : (n_minus, 3, 3)
        Two tangents and the normal of the plane of each minus facet, as rows.
    triangles : (n_triangle, 3, 2) [length]
        Corners in the plane of their minus facet, counter-clockwise.
    minus_of, plus_of : (n_triangle,)
        Facets of a triangle.
    covered : (n_minus,)
        Share of each minus facet that the plus side covers, in its plane.
    """

    minus: Facets
    plus: Facets
    origins: Matrix
    frames: Matrix
    triangles: Matrix
    minus_of: Indices
    plus_of: Indices
    covered: Vector

    def __len__(self) -> int:
        """Return the number of triangles."""
        return len(self.triangles)

    @property
    def whole(self) -> Mask:
        """Whether each minus facet (n_minus,) is wholly covered."""
        return self.covered >= COVERED_SHARE

    @property
    def areas(self) -> Vector:
        """Areas (n_triangle,) in the plane of the minus facets."""
        return areas(self.triangles, np.full(len(self), 3))

    @property
    def partial(self) -> Matrix:
        """Corners in space (n, 3, 3) of the triangles on partly covered facets."""
        chosen = ~self.whole[self.minus_of]
        minus_rows = self.minus_of[chosen]
        flat = np.einsum("nia,nad->nid", self.triangles[chosen], self.frames[minus_rows, :2])
        return np.asarray(self.origins[minus_rows][:, None] + flat)

    def touched(self, chosen: Mask) -> "Segments":
        """Return the chosen triangles (n_triangle,) with their facets alone."""
        minus, minus_of = np.unique(self.minus_of[chosen], return_inverse=True)
        plus, plus_of = np.unique(self.plus_of[chosen], return_inverse=True)
        share = np.zeros(len(self.minus))
        np.add.at(share, self.minus_of, np.where(chosen, self.areas, 0.0))
        whole = np.zeros(len(self.minus))
        np.add.at(whole, self.minus_of, self.areas)
        return Segments(
            minus=self.minus.taken(minus),
            plus=self.plus.taken(plus),
            origins=self.origins[minus],
            frames=self.frames[minus],
            triangles=self.triangles[chosen],
            minus_of=minus_of,
            plus_of=plus_of,
            covered=self.covered[minus] * share[minus] / whole[minus],
        )


def find_segments(
    nodes: Matrix, minus: Facets, plus: Facets, tolerance: float, reach: Reach | None = None
) -> Segments:
    """Return the overlaps of the facets of two sides, clipped against each other.

    Nodes are (n_node, 3) [length]; quadratic facets are divided into four linear cells. The
    tolerance [length] is the largest distance between the two surfaces along the normal of the
    minus facet; on curved surfaces the heights of the arcs over both facets are added. A reach is
    for declared contact surfaces: facets that face each other are then paired across gaps, the
    nearest ones where several lie behind each other.

    Notes
    -----
    A k-d tree finds facets that may touch, all pairs are clipped at once. Time and memory are
    proportional to the number of pairs whose boxes overlap.
    """
    centres = facet_centres(nodes, minus)
    frames = facet_frames(nodes, minus)
    below, above = divided(nodes, minus), divided(nodes, plus)
    if reach is None:
        lower_cell, upper_cell = _overlapping_boxes(below, above, tolerance)
    else:
        lower_cell, upper_cell = facing_cells(below, above, reach)
    first, second = below.parents[lower_cell], above.parents[upper_cell]
    flat_corners = _in_planes(below.corners, centres[below.parents], frames[below.parents])
    size = areas(flat_corners, np.full(len(flat_corners), 4))
    full = np.bincount(below.parents, size, len(minus))
    # The plus side is seen from inside: reversed, its corners run counter-clockwise too.
    window = _turned_round(
        _in_planes(above.corners[upper_cell], centres[first], frames[first]),
        above.facets.triangular[upper_cell],
    )
    polygons, counts = clip(flat_corners[lower_cell], window)
    common = areas(polygons, counts)
    smaller = np.minimum(size[lower_cell], np.abs(areas(window, np.full(len(window), 4))))
    common_enough = common > SOLVED * smaller
    middle = polygons.sum(axis=1) / np.maximum(counts, 1)[:, None]
    points = centres[first] + np.einsum("na,nad->nd", middle, frames[first, :2])
    height = _distance_between(points, frames[first, 2], below, lower_cell, above, upper_cell)
    slack = below.arcs[lower_cell] + above.arcs[upper_cell] + 1e-9 * np.sqrt(size[lower_cell])
    if reach is None:
        common_enough &= np.abs(height) <= tolerance + slack
    else:
        deepest = np.minimum(reach.minus[first], reach.plus[second])
        common_enough &= (height <= reach.gap + slack) & (height >= -deepest - slack)
        rows = np.flatnonzero(common_enough)
        facets = first[rows], second[rows]
        seen = polygons[rows], counts[rows], np.abs(height[rows])
        lifted = _lift(seen[0], centres[facets[0]], frames[facets[0]], above, upper_cell[rows])
        common_enough[rows] = ~_hidden_polygons(nodes, (minus, plus), facets, seen, lifted)
    covered = np.bincount(first[common_enough], common[common_enough], len(minus)) / full
    common_enough &= covered[first] >= DECK_DIGITS
    triangles, owners = fans(polygons[common_enough], counts[common_enough])
    segments = Segments(
        minus=minus,
        plus=plus,
        origins=centres,
        frames=frames,
        triangles=triangles,
        minus_of=first[common_enough][owners],
        plus_of=second[common_enough][owners],
        covered=covered,
    )
    return segments.touched(segments.areas > SOLVED * full[segments.minus_of])


def _hidden_polygons(
    nodes: Matrix,
    sides: tuple[Facets, Facets],
    rows: tuple[Indices, Indices],
    polygons: tuple[Matrix, Indices, Vector],
    lifted: Matrix,
) -> Mask:
    """Return the polygons behind a nearer one, seen from their minus or their plus facet.

    Rows are the minus and plus facet of each polygon. Polygons are corners in the plane of the
    minus facet, their numbers, and the distance of both facets; ``lifted`` are the same corners on
    the plus facet (n, n_corner, 3) [length].
    """
    flat, counts, distances = polygons
    plus = sides[1]
    above = _in_planes(
        lifted, facet_centres(nodes, plus)[rows[1]], facet_frames(nodes, plus)[rows[1]]
    )
    above[np.arange(above.shape[1]) >= counts[:, None]] = 0.0
    behind = np.zeros(len(counts), dtype=bool)
    for facets, owner, corners in zip(sides, rows, (flat, above), strict=True):
        size = np.sqrt(np.linalg.norm(facet_area_vectors(nodes, facets), axis=1))
        behind |= hidden(corners, counts, owner, distances, size[owner])
    return behind


def _in_planes(points: Matrix, origins: Matrix, frames: Matrix) -> Matrix:
    """Return points (n, k, 3) projected onto the planes of n facets (n, k, 2)."""
    return np.asarray(np.einsum("nkd,nad->nka", points - origins[:, None], frames[:, :2]))


def _turned_round(corners: Matrix, triangular: Mask) -> Matrix:
    """Return the corners of facets (n, 4, 2) in reverse; triangles still repeat their last one."""
    square, triangle = [3, 2, 1, 0], [2, 1, 0, 0]
    return np.where(triangular[:, None, None], corners[:, triangle], corners[:, square])


def _lift(
    polygons: Matrix, origins: Matrix, frames: Matrix, above: Cells, upper_cells: Indices
) -> Matrix:
    """Return polygons (n, n_corner, 2) moved along minus normals onto the planes of plus cells."""
    points = origins[:, None] + np.einsum("nca,nad->ncd", polygons, frames[:, :2])
    upwards, normals = frames[:, 2], above.normals[upper_cells]
    offset = np.einsum("ncd,nd->nc", above.centres[upper_cells][:, None] - points, normals)
    height = offset / np.einsum("nd,nd->n", upwards, normals)[:, None]
    return np.asarray(points + height[..., None] * upwards[:, None])


def _distance_between(
    points: Matrix,
    upwards: Matrix,
    below: Cells,
    lower_cells: Indices,
    above: Cells,
    upper_cells: Indices,
) -> Vector:
    """Return distances (n,) between the planes of two cells at points (n, 3), along directions."""
    heights = []
    for cells, rows in ((below, lower_cells), (above, upper_cells)):
        normals = cells.normals[rows]
        offset = np.einsum("nd,nd->n", cells.centres[rows] - points, normals)
        heights.append(offset / np.einsum("nd,nd->n", upwards, normals))
    return np.asarray(heights[1] - heights[0])


def _overlapping_boxes(below: Cells, above: Cells, tolerance: float) -> tuple[Indices, Indices]:
    """Return the pairs of cells that face each other and whose boxes overlap."""
    boxes = []
    for cells in (below, above):
        corners, reach = cells.corners, cells.arcs[:, None] + tolerance
        boxes.append((corners.min(axis=1) - reach, corners.max(axis=1) + reach))
    (low, high), (from_, to) = boxes
    normals = below.normals, above.normals
    pairs = [np.empty((0, 2), dtype=np.int64)]
    for lower_cells, upper_cells in _by_distance(*boxes):
        close = (
            np.einsum("nd,nd->n", normals[0][lower_cells], normals[1][upper_cells]) < LARGEST_COSINE
        )
        close &= (low[lower_cells] <= to[upper_cells]).all(axis=1) & (
            from_[upper_cells] <= high[lower_cells]
        ).all(axis=1)
        pairs.append(np.column_stack([lower_cells[close], upper_cells[close]]))
    ordered = np.concatenate(pairs)
    ordered = ordered[np.lexsort(ordered.T[::-1])]
    return ordered[:, 0], ordered[:, 1]


def _by_distance(
    minus: tuple[Matrix, Matrix], plus: tuple[Matrix, Matrix]
) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of boxes that may overlap, for plus boxes of one size (by powers of two) each.

    Otherwise all facets of a graded mesh would be neighbours of its largest one.
    """
    centres = [(low + high) / 2 for low, high in (minus, plus)]
    radii = [np.linalg.norm(high - low, axis=1) / 2 for low, high in (minus, plus)]
    size = np.floor(np.log2(np.maximum(radii[1], np.finfo(float).tiny))).astype(int)
    for one_size in np.unique(size):
        members = np.flatnonzero(size == one_size)
        reach = radii[0] + radii[1][members].max()
        neighbours = cKDTree(centres[1][members]).query_ball_point(centres[0], reach)
        counts = np.fromiter(map(len, neighbours), np.int64, len(neighbours))
        if counts.any():
            others = np.concatenate([np.asarray(part, dtype=np.int64) for part in neighbours])
            yield np.repeat(np.arange(len(counts)), counts), members[others]
