"""Three- and four-node shells: discrete Kirchhoff-Mindlin bending, membrane, weak drilling.

Bending is DKMT and DKMQ: rotations with one tangential bubble a side, which the shear law of the
side eliminates; with rigid shear they are Kirchhoff's DKT and DKQ. I. Katili, "A new discrete
Kirchhoff-Mindlin element based on Mindlin-Reissner plate theory and assumed shear strain fields",
Parts I and II, Int. J. Numer. Meth. Eng. 36 (1993) 1859-1883, 1885-1908.

The membrane is linear; quadrilaterals have the incompatible modes of R. L. Taylor, P. J. Beresford,
E. L. Wilson (Int. J. Numer. Meth. Eng. 10 (1976) 1211-1219), as the brick has. Rotations about the
normal follow those of the membrane by a stiffness of 1e-4 of its shear: T. J. R. Hughes,
F. Brezzi, "On drilling degrees of freedom", Comput. Meth. Appl. Mech. Eng. 72 (1989) 105-121, with
a factor so small that it only supports the rotation. Warped quadrilaterals are flat and joined to
their nodes by rigid arms.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Matrix, Vector
from faying.model.elements.shell_frames import ElementLaws

DRILLING = 1e-4
"""Stiffness of the rotation about the normal over the membrane's shear stiffness (K6ROT = 100)."""

_GAUSS = 1 / np.sqrt(3.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class FlatShell(Frozen):
    """Tables for one kind of flat shells at its quadrature points.

    Attributes
    ----------
    sides
        Nodes at the ends of each side.
    weights : (n_q,)
    values, gradients : (n_q, n_node), (n_q, 2, n_node)
        Shape functions of the corners and their reference gradients.
    side_gradients : (n_q, 2, n_side)
        Gradients of the quadratic functions that are one in the middle of a side.
    side_fields : (n_q, 2, n_side)
        Covariant components of the vector fields with tangential component one over its length
        on one side and zero on the others.
    bubbles : (n_q, 2, n_mode)
        Reference gradients of the membrane's internal modes.
    centre : (1, 2, n_node)
        Gradients of the shape functions in the middle.
    """

    sides: tuple[tuple[int, int], ...]
    weights: Vector
    values: Matrix
    gradients: Matrix
    side_gradients: Matrix
    side_fields: Matrix
    bubbles: Matrix
    centre: Matrix


def _triangle() -> FlatShell:
    # Mid-sides integrate degree two: linear curvatures and shear strains.
    x, y = np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]]).T
    zero, ones = np.zeros(3), np.ones(3)
    gradients = np.tile([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]], (3, 1, 1))
    side_x = [4 * (1 - 2 * x - y), 4 * y, -4 * y]
    side_y = [-4 * x, 4 * x, 4 * (1 - x - 2 * y)]
    field_x, field_y = [ones - y, -y, -y], [x, x, x - 1]
    return FlatShell(
        sides=((0, 1), (1, 2), (2, 0)),
        weights=np.full(3, 1 / 6),
        values=np.stack([1 - x - y, x, y], axis=1),
        gradients=gradients,
        side_gradients=np.stack([np.stack(side_x, 1), np.stack(side_y, 1)], axis=1),
        side_fields=np.stack([np.stack(field_x, 1), np.stack(field_y, 1)], axis=1),
        bubbles=np.zeros((3, 2, 0)) + zero[:, None, None],
        centre=gradients[:1],
    )


def _quadrilateral() -> FlatShell:
    corner = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    points = _GAUSS * corner
    x, y = points.T
    zero = np.zeros(4)
    side_x = [-x * (1 - y), (1 - y**2) / 2, -x * (1 + y), -(1 - y**2) / 2]
    side_y = [-(1 - x**2) / 2, -y * (1 + x), (1 - x**2) / 2, -y * (1 - x)]
    field_x, field_y = (
        [(1 - y) / 4, zero, -(1 + y) / 4, zero],
        [zero, (1 + x) / 4, zero, (x - 1) / 4],
    )
    return FlatShell(
        sides=((0, 1), (1, 2), (2, 3), (3, 0)),
        weights=np.ones(4),
        values=(1 + points @ corner.T + np.outer(x * y, corner[:, 0] * corner[:, 1])) / 4,
        gradients=_bilinear_gradients(points, corner),
        side_gradients=np.stack([np.stack(side_x, 1), np.stack(side_y, 1)], axis=1),
        side_fields=np.stack([np.stack(field_x, 1), np.stack(field_y, 1)], axis=1),
        bubbles=-2 * points[:, :, None] * np.eye(2),
        centre=_bilinear_gradients(np.zeros((1, 2)), corner),
    )


