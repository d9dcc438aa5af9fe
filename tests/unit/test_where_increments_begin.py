"""Where Newton's method begins: exact as long as points stay where they were. Laws by points."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.linalg import LinAlgError

from faying.contact.laws import Coulomb, Hard
from faying.contact.laws.unilateral import Unilateral
from faying.contact.laws_at_points import LawsAtPoints
from few_points import (
    LAWS,
    PLACES,
    POINT_STIFFNESS,
    POINT_TANGENTIAL,
    SAME,
    WEIGHTS,
    N,
    apart,
    free,
    joint,
)

DIRECTION = (-0.96, 0.28)


def pressed(count, shear, direction=DIRECTION):
    """Forces of points that are pressed by 10 and sheared by so much."""
    size = np.broadcast_to(shear, count)
    return np.stack([np.full(count, 10.0), direction[0] * size, direction[1] * size])


def free_of(forces, slip=0.0, direction=DIRECTION):
    """z_free for which forces have that slip, against them where it is positive."""
    z = -forces / np.array([[POINT_STIFFNESS], [POINT_TANGENTIAL], [POINT_TANGENTIAL]])
    z[1:] -= np.outer(direction, np.broadcast_to(slip, forces.shape[1]))
    return z


def begun(plain, forces, ends, slip=0.0):
    """Where Newton's method begins from forces if that is where they go, with the slip it takes."""
    x, factors = plain.predictor.as_before(free_of(ends, slip), forces)
    assert factors is not None
    return x


def test_points_stick_slip_on_and_stay_open():
    """Exactly: along its direction slip is as linear as sticking is."""
    start, ends = pressed(4, [2.0, 3.0, 3.0, 0.0]), pressed(4, [2.5, 3.6, 2.4, 0.0])
    ends[0] = 10.0, 12.0, 8.0, 0.0
    start[:, 3] = 0.0
    opened = np.array([0.0, 0.4, 0.1, 0.0])
    x = begun(apart(4), start, ends, opened)
    np.testing.assert_allclose(x, ends, rtol=0, atol=10 * SAME)


@pytest.mark.parametrize("back", [2, 3, 20])
def test_points_that_would_slip_back_stick(back):
    """Of twenty that slip; two alone are left at their bound, for that is found out soon.

    Beside them as many stick, whatever round-off their slip is, and as many are open.
    """
    start, end = pressed(60, [*[3.0] * 20, *[1.0] * 40]), np.array([2.5] * back + [3.0] * 20)[:20]
    ends, slip = pressed(60, [*end, *[1.3] * 40]), np.zeros(60)
    slip[back:20] = 0.2
    z_free = free_of(ends, slip)
    start[:, 40:], ends[:, 40:], z_free[0, 40:] = 0.0, 0.0, 0.5
    x, _ = apart(60).predictor.as_before(z_free, start)
    if back == 2:
        ends[:, :2] = start[:, :2]
    np.testing.assert_allclose(x, ends, rtol=0, atol=10 * SAME)


def test_points_slip_on_from_a_millionth_below_their_bound():
    start = pressed(2, 3.0 * np.array([1 - 0.8e-6, 1 - 1.2e-6]))
    x = begun(apart(2), start, pressed(2, 4.0))
    np.testing.assert_allclose(x, pressed(2, [3.0, 4.0]), rtol=0, atol=10 * SAME)


def test_points_that_hardly_pull_do_not_slip_back():
    """Zero work of slip is none: they stay as they were."""
    start = pressed(3, 3.0)
    x = begun(apart(3), start, start)
    np.testing.assert_allclose(x, start, rtol=0, atol=10 * SAME)


def test_forces_that_are_not_admissible_are_made_so_first():
    start, ends = pressed(2, 3.0), pressed(2, [3.0, 1.0])
    over = np.array([[1.0, 1.0], [1.5, 1.0], [1.5, 1.0]]) * start
    x = begun(apart(2), over, ends, [0.2, 0.0])
    np.testing.assert_allclose(x, ends, rtol=0, atol=10 * SAME)


