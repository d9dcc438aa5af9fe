"""Six- and eight-node shells: degenerated solids that do not lock.

Displacements u + z θ × d with a director d at each node, the normal of the element there; strains
to first order in z. Membrane and bending are integrated at two points per direction (three on
triangles): O. C. Zienkiewicz, R. L. Taylor, J. M. Too, "Reduced integration technique in general
analysis of plates and shells", Int. J. Numer. Meth. Eng. 3 (1971) 275-290. A thousandth of the full
rule stabilizes the zero-energy modes of two points, which neighbours cannot share. Transverse
shear strains are interpolated between samples along the sides: K. J. Bathe, E. N. Dvorkin, "A
formulation of general shell elements - the use of mixed interpolation of tensorial components",
Int. J. Numer. Meth. Eng. 22 (1986) 697-722 (MITC8); for triangles the linear fields of F. Brezzi,
K. J. Bathe, M. Fortin, "Mixed-interpolated elements for Reissner-Mindlin plates", Int. J. Numer.
Meth. Eng. 28 (1989) 1787-1801. Drilling is that of flat shells.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Frozen, Matrix, Vector
from faying.model.couplings.rows import lever_arms
from faying.model.elements.flat_shell import DRILLING, integrated
from faying.model.elements.shell_frames import ElementLaws

Functions = Callable[[Matrix], tuple[Matrix, Matrix]]
"""Points (n, 2) to values (n, n_node) and gradients (n, 2, n_node) of shape functions."""

Samples = tuple[Matrix, Matrix, Matrix]
"""Places (n, 2), directions (n, 2), and averages of samples (n_field, n)."""

FULL_RULE_SHARE = 1e-3
"""Share of the full rule in an eight-node shell, except in transverse shear."""

RIGID_SHEAR = 100.0
"""Transverse shear stiffness in place of infinity, over the membrane's shear stiffness."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rule(Frozen):
    """Shape functions at the points of a rule.

    Attributes
    ----------
    weights : (n_q,)
    values, gradients : (n_q, n_node), (n_q, 2, n_node)
    """

    weights: Vector
    values: Matrix
    gradients: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class Sampling:
    """Sampling points of covariant shear strains, and the fields between them.

    Attributes
    ----------
    values, slopes : (n_sample, n_node)
        Shape functions there and their derivatives along the direction of the sample.
    fields : (n_q, 2, n_sample)
        Covariant components at the points of the rule that integrates shear.
    """

    values: Matrix
    slopes: Matrix
    fields: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class CurvedShell:
    """Tables for one kind of curved shells.

    Attributes
    ----------
    rules
        ``"reduced"`` and ``"full"``.
    shares
        Share of each rule in membrane and bending.
    sheared
        The rule that integrates transverse shear.
    at_nodes : (n_node, 2, n_node)
        Reference gradients at the nodes.
    """

    rules: Mapping[str, Rule]
    shares: Mapping[str, float]
    sheared: str
    sampling: Sampling
    at_nodes: Matrix


def _sampling(
    shape: Functions, fields: Callable[[Matrix], Matrix], samples: Samples, points: Matrix
) -> Sampling:
    """Return the sampling of fields (n, 2, n_sample) of a space by components at samples."""
    places, directions, mixed = samples
    values, gradients = shape(places)
    components = mixed @ np.einsum("sa,sak->sk", directions, fields(places))
    return Sampling(
        values=values,
        slopes=np.einsum("sa,san->sn", directions, gradients),
        fields=fields(points) @ np.linalg.solve(components, mixed),
    )


