"""Active blocks of a dense flexibility: solved exactly, or told to be singular."""

import numpy as np
import pytest
from scipy.linalg import LinAlgError

from faying.contact.dense_points import DensePoints

N = 6
POINTS = np.array([0, 2, 3, 5])
# Systems of condition below 1e3, in any unit.
SAME = 1e-12
UNITS = [1e-20, 1.0, 1e12]


def flexibility():
    root = np.random.default_rng(0).normal(size=(N, N))
    return root @ root.T + np.eye(N)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_forces_close_the_gaps_of_points_that_yield_besides(unit, share):
    H, gaps = unit * flexibility(), np.random.default_rng(1).normal(size=(len(POINTS), 2))
    forces = DensePoints(H=H).closing(POINTS, np.full(len(POINTS), unit * share))(gaps)
    block = H[np.ix_(POINTS, POINTS)] + unit * share * np.eye(len(POINTS))
    np.testing.assert_allclose(forces, np.linalg.solve(block, -gaps), rtol=SAME)


def test_without_points_there_are_no_forces():
    none = np.empty(0, dtype=int)
    closing = DensePoints(H=flexibility()).closing(none, np.empty(0))
    assert closing(np.empty((0, 2))).shape == (0, 2)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("pivot", "regular"), [(1.1e-7, True), (0.9e-7, False)])
def test_blocks_are_singular_below_a_ratio_of_pivots(unit, pivot, regular):
    H = unit * np.array([[4.0, 2.0], [2.0, 1.0 + 4 * pivot**2]])  # pivots 2 and 2 times that
    points, both = DensePoints(H=H), np.arange(2)
    # The second pivot is a difference of ones with round-off 1e-16, its square 5e-14 or less.
    if regular:
        points.closing(both, np.zeros(2))
    else:
        with pytest.raises(LinAlgError, match="singular active block"):
            points.closing(both, np.zeros(2))
        points.closing(both, np.full(2, 1e-6 * unit))  # what yields besides is regular


def test_multiplied():
    points, forces = DensePoints(H=flexibility()), np.arange(N) - 1.5
    np.testing.assert_array_equal(points.product(forces), points.H @ forces)
    np.testing.assert_array_equal(points.diagonal, np.diag(points.H))
