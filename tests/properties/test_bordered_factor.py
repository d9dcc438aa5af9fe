"""Active blocks solved from the factorization of another block are those solved anew."""

import numpy as np
import pytest
import scipy.linalg as la
from hypothesis import given
from hypothesis import strategies as st

from faying.contact.bordered_factor import BorderedFactor
from faying.contact.dense_points import DensePoints


def flexibility(rng, n, condition):
    """A symmetric positive definite matrix of a given condition."""
    vectors, _ = np.linalg.qr(rng.standard_normal((n, n)))
    return vectors * np.geomspace(1.0, condition, n) @ vectors.T


@given(seed=st.integers(0, 2**31), n=st.integers(1, 60), changes=st.integers(0, 6))
def test_any_sequence_of_active_sets(seed, n, changes):
    rng = np.random.default_rng(seed)
    H = flexibility(rng, n, 1e3)
    solver = BorderedFactor(H)
    active = rng.random(n) < 0.6
    for _ in range(8):
        right = rng.standard_normal(n)
        expected = np.zeros(n)
        if active.any():
            expected[active] = np.linalg.solve(H[np.ix_(active, active)], right[active])
        found = solver.solve(right, active)
        # condition 1e3 times round-off, times the condition of the bordering
        np.testing.assert_allclose(
            found, expected, rtol=0, atol=1e-9 * np.abs(expected).max(initial=1)
        )
        assert not found[~active].any()
        active = active ^ np.isin(np.arange(n), rng.integers(0, n, changes))


def test_few_changes_need_no_new_factorization(monkeypatch):
    rng = np.random.default_rng(0)
    H = flexibility(rng, 100, 1e2)
    solver, active = BorderedFactor(H), np.arange(100) < 80
    solver.solve(rng.standard_normal(100), active)
    monkeypatch.setattr(solver, "solve_anew", pytest.fail)
    for point in (90, 10, 95, 20, 90):  # on, off, on, off, off again
        active = active.copy()
        active[point] ^= True
        solver.solve(rng.standard_normal(100), active)


def test_singular_blocks_are_refused():
    H = np.ones((3, 3))
    with pytest.raises(la.LinAlgError):
        BorderedFactor(H).solve(np.ones(3), np.ones(3, dtype=bool))
    grown = np.array([[1.0, 1.0], [1.0, 1.0]])
    solver = BorderedFactor(np.kron(np.eye(10), grown))
    half = np.arange(20) % 2 == 0
    solver.solve(np.ones(20), half)
    with pytest.raises(la.LinAlgError):  # its border is singular, and so is the block
        solver.solve(np.ones(20), half | (np.arange(20) == 1))


def test_memory_does_not_change_results():
    rng = np.random.default_rng(3)
    H = flexibility(rng, 40, 1e6)
    used = DensePoints(H=H)
    for _ in range(20):
        used.equilibrate(rng.standard_normal(40), rng.random(40) < 0.5)
    active = rng.random(40) < 0.5
    gap = rng.standard_normal(40)
    for found, expected in zip(
        used.equilibrate(gap, active), DensePoints(H=H).equilibrate(gap, active), strict=True
    ):
        # condition 1e6 times round-off
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
