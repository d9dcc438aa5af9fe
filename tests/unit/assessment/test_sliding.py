"""How much of the friction against sliding as a whole tangential forces use."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying.assessment.sliding import resistance_used

N = 40


def interface(seed, *, curved=False):
    """Points, tangents and bounds of a random interface, flat or a piece of a cylinder."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-30, 30, (2, N))
    if not curved:
        tangents = np.array([np.tile([1.0, 0, 0], (N, 1)), np.tile([0, 1.0, 0], (N, 1))])
        return np.column_stack([x, y, np.zeros(N)]), tangents, rng.uniform(0.1, 5, N)
    angle = x / 20
    around = np.column_stack([np.cos(angle), np.zeros(N), -np.sin(angle)])
    places = np.column_stack([20 * np.sin(angle), y, 20 * np.cos(angle)])
    return places, np.array([around, np.tile([0, 1.0, 0], (N, 1))]), rng.uniform(0.1, 5, N)


def moved(places, tangents, motion):
    """Return what a rigid motion (6,) moves the points along the interface (2, N)."""
    velocity = motion[:3] + np.cross(motion[3:], places)
    return np.einsum("inj,nj->in", tangents, velocity)


components = st.floats(-1, 1).filter(lambda value: abs(value) > 1e-3)


@given(st.integers(0, 99), st.tuples(*[components] * 3), st.booleans())
def test_all_of_it_where_everything_slips_along_one_motion(seed, motion, curved):
    places, tangents, bounds = interface(seed, curved=curved)
    along, across, turn = motion
    slides = [0, along, 0, 0, 0.1 * turn, 0] if curved else [along, across, 0, 0, 0, 0.1 * turn]
    speed = moved(places, tangents, np.array(slides))
    shear = bounds * speed / np.linalg.norm(speed, axis=0)
    # The search ends where a pass brings less than 1e-6.
    assert resistance_used(places, tangents, shear, bounds) == pytest.approx(1, abs=1e-4)
    half = resistance_used(places, tangents, 0.5 * shear, bounds)
    assert half == pytest.approx(0.5, abs=1e-4)


@pytest.mark.long
@given(st.integers(0, 99), st.booleans())
def test_no_motion_meets_more(seed, curved):
    places, tangents, bounds = interface(seed, curved=curved)
    rng = np.random.default_rng(seed)
    shear = bounds * rng.uniform(-0.7, 0.7, (2, N))
    used = resistance_used(places, tangents, shear, bounds)
    assert 0 <= used <= 1
    sliding = [0, 1, 0, 0, 0.05, 0] if curved else [1, 1, 0, 0, 0, 0.05]
    for motion in rng.normal(size=(200, 6)) * sliding:
        speed = moved(places, tangents, motion)
        work, resisted = (shear * speed).sum(), bounds @ np.linalg.norm(speed, axis=0)
        assert work <= used * resisted * (1 + 1e-4) + 1e-12  # as far as the search goes


def test_motions_that_press_the_sides_into_each_other_are_no_sliding():
    """A shaft in a hub: across it nothing slides, though all points slip as by one motion."""
    angle = np.linspace(0, 2 * np.pi, N, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(N)])
    places = np.concatenate([15 * circle - [0, 0, 10], 15 * circle + [0, 0, 10]])
    around = np.column_stack([-np.sin(angle), np.cos(angle), np.zeros(N)])
    tangents = np.array([np.tile(around, (2, 1)), np.tile([0, 0, 1.0], (2 * N, 1))])
    bounds = np.ones(2 * N)
    for motion, expected in (
        ([1, 0, 0, 0, 0, 0], 0.0),  # across
        ([0, 0, 0, 0.1, 0, 0], 0.0),  # tilted
        ([0, 0, 1, 0, 0, 0.1], 1.0),  # along and around
    ):
        speed = moved(places, tangents, np.array(motion, dtype=float))
        size = np.maximum(np.linalg.norm(speed, axis=0), 1e-12)
        used = resistance_used(places, tangents, bounds * speed / size, bounds)
        # The search ends where a pass brings less than 1e-6; what cancels is round-off.
        assert used == pytest.approx(expected, abs=1e-4)


def test_none_of_it_where_slip_here_cancels_slip_there():
    places, tangents, bounds = interface(0)
    mirrored = places * [-1, 1, 1]
    shear = np.concatenate([bounds, -bounds]) * np.array([[1.0], [0.0]])
    both = np.concatenate([places, mirrored]), np.concatenate([tangents, tangents], axis=1)
    assert resistance_used(*both, shear, np.tile(bounds, 2)) < 1e-9
    assert resistance_used(places, tangents, np.zeros((2, N)), bounds) == 0
    assert np.isnan(resistance_used(places, tangents, np.zeros((2, N)), np.zeros(N)))