def _bilinear_gradients(points: Matrix, corner: Matrix) -> Matrix:
    a, b = corner.T
    x, y = points[:, :1], points[:, 1:]
    return np.stack([a * (1 + y * b) / 4, b * (1 + x * a) / 4], axis=1)


FLAT_SHELLS = {"tri3": _triangle(), "quad4": _quadrilateral()}


def flat_matrices(kind: str, xy: Matrix, laws: ElementLaws) -> tuple[Matrix, Matrix]:
    """Return mass and stiffness (n, 6 n_node, 6 n_node) of flat shells in their local frames.

    Corners (n, n_node, 2) [length] and laws are in the axes of each element, degrees of freedom of
    a node in the order (u, v, w, θx, θy, θz).

    Notes
    -----
    A rotation about y moves points above the surface along x: βx = θy, βy = -θx.
    """
    table = FLAT_SHELLS[kind]
    n, n_node = xy.shape[:2]
    n_dof = 6 * n_node
    jacobian = np.einsum("qai,eic->eqac", table.gradients, xy)
    area = table.weights * np.linalg.det(jacobian)
    inverse = np.linalg.inv(jacobian)
    gradient = inverse @ table.gradients
    sides, shears = _sides(table, xy, laws)
    strains = np.concatenate(
        [_strains(table, gradient, inverse, sides), _bubble_strains(table, xy, area)], axis=3
    )
    stiffness = _condense(integrated(strains, laws.stiffness[:, None], area), n_dof)
    sheared = inverse @ (table.side_fields @ shears[:, None])
    stiffness += integrated(sheared, laws.shear[:, None], area)
    drilling = DRILLING * laws.stiffness[:, None, 2:3, 2:3]
    stiffness += integrated(_drilling(table, gradient), drilling, area)
    products = np.einsum("eq,qi,qj->eij", area, table.values, table.values)
    moved = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    turned = np.diag([0.0, 0.0, 0.0, 1.0, 1.0, 0.0])
    weights = laws.mass[:, None, None] * moved + laws.inertia[:, None, None] * turned
    mass = np.einsum("eij,eab->eiajb", products, weights).reshape(n, n_dof, n_dof)
    return mass, 0.5 * (stiffness + stiffness.swapaxes(1, 2))


def integrated(strains: Matrix, law: Matrix, area: Matrix) -> Matrix:
    """Return ∫ Bᵀ C B dA for strains (n, n_q, k, n_dof) and laws (n, 1 or n_q, k, k)."""
    weighted = (law @ strains) * area[:, :, None, None]
    flat = (len(strains), -1, strains.shape[3])
    return np.asarray(strains.reshape(flat).swapaxes(1, 2) @ weighted.reshape(flat))


def _condense(stiffness: Matrix, n_dof: int) -> Matrix:
    """Return the stiffness with all but the first degrees of freedom eliminated."""
    if stiffness.shape[1] == n_dof:
        return stiffness
    coupling = stiffness[:, n_dof:, :n_dof]
    follow = np.linalg.solve(stiffness[:, n_dof:, n_dof:], coupling)
    return np.asarray(stiffness[:, :n_dof, :n_dof] - coupling.swapaxes(1, 2) @ follow)