def _serendipity(points: Matrix) -> tuple[Matrix, Matrix]:
    """Return eight-node functions on [-1, 1]²: values (n, 8) and gradients (n, 2, 8)."""
    x, y = points[:, :1], points[:, 1:]
    a, b = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]])
    corner = (1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4
    corner_x = a * (1 + b * y) * (2 * a * x + b * y) / 4
    corner_y = b * (1 + a * x) * (a * x + 2 * b * y) / 4
    bottom, right, top, left = (
        ((1 - x**2) * (1 - y) / 2, -x * (1 - y), -(1 - x**2) / 2),
        ((1 + x) * (1 - y**2) / 2, (1 - y**2) / 2, -y * (1 + x)),
        ((1 - x**2) * (1 + y) / 2, -x * (1 + y), (1 - x**2) / 2),
        ((1 - x) * (1 - y**2) / 2, -(1 - y**2) / 2, -y * (1 - x)),
    )
    sides = [np.hstack(part) for part in zip(bottom, right, top, left, strict=True)]
    values, in_x, in_y = (
        np.hstack([axis, factors])
        for axis, factors in zip((corner, corner_x, corner_y), sides, strict=True)
    )
    return values, np.stack([in_x, in_y], axis=1)


def _quadratic(points: Matrix) -> tuple[Matrix, Matrix]:
    """Return six-node functions on the unit triangle: values (n, 6) and gradients (n, 2, 6)."""
    x, y = points.T
    area = np.stack([1 - x - y, x, y])
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    values = [coordinate * (2 * coordinate - 1) for coordinate in area]
    gradients = [
        np.outer(4 * coordinate - 1, slope) for coordinate, slope in zip(area, slopes, strict=True)
    ]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        values.append(4 * area[i] * area[j])
        gradients.append(4 * (np.outer(area[i], slopes[j]) + np.outer(area[j], slopes[i])))
    return np.stack(values, axis=1), np.stack(gradients, axis=2)


def _product(n: int) -> tuple[Matrix, Vector]:
    x, w = np.polynomial.legendre.leggauss(n)
    places = np.stack(np.meshgrid(x, x, indexing="ij"), axis=2).reshape(-1, 2)
    return places, np.outer(w, w).ravel()


def _quad8() -> CurvedShell:
    rules = {}
    for name, n in (("reduced", 2), ("full", 3)):
        points, weights = _product(n)
        values, gradients = _serendipity(points)
        rules[name] = Rule(weights=weights, values=values, gradients=gradients)
    nodes = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    # Two samples along each side; in the middle the mean of two.
    g = 1 / np.sqrt(3.0)
    across = [[x, y] for y in (-1, 0, 1) for x in (-g, g)]
    places = np.array([*across, *([y, x] for x, y in across)])
    directions = np.repeat(np.eye(2), 6, axis=0)
    integrand = np.zeros((5, 6))
    integrand[[0, 1, 2, 2, 3, 4], range(6)] = [1, 1, 0.5, 0.5, 1, 1]
    samples = (places, directions, np.asarray(np.kron(np.eye(2), integrand), float))
    return CurvedShell(
        rules=rules,
        shares={"reduced": 1 - FULL_RULE_SHARE, "full": FULL_RULE_SHARE},
        sheared="full",
        sampling=_sampling(_serendipity, _quadrilateral_fields, samples, _product(3)[0]),
        at_nodes=_serendipity(nodes)[1],
    )


def _quadrilateral_fields(where: Matrix) -> Matrix:
    """Return fields (n, 2, 10): 1, ξ, η, ξη, η² along ξ, and likewise along η."""
    x, y = where.T
    both = [np.ones_like(x), x, y, x * y]
    result = np.zeros((len(where), 2, 10))
    result[:, 0, :5] = np.stack([*both, y**2], axis=1)
    result[:, 1, 5:] = np.stack([*both, x**2], axis=1)
    return result


def _tri6() -> CurvedShell:
    # Six points integrate products of the shape functions (degree four): D. A. Dunavant, "High
    # degree efficient symmetrical Gaussian quadrature rules for the triangle", Int. J. Numer.
    # Meth. Eng. 21 (1985) 1129-1148; three interior ones degree two.
    a, b = 0.445948490915965, 0.091576213509771
    six = [[a, a], [1 - 2 * a, a], [a, 1 - 2 * a], [b, b], [1 - 2 * b, b], [b, 1 - 2 * b]]
    three = np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6
    rules = {}
    for name, points, weights in (
        ("reduced", three, np.full(3, 1 / 6)),
        ("full", np.array(six), np.repeat([0.223381589678011, 0.109951743655322], 3) / 2),
    ):
        values, gradients = _quadratic(points)
        rules[name] = Rule(weights=weights, values=values, gradients=gradients)
    nodes = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    sides = np.repeat(np.roll(corners, -1, axis=0) - corners, 2, axis=0)
    gauss = (1 + np.tile([-1.0, 1.0], 3) / np.sqrt(3.0)) / 2
    samples = (np.repeat(corners, 2, axis=0) + gauss[:, None] * sides, sides, np.eye(6))
    return CurvedShell(
        rules=rules,
        shares={"reduced": 1.0, "full": 0.0},
        sheared="reduced",
        sampling=_sampling(_quadratic, _triangle_fields, samples, three),
        at_nodes=_quadratic(nodes)[1],
    )


def _triangle_fields(where: Matrix) -> Matrix:
    """Return fields (n, 2, 6) with linear components."""
    linear = np.hstack([np.ones((len(where), 1)), where])
    return np.asarray(np.einsum("nk,ab->nabk", linear, np.eye(2)).reshape(len(where), 2, 6))


CURVED_SHELLS: Mapping[str, CurvedShell] = {"tri6": _tri6(), "quad8": _quad8()}


@dataclass(frozen=True, eq=False, kw_only=True)
class Points:
    """A batch of shells at the points of a rule.

    Attributes
    ----------
    frames : (n, n_q, 3, 3)
        Rows: two tangents and the normal.
    area : (n, n_q)
        Weights times Jacobian.
    gradients : (n, n_q, 2, n_node)
        Derivatives of the shape functions along the tangents.
    inverse : (n, n_q, 2, 2)
        Components along the tangents per covariant component.
    """

    frames: Matrix
    area: Matrix
    gradients: Matrix
    inverse: Matrix


def points_of(rule: Rule, coordinates: Matrix) -> Points:
    """Return tangents, normals and derivatives at the points of a rule.

    Coordinates are (n, n_node, 3) [length].
    """
    tangents = np.einsum("qan,enc->eqac", rule.gradients, coordinates)
    normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    size = np.linalg.norm(normal, axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        z = normal / size[..., None]
        x = tangents[:, :, 0] / np.linalg.norm(tangents[:, :, 0], axis=2)[..., None]
        frames = np.stack([x, np.cross(z, x), z], axis=2)
        plane = np.einsum("eqac,eqbc->eqab", tangents, frames[:, :, :2])
        determinant = plane[..., 0, 0] * plane[..., 1, 1] - plane[..., 0, 1] * plane[..., 1, 0]
        adjugate = np.stack(
            [
                np.stack([plane[..., 1, 1], -plane[..., 0, 1]], axis=-1),
                np.stack([-plane[..., 1, 0], plane[..., 0, 0]], axis=-1),
            ],
            axis=-2,
        )
        inverse = adjugate / determinant[..., None, None]
    return Points(
        frames=frames,
        area=rule.weights * size,
        gradients=inverse @ rule.gradients,
        inverse=inverse,
    )


def directors(kind: str, coordinates: Matrix) -> Matrix:
    """Return the unit normals (n, n_node, 3) at the nodes; NaN where there is none."""
    tangents = np.einsum("man,enc->emac", CURVED_SHELLS[kind].at_nodes, coordinates)
    normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    size = np.linalg.norm(normal, axis=2, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(normal / size)


def without_shear_strains(laws: ElementLaws) -> ElementLaws:
    """Return laws with shells rigid in transverse shear made nearly rigid by a penalty."""
    bent = laws.stiffness[:, 3:, 3:].any(axis=(1, 2))
    penalty = np.where(laws.rigid & bent, RIGID_SHEAR * laws.stiffness[:, 2, 2], 0.0)
    return replace(laws, shear=laws.shear + penalty[:, None, None] * np.eye(2))


def curved_matrices(
    kind: str,
    coordinates: Matrix,
    director: Matrix,
    tables: Mapping[str, tuple[Points, ElementLaws]],
) -> tuple[Matrix, Matrix]:
    """Return mass and stiffness (n, 6 n_node, 6 n_node) of curved shells in basic directions.

    Coordinates and director are (n, n_node, 3). Tables ``"reduced"`` and ``"full"`` have the points
    of each rule, and laws in their frames (n · n_q, ...).
    """
    shell = CURVED_SHELLS[kind]
    n, n_node = director.shape[:2]
    # Motion of a director by the rotation of its node, θ × d.
    turning = lever_arms(director.reshape(-1, 3)).reshape(n, n_node, 3, 3)
    stiffness = np.zeros((n, 6 * n_node, 6 * n_node))
    for name, rule in shell.rules.items():
        points, laws = tables[name]
        strains, drilling = _strains(rule, points, director, turning)
        at_points = points.area.shape
        law = laws.stiffness.reshape(*at_points, 6, 6)
        stiffness += integrated(strains, shell.shares[name] * law, points.area)
        if name == shell.sheared:
            shear = points.inverse @ _sampled(shell.sampling, coordinates, director, turning)
            stiffness += integrated(shear, laws.shear.reshape(*at_points, 2, 2), points.area)
        if name == "full":
            stiffness += integrated(drilling, DRILLING * law[..., 2:3, 2:3], points.area)
    points, laws = tables["full"]
    values = shell.rules["full"].values
    products = np.einsum("eq,qi,qj->eqij", points.area, values, values)
    mass = np.zeros((n, n_node, 6, n_node, 6))
    moved = np.einsum("eq,eqij->eij", laws.mass.reshape(points.area.shape), products)
    turned = np.einsum("eq,eqij->eij", laws.inertia.reshape(points.area.shape), products)
    mass[:, :, :3, :, :3] = np.einsum("eij,ab->eiajb", moved, np.eye(3))
    mass[:, :, 3:, :, 3:] = np.einsum("eij,eica,ejcb->eiajb", turned, turning, turning)
    size = 6 * n_node
    return mass.reshape(n, size, size), 0.5 * (stiffness + stiffness.swapaxes(1, 2))


def _sampled(sampling: Sampling, coordinates: Matrix, director: Matrix, turning: Matrix) -> Matrix:
    """Return covariant shear strains (n, n_q, 2, 6 n_node) between samples along the sides."""
    along = np.einsum("sn,enc->esc", sampling.slopes, coordinates)
    d = np.einsum("sn,enc->esc", sampling.values, director)
    rows = np.zeros((*along.shape[:2], coordinates.shape[1], 6))
    rows[..., :3] = sampling.slopes[..., None] * d[:, :, None]
    rows[..., 3:] = sampling.values[..., None] * np.einsum("esa,eiac->esic", along, turning)
    flat = rows.reshape(*along.shape[:2], -1)
    return np.asarray(sampling.fields @ flat[:, None])


def _strains(
    rule: Rule, points: Points, director: Matrix, turning: Matrix
) -> tuple[Matrix, Matrix]:
    """Return strains with curvatures, and drilling: (n, n_q, 6 or 1, 6 n_node)."""
    n, n_q, _, n_node = points.gradients.shape
    x, y, z = np.moveaxis(points.frames, 2, 0)
    along, across = np.moveaxis(points.gradients, 2, 0)
    # Tangents times the rotation of each director, and derivatives of the director.
    x_turned = np.einsum("eqa,eiac->eqic", x, turning)
    y_turned = np.einsum("eqa,eiac->eqic", y, turning)
    slope = np.einsum("eqbi,eic->eqbc", points.gradients, director)
    strains = np.zeros((n, n_q, 6, n_node, 6))

    def product(derivative: Matrix, vector: Matrix) -> Matrix:
        return derivative[..., None] * vector[:, :, None]

    def turned(derivative: Matrix, vectors: Matrix) -> Matrix:
        return derivative[..., None] * vectors

    strains[:, :, 0, :, :3] = product(along, x)
    strains[:, :, 1, :, :3] = product(across, y)
    strains[:, :, 2, :, :3] = product(across, x) + product(along, y)
    strains[:, :, 3, :, :3] = product(along, slope[:, :, 0])
    strains[:, :, 4, :, :3] = product(across, slope[:, :, 1])
    strains[:, :, 5, :, :3] = product(across, slope[:, :, 0]) + product(along, slope[:, :, 1])
    strains[:, :, 3, :, 3:] = turned(along, x_turned)
    strains[:, :, 4, :, 3:] = turned(across, y_turned)
    strains[:, :, 5, :, 3:] = turned(across, x_turned) + turned(along, y_turned)
    drilling = np.zeros((n, n_q, 1, n_node, 6))
    drilling[:, :, 0, :, :3] = (product(across, x) - product(along, y)) / 2
    drilling[:, :, 0, :, 3:] = product(np.broadcast_to(rule.values, along.shape), z)
    size = 6 * n_node
    return strains.reshape(n, n_q, 6, size), drilling.reshape(n, n_q, 1, size)