@pytest.mark.parametrize("seed", range(3))
def test_an_increment_is_solved_at_once_from_what_became_of_it(seed):
    """With points that move each other; what stays where it was is solved from the state before."""
    plain, _ = joint(seed)
    found = plain.solve(free(seed + 10), plain.solve(free(seed)).forces)
    z_free = free(seed + 10) + 1e-9 * free(seed)
    start = plain.solve(free(seed)).forces
    x, factors = plain.predictor.as_in(plain.trial(found), z_free, start)
    again = plain.solve(z_free, found.forces)
    # Slip that turns is linear to first order; the load is another by 1e-9.
    np.testing.assert_allclose(x, again.forces, rtol=0, atol=1e-6 * np.abs(x).max())
    assert factors is not None
    sticky = {
        name: replace(law, friction=10.0) if isinstance(law, Coulomb) else law
        for name, law in LAWS.items()
    }
    plain, _ = joint(seed, sticky)
    start = plain.solve(free(seed))
    z_free = start.slack - (plain._slack(start.forces, 0 * free(seed)))
    z_free = z_free + 1e-3 * free(seed + 20)
    z_free[1:] -= start.slack[1:]
    x, _ = plain.predictor.as_before(z_free, start.forces)
    found = plain.solve(z_free, start.forces)
    np.testing.assert_allclose(x, found.forces, rtol=0, atol=SAME * np.abs(x).max())
    assert found.iterations == 1


def test_from_singular_systems_it_begins_where_the_last_increment_ended():
    plain = apart(2)

    class Singular:
        moved = staticmethod(plain.steps.moved)

        def step(self, *_):
            message = "singular"
            raise LinAlgError(message)

    predictor = replace(plain.predictor, steps=Singular())
    start, over = pressed(2, 3.0), pressed(2, 4.0)
    for x, factors in (
        predictor.as_before(free_of(start), over),
        predictor.as_in(over, free_of(start), over),
    ):
        np.testing.assert_allclose(x, start, rtol=1e-14)
        assert factors is None


@dataclass(frozen=True)
class Curve(Unilateral):
    """Closure as the square root of pressure."""

    name = "curve"
    penalty = 1.0
    proportional = False

    def closure(self, forces, weights):
        root = np.sqrt(np.maximum(forces, 0.0) / weights)
        return root, 0.5 / (np.maximum(root, 1e-3) * weights)


@pytest.mark.parametrize("third", [Coulomb(Hard(), 0.2, np.inf), Curve()])
def test_laws_hold_at_their_own_points(third):
    """As each of them says alone; what a law does not have is zero."""
    laws = LAWS | {"three": third}
    plain, _ = joint(0, laws)
    at_points = LawsAtPoints(contact=plain.contact)
    random = np.random.default_rng(1)
    for pressing in (None, random.uniform(0.0, 2.0, N)):
        forces = random.normal(size=(3, N))
        closed, compliance = np.zeros((2, 3, N))
        admissible, slope = np.zeros((3, N)), np.zeros((N, 3, 3))
        for name, law in laws.items():
            at, n = PLACES[name], law.components
            own, held = forces[:n, at], None if pressing is None else pressing[at]
            closed[:n, at], compliance[:n, at] = law.closure(own, WEIGHTS[at])
            admissible[:n, at] = law.admissible(own, held)
            slope[at, :n, :n] = law.derivative(own, held)
        found = at_points.closure(forces)
        np.testing.assert_array_equal(found[0], closed)
        np.testing.assert_array_equal(found[1], compliance)
        np.testing.assert_array_equal(at_points.admissible(forces, pressing), admissible)
        np.testing.assert_array_equal(at_points.derivative(forces, pressing), slope)
    assert found[1][1:, 3].max() == 0.0
