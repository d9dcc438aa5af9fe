"""Facets: shape functions, quadrature and the geometry of curved surfaces."""

from math import factorial, pi

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.interface.facets import (
    gauss_rule,
    nodal_rule,
    reference_nodes,
    shape_functions,
    shape_gradients,
    surface,
)
from faying.model.surface import unique_rows

KINDS = ("tri3", "tri6", "quad4", "quad8")
AREA = {"tri3": 0.5, "tri6": 0.5, "quad4": 1.0, "quad8": 1.0}

# A few roundings of numbers of order one.
ROUNDING = 1e-14


def grid(kind, n):
    """Reference square [0, 1]² as facets of one kind: parameters (n_face, n_node, 2)."""
    corner = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 1, 2)
    local = reference_nodes(kind)[None]
    if kind.startswith("quad"):
        return (corner + local) / n
    return np.concatenate([corner + local, corner + 1 - local]) / n


def cylinder(kind, n):
    """A quarter of a cylinder with radius and length one."""
    angle, z = np.moveaxis(grid(kind, n), -1, 0)
    return np.stack([np.cos(angle * pi / 2), np.sin(angle * pi / 2), z], axis=-1)


@pytest.mark.parametrize("kind", KINDS)
def test_shape_functions_are_one_at_their_node(kind):
    values = shape_functions(kind, reference_nodes(kind))
    np.testing.assert_allclose(values, np.eye(len(values)), atol=ROUNDING)


@pytest.mark.parametrize("kind", KINDS)
def test_gradients_are_the_slope_of_the_shape_functions(kind):
    points = np.array([[0.2, 0.3], [0.35, 0.1], [0.4, 0.5]])
    step = 1e-6
    slopes = [
        (shape_functions(kind, points + d) - shape_functions(kind, points - d)) / (2 * step)
        for d in step * np.eye(2)
    ]
    # Central differences of quadratics are exact; rounding over the step is 1e-10.
    np.testing.assert_allclose(shape_gradients(kind, points), np.stack(slopes, -1), atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rule", [gauss_rule, nodal_rule])
def test_weights_are_positive_and_give_the_area(kind, rule):
    weights = rule(kind).weights
    assert weights.min() > 0
    assert weights.sum() == pytest.approx(AREA[kind], rel=ROUNDING)


@pytest.mark.parametrize("kind", KINDS)
def test_default_gauss_rule_integrates_pressure_times_shape_functions(kind):
    default, fine = gauss_rule(kind), gauss_rule(kind, 10)
    coarse_n, fine_n = (shape_functions(kind, rule.points) for rule in (default, fine))
    exact = fine_n.T @ (fine.weights[:, None] * fine_n)
    np.testing.assert_allclose(
        coarse_n.T @ (default.weights[:, None] * coarse_n), exact, atol=ROUNDING
    )


@pytest.mark.parametrize("degree", range(1, 13))
def test_triangle_rules_have_their_degree_and_points_inside(degree):
    rule = gauss_rule("tri3", degree)
    x, y = rule.points.T
    assert rule.weights.min() > 0
    assert min(x.min(), y.min(), (1 - x - y).min()) > 0
    for a in range(degree + 1):
        exact = factorial(a) * factorial(degree - a) / factorial(degree + 2)
        # The tables of the rules carry 15 digits; monomials are at most 0.5 in all.
        assert rule.weights @ (x**a * y ** (degree - a)) == pytest.approx(exact, abs=2e-15)


@pytest.mark.parametrize("order", range(1, 6))
def test_quadrilateral_orders_are_points_per_direction(order):
    rule = gauss_rule("quad4", order)
    x, y = rule.points.T
    top = 2 * order - 1
    assert len(rule.weights) == order**2
    assert rule.weights @ (x**top * y**top) == pytest.approx(1 / (top + 1) ** 2, rel=1e-13)
    assert rule.name == f"gauss-{order}"


@pytest.mark.parametrize("kind", KINDS)
def test_nodal_points_are_the_nodes_they_name(kind):
    rule = nodal_rule(kind)
    named = rule.nodes >= 0
    np.testing.assert_array_equal(rule.points[named], reference_nodes(kind)[rule.nodes[named]])
    # Only the centre of the eight-node quadrilateral is no node.
    assert (~named).sum() == (1 if kind == "quad8" else 0)


@pytest.mark.parametrize("order", [0, 13])
def test_an_order_out_of_range_is_refused(order):
    with pytest.raises(ModelError, match=f"order {order}.*1 to 12"):
        gauss_rule("quad4", order)


@pytest.mark.parametrize("kind", KINDS)
def test_flat_distorted_facets_have_their_polygon_area(kind):
    corners = np.array([[0, 0], [3, 0.5], [2.5, 2.0], [-0.5, 1.5]])
    if kind.startswith("tri"):
        corners = corners[:3]
    linear = shape_functions({3: "tri3", 4: "quad4"}[len(corners)], reference_nodes(kind))
    flat = linear @ corners
    tilt = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
    facet = (flat @ tilt + [1.0, 2.0, 3.0])[None]
    x, y = corners.T
    polygon = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    for rule in (gauss_rule(kind), nodal_rule(kind)):
        geometry = surface(kind, facet, rule)
        assert geometry.areas.sum() == pytest.approx(polygon, rel=ROUNDING)
        np.testing.assert_allclose(
            geometry.normals, np.broadcast_to([-0.8, 0.0, 0.6], geometry.normals.shape), atol=1e-14
        )


@pytest.mark.parametrize(("kind", "rate"), [("tri3", 2), ("quad4", 2), ("tri6", 4), ("quad8", 4)])
def test_the_area_of_a_cylinder_converges(kind, rate):
    rule = gauss_rule(kind)
    meshes = [cylinder(kind, n) for n in (4, 8)]
    coarse, fine = (abs(surface(kind, m, rule).areas.sum() - pi / 2) for m in meshes)
    # Chords lose h² of the area, parabolas h⁴; 0.1 allows for the next order on these meshes.
    assert np.log2(coarse / fine) == pytest.approx(rate, abs=0.1)


@pytest.mark.parametrize("kind", ["tri6", "quad8"])
def test_the_area_of_a_curved_facet_is_that_of_the_interpolated_surface(kind):
    facets = cylinder(kind, 4)
    own = surface(kind, facets, gauss_rule(kind)).areas.sum()
    finest = surface(kind, facets, gauss_rule(kind, 12)).areas.sum()
    straight = {"tri6": "tri3", "quad8": "quad4"}[kind]
    corners = facets[:, : facets.shape[1] // 2]
    chords = surface(straight, corners, gauss_rule(straight)).areas.sum()
    # The Jacobian is no polynomial; on facets of 22° the default rule leaves 8e-8 of it, while
    # straight facets lose 1e-2.
    assert own == pytest.approx(finest, rel=2e-7)
    assert abs(chords - finest) > 5e-3


@pytest.mark.parametrize("span", [2, 10**3, 10**6, 2**62], ids=["2", "1e3", "1e6", "2**62"])
def test_rows_are_grouped_in_their_order_whatever_their_range(span):
    rng = np.random.default_rng(0)
    rows = rng.integers(-span // 2, span // 2, (60, 4))[rng.integers(0, 60, 200)]
    rows[::3, 3] = -1
    found = unique_rows(rows)
    expected = np.unique(rows, axis=0, return_index=True, return_inverse=True, return_counts=True)
    for one, other in zip(found, expected[1:], strict=True):
        np.testing.assert_array_equal(one, other.ravel())
    for nothing in unique_rows(np.zeros((0, 4), dtype=np.int64)):
        assert not len(nothing)
