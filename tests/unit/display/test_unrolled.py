"""Maps of cylinders: arc across, axis up, cut open where there is least."""

import numpy as np
import pytest

from faying.display.plane import plane_of, unrolled

RADIUS = 15.0


def cylinder(degrees, n=60):
    """Points and normals of a sleeve about the axis x = 3, y = -2."""
    angles = np.radians(np.linspace(0.0, degrees, n, endpoint=degrees < 360))
    out = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    heights = np.array([-4.0, 0.0, 4.0])
    points = (RADIUS * out + [3.0, -2.0, 0.0])[:, None] + heights[:, None] * [0.0, 0.0, 1.0]
    return points.reshape(-1, 3), np.repeat(out, 3, axis=0), angles


@pytest.mark.parametrize("degrees", [100, 200, 360])
def test_arcs_are_as_long_as_they_are(degrees):
    points, normals, angles = cylinder(degrees)
    found = unrolled(points, normals)
    assert found.radius == pytest.approx(RADIUS, rel=1e-12)  # points lie on the circle
    assert found.labels == ("arc", "z")
    flat = found.project(points).reshape(-1, 3, 2)
    step = RADIUS * (angles[1] - angles[0])
    # Each a step farther round, but once where a whole circle is cut.
    steps = np.abs(np.diff(flat[:, 0, 0]))
    assert (np.abs(steps - step) > 1e-9).sum() == (degrees == 360)
    np.testing.assert_allclose(flat[:, :, 1], [[-4.0, 0.0, 4.0]] * len(angles), atol=1e-12)
    around = np.cross([0.0, 0.0, 1.0], normals)
    moved = found.directions(points, 2 * around + [0.0, 0.0, 3.0])
    np.testing.assert_allclose(np.abs(moved), np.tile([2.0, 3.0], (len(points), 1)), atol=1e-12)


def test_facets_over_the_cut_are_drawn_whole():
    points, normals, angles = cylinder(360)
    found = unrolled(points, normals)
    flat = found.project(points).reshape(-1, 3, 2)
    lower, upper = flat[:, :2], np.roll(flat, -1, axis=0)[:, 1::-1]
    facets = np.concatenate([lower, upper], axis=1)
    width = RADIUS * (angles[1] - angles[0])
    assert (np.ptp(facets[..., 0], axis=1) > 2 * width).sum() == 1
    np.testing.assert_allclose(np.ptp(found.whole(facets)[..., 0], axis=1), width, rtol=1e-9)


def test_what_is_no_cylinder_is_not_unrolled():
    points, normals, _ = cylinder(360)
    assert unrolled(points, np.tile([0.0, 0.0, 1.0], (len(points), 1))) is None  # flat
    assert unrolled(points * [1.0, 1.3, 1.0], normals) is None  # an ellipse
    assert unrolled(*cylinder(40)[:2]) is None  # hardly bent: its best plane reads better
    assert unrolled(points[:3], normals[:3]) is None
    plane = plane_of(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), np.ones(len(points)))
    np.testing.assert_array_equal(plane.directions(points, normals), plane.project(normals))
