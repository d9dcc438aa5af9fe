"""Active blocks of a dense flexibility: solved exactly, or told to be singular."""

import numpy as np
import pytest
from scipy.linalg import LinAlgError

from faying.contact.dense_points import DensePoints

N = 6
ACTIVE = np.array([True, False, True, True, False, True])
# Systems of condition below 1e3, in any unit.
SAME = 1e-12
UNITS = [1e-20, 1.0, 1e12]


def flexibility():
    root = np.random.default_rng(0).normal(size=(N, N))
    return root @ root.T + np.eye(N)


@pytest.mark.parametrize("unit", UNITS)
def test_forces_close_the_active_gaps(unit):
    H, gap = unit * flexibility(), np.random.default_rng(1).normal(size=N)
    forces, slack = DensePoints(H=H).equilibrate(gap, ACTIVE)
    block = H[np.ix_(ACTIVE, ACTIVE)]
    np.testing.assert_allclose(forces[ACTIVE], np.linalg.solve(block, -gap[ACTIVE]), rtol=SAME)
    assert not forces[~ACTIVE].any()
    assert not slack[ACTIVE].any()
    np.testing.assert_allclose(slack, np.where(ACTIVE, 0, gap + H @ forces), rtol=SAME)


def test_without_active_points_gaps_stay():
    gap = np.random.default_rng(1).normal(size=N)
    forces, slack = DensePoints(H=flexibility()).equilibrate(gap, np.zeros(N, dtype=bool))
    assert not forces.any()
    np.testing.assert_array_equal(slack, gap)
    slack[:] = 0.0
    assert gap.any()  # the slack is an array of its own


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("pivot", "regular"), [(1.1e-7, True), (0.9e-7, False)])
def test_blocks_are_singular_below_a_ratio_of_pivots(unit, pivot, regular):
    H = unit * np.array([[4.0, 2.0], [2.0, 1.0 + 4 * pivot**2]])  # pivots 2 and 2 times that
    points, both = DensePoints(H=H), np.ones(2, dtype=bool)
    # The second pivot is a difference of ones with round-off 1e-16, its square 5e-14 or less.
    if regular:
        points.equilibrate(np.ones(2), both)
    else:
        with pytest.raises(LinAlgError, match="singular active block"):
            points.equilibrate(np.ones(2), both)


def test_shifted_and_multiplied():
    points, forces = DensePoints(H=flexibility()), np.arange(N) - 1.5
    shifted = points.shifted(0.3)
    np.testing.assert_allclose(shifted.H, points.H + 0.3 * np.eye(N), rtol=0, atol=0)
    np.testing.assert_array_equal(shifted.product(forces), shifted.H @ forces)
    np.testing.assert_array_equal(shifted.diagonal, np.diag(shifted.H))