def _sides(table: FlatShell, xy: Matrix, laws: ElementLaws) -> tuple[Matrix, Matrix]:
    """Return tangential bubbles, and length times shear strain of the sides, per degree of freedom.

    On a side the shear strain is that of the moments' slope, -(2/3) φ times the bubble, and its
    integral that of the motion: w_j - w_i + L (β_i + β_j) / 2 + 2/3 L bubble = L strain (Katili,
    Eqs. 23 to 29 of Part I); φ = 12 D / (S L²) along the side. Bubbles (n, 2, n_side, n_dof) are
    vectors along the sides, shears (n, n_side, n_dof).
    """
    n, n_node = xy.shape[:2]
    first, second = np.array(table.sides).T
    along = xy[:, second] - xy[:, first]
    length = np.linalg.norm(along, axis=2)
    c, s = np.moveaxis(along / length[..., None], 2, 0)
    curvature = np.stack([c * c, s * s, 2 * c * s], axis=2)
    bending = np.einsum("esa,eab,esb->es", curvature, laws.stiffness[:, 3:, 3:], curvature)
    tangent = np.stack([c, s], axis=2)
    shear = np.einsum("esa,eab,esb->es", tangent, laws.shear, tangent)
    rigid = laws.rigid[:, None]
    phi = np.where(rigid, 0.0, 12 * bending / (np.where(rigid, 1.0, shear) * length**2))
    motion = np.zeros((n, len(first), n_node, 6))
    for side, (i, j) in enumerate(table.sides):
        half = length[:, side] / 2
        motion[:, side, i, 2], motion[:, side, j, 2] = -1.0, 1.0
        for end in (i, j):
            motion[:, side, end, 3] = -half * s[:, side]
            motion[:, side, end, 4] = half * c[:, side]
    flat = motion.reshape(n, len(first), -1)
    size = -1.5 / (length * (1 + phi))
    bubble = size[..., None] * flat
    shears = (-2 / 3 * phi * length)[..., None] * bubble
    return np.einsum("esa,esd->easd", tangent, bubble), shears


def _strains(table: FlatShell, gradient: Matrix, inverse: Matrix, sides: Matrix) -> Matrix:
    """Return membrane strains and curvatures (n, n_q, 6, n_dof)."""
    n, n_q, _, n_node = gradient.shape
    dx, dy = gradient[:, :, 0], gradient[:, :, 1]
    parts = np.zeros((n, n_q, 6, n_node, 6))
    parts[:, :, 0, :, 0] = parts[:, :, 2, :, 1] = dx
    parts[:, :, 1, :, 1] = parts[:, :, 2, :, 0] = dy
    parts[:, :, 3, :, 4], parts[:, :, 5, :, 3] = dx, -dx
    parts[:, :, 4, :, 3], parts[:, :, 5, :, 4] = -dy, dy
    strains = parts.reshape(n, n_q, 6, -1)
    slope = inverse @ table.side_gradients
    x, y = sides[:, None, 0], sides[:, None, 1]
    strains[:, :, 3] += np.squeeze(slope[:, :, None, 0] @ x, 2)
    strains[:, :, 4] += np.squeeze(slope[:, :, None, 1] @ y, 2)
    strains[:, :, 5] += np.squeeze(slope[:, :, None, 1] @ x + slope[:, :, None, 0] @ y, 2)
    return strains


def _bubble_strains(table: FlatShell, xy: Matrix, area: Matrix) -> Matrix:
    """Return membrane strains (n, n_q, 6, 2 n_mode) of internal modes, with zero mean."""
    n_mode = table.bubbles.shape[2]
    jacobian = np.einsum("qai,eic->eqac", table.centre, xy)
    size = np.linalg.det(jacobian) * table.weights
    gradient = (size / area)[..., None, None] * (np.linalg.inv(jacobian) @ table.bubbles)
    strains = np.zeros((*area.shape, 6, 2, n_mode))
    strains[:, :, 0, 0] = strains[:, :, 2, 1] = gradient[:, :, 0]
    strains[:, :, 1, 1] = strains[:, :, 2, 0] = gradient[:, :, 1]
    return strains.reshape(*area.shape, 6, -1)


def _drilling(table: FlatShell, gradient: Matrix) -> Matrix:
    """Return the nodes' rotation about the normal minus that of the membrane (n, n_q, 1, n_dof)."""
    n, n_q, _, n_node = gradient.shape
    rows = np.zeros((n, n_q, 1, n_node, 6))
    rows[:, :, 0, :, 5] = table.values
    rows[:, :, 0, :, 0] = gradient[:, :, 1] / 2
    rows[:, :, 0, :, 1] = -gradient[:, :, 0] / 2
    return rows.reshape(n, n_q, 1, -1)
