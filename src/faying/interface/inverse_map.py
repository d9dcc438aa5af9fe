"""Reference coordinates of points in the plane of a facet."""

from collections.abc import Callable

import numpy as np

from faying._typing import Matrix
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import ModelError
from faying.interface.facets import shape_functions, shape_gradients
from faying.iterations import MOST_STEPS
from faying.model.elements import FACES

_Position = Callable[[Matrix], tuple[Matrix, Matrix]]


def reference_coordinates(kind: str, nodes: Matrix, points: Matrix) -> Matrix:
    """Return reference coordinates on facets of points (n, n_q, 2) in a common projection.

    The kind is a name of a :class:`~faying.model.elements.face_kind.FaceKind`. Nodes (n,
    n_node_per_face, 2) and points [length] are projected onto a plane. Near a curved side reference
    coordinates (n, n_q, 2) may lie a little outside the reference facet.

    Notes
    -----
    Newton's method on all points at once, from the affine map at the centre.
    """
    corner = [nodes[:, i] for i in range(FACES[kind].n_corners)]
    if len(corner) == 3:
        origin, centre = corner[0], 0.0
        sides = [corner[1] - corner[0], corner[2] - corner[0]]
    else:
        # At the centre, because a corner may have collapsed.
        origin, centre = nodes[:, :4].mean(axis=1), 0.5
        sides = [corner[1] + corner[2] - corner[0] - corner[3]]
        sides = [side / 2 for side in (*sides, corner[2] + corner[3] - corner[0] - corner[1])]
    affine = np.linalg.inv(np.stack(sides, axis=-1))
    first = centre + (points - origin[:, None]) @ affine.transpose(0, 2, 1)
    if kind == "tri3":
        return np.asarray(first)
    position = _evaluate_quad4(nodes) if kind == "quad4" else _evaluate(kind, nodes)
    # Components are the first axis, which is faster.
    targets, coordinates = (np.ascontiguousarray(np.moveaxis(a, 2, 0)) for a in (points, first))
    for _ in range(MOST_STEPS):
        reached, tangents = position(coordinates)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = _solve_pairs(tangents, targets - reached)
        coordinates = coordinates + step
        if not np.isfinite(coordinates).all():
            break
        if np.abs(step).max(initial=0.0) < ROUND_OFF:
            return np.moveaxis(coordinates, 0, 2)
    if np.isfinite(coordinates).all() and np.abs(step).max() < SOLVED:
        return np.moveaxis(coordinates, 0, 2)
    row = int(np.nan_to_num(np.abs(step), nan=np.inf).max(axis=(0, 2)).argmax())
    message = (
        f"a {kind} facet of {np.ptp(nodes[row], axis=0).max():g} in size folds over itself where "
        "the other side lies on it; repair the mesh there"
    )
    raise ModelError(message)


def _evaluate(kind: str, nodes: Matrix) -> _Position:
    """Return positions (2, n, n_q) and tangents (2, 2, n, n_q) at coordinates (2, n, n_q)."""

    def position(coordinates: Matrix) -> tuple[Matrix, Matrix]:
        flat = np.moveaxis(coordinates, 0, 2).reshape(-1, 2)
        shape = shape_functions(kind, flat).reshape(*coordinates.shape[1:], -1)
        gradients = shape_gradients(kind, flat).reshape(*coordinates.shape[1:], -1, 2)
        tangents = np.stack([gradients[..., i] @ nodes for i in range(2)])
        return np.moveaxis(shape @ nodes, 2, 0), np.moveaxis(tangents, 3, 0)

    return position


def _evaluate_quad4(nodes: Matrix) -> _Position:
    """Return positions and tangents for quad4, the most frequent kind, by explicit formulas."""
    first, second, third, fourth = np.moveaxis(nodes[..., None], (1, 2), (0, 1))
    along, across = second - first, fourth - first
    twist = first - second + third - fourth

    def position(coordinates: Matrix) -> tuple[Matrix, Matrix]:
        xi, eta = coordinates
        right, up = along + twist * eta, across + twist * xi
        return first + right * xi + across * eta, np.stack([right, up], axis=1)

    return position


def _solve_pairs(tangents: Matrix, right: Matrix) -> Matrix:
    """Solve 2 × 2 systems (2, 2, n, n_q) by Cramer's rule."""
    (a, b), (c, d) = tangents
    x, y = right
    return np.asarray(np.stack([d * x - b * y, a * y - c * x]) / (a * d - b * c))
