"""Sticking areas and what tightening reports; closed forms are in tests/verification."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError


@pytest.fixture(scope="module")
def loose():
    return fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))


def test_without_sticking_the_structure_is_the_same(loose):
    preloaded = fy.preload(loose, {"bolt": 10e3})
    assert preloaded.structure is loose.structure
    assert not preloaded.stuck
    assert loose.bolts["bolt"].initial_force == 0.0  # the model it was made from is as it was


def test_pairs_above_the_threshold_stick(loose):
    pressure = fy.solve_static(fy.preload(loose, {"bolt": 10e3})).pressure
    average = loose.interfaces["joint"].nodal_average(pressure)
    for threshold in (0.0, 0.3, 0.9):
        tied = fy.preload(loose, {"bolt": 10e3}, sticking=fy.Sticking(threshold=threshold))
        expected = average > threshold * average.max()
        np.testing.assert_array_equal(tied.stuck["joint"], expected)


def test_sticking_adds_tangential_springs_only(joint, loose):
    added = (joint.K - loose.K).tocoo()
    touched = np.unique(joint.dofs.free[added.row[np.abs(added.data) > 1.0]])
    minus_and_plus = np.unique(joint.interfaces["joint"].pairs[joint.stuck["joint"]])
    assert set(np.unique(touched // 6)) <= set(minus_and_plus)
    assert set(np.unique(touched % 6)) == {0, 1}
    assert np.abs(added.data).max() == pytest.approx(1e6, rel=0.1)  # springs of 1e6 N/mm


def test_sticking_springs_are_damped_as_the_rest(joint, loose):
    difference = joint.C - loose.C - 5e-7 * (joint.K - loose.K)
    assert np.abs(difference.data).max(initial=0.0) < 1e-12  # rounding of entries of 1


@pytest.mark.parametrize(
    "bad", [{"threshold": 1.0}, {"threshold": -0.1}, {"stiffness": 0.0}, {"threshold": np.nan}]
)
def test_refuses_sticking_that_is_none(bad):
    with pytest.raises(ModelError, match=r"must lie in \[0, 1\)"):
        fy.Sticking(**bad)
