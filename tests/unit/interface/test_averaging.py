"""From contact points to node pairs: every pair has a value, a mean of what lies around it."""

import numpy as np
import pytest

import faying as fy
from faying.joint.sticking import stuck_pairs

RULES = [("gauss", None), ("gauss", 1), ("gauss", 2), ("gauss", 5), ("nodal", None)]
SHAPES = ("hex8", "hex20", "tet4", "tet10", "wedge15")


def joint(shape, quadrature="nodal", order=None, **options):
    size = {"element_size": 5.0, **options}
    model = fy.lap_joint(shape=shape, quadrature=quadrature, order=order, penalty=1e5, **size)
    return model.interfaces["joint"], model.assembly.mesh.nodes


@pytest.mark.parametrize("upper", [None, 7.0])
@pytest.mark.parametrize(("quadrature", "order"), RULES)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_constant_stays_what_it_is_at_every_pair(shape, quadrature, order, upper):
    few = {"element_size": 10.0, "hole_radius": 0.0, "washer_radius": 11.0}
    interface, _ = joint(shape, quadrature, order, upper_element_size=upper, **few)
    average = interface.nodal_average(np.ones(interface.n_points))
    # Sums of up to a hundred weights that add up to one.
    np.testing.assert_allclose(average, 1.0, rtol=1e-14)
    assert interface.averaging.data.min() > 0


def test_corners_without_a_point_take_the_mean_of_the_mid_sides_next_to_them():
    interface, nodes = joint("tet10", hole_radius=0.0)
    places = interface.pair_points(nodes)[:, :2]
    distance = np.linalg.norm(places[:, None] - interface.points[None, :, :2], axis=2)
    corners = np.flatnonzero(distance.min(axis=1) > 1.0)
    assert len(corners) == 45
    low, high = places.min(axis=0), places.max(axis=0)
    inside = corners[((places[corners] > low + 1) & (places[corners] < high - 1)).all(axis=1)]
    linear = interface.points[:, :2] @ [2.0, 3.0]
    # The mid-sides around a corner within the regular mesh lie opposite each other.
    exact = places[inside] @ [2.0, 3.0]
    np.testing.assert_allclose(interface.nodal_average(linear)[inside], exact, atol=1e-12)
    # Half an edge away, along sides and the diagonals of squares of 5 mm.
    used = interface.averaging[inside].toarray() > 0
    assert distance[inside][used].max() <= 2.5 * np.sqrt(2) + 1e-9


def test_eight_node_corners_do_not_average_the_middle_of_the_facet():
    interface, nodes = joint("hex20")
    places = interface.pair_points(nodes)
    distance = np.linalg.norm(places[:, None] - interface.points[None], axis=2)
    corner = np.flatnonzero(np.isclose(places[:, 0] % 5, 0) & np.isclose(places[:, 1] % 5, 0))
    assert len(corner) == 44
    nearest = distance[corner].argmin(axis=1)
    values = np.random.default_rng(1).random(interface.n_points)
    # Its point lies at the corner: the average is the value there.
    np.testing.assert_allclose(interface.nodal_average(values)[corner], values[nearest])


def test_pairs_stick_wherever_the_pressure_is_the_same():
    interface, _ = joint("tet10")
    assert stuck_pairs(interface, np.ones(interface.n_points), 0.5).all()
