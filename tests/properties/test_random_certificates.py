"""The certificate must never lie below the true error."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.assessment.certificate import enclose
from faying.assessment.flexibility import flexibility
from faying.assessment.tresca import tresca_gap

ROUND_OFF = 1e-10
"""Allowance over ‖λ̂‖_H + ‖λ*‖_H: n ε √cond(H) for n = 12 and cond ≤ 1e8 is 3e-11."""


def random_flexibility(rng, n, rank, penalty):
    """H = S + D with rank(S) = rank and D = 0 for hard contact, eigenvalues over four decades."""
    modes = np.linalg.qr(rng.standard_normal((n, n)))[0][:, :rank]
    compliance = (modes * 10.0 ** rng.uniform(-4, 0, rank)) @ modes.T
    return compliance + np.diag(np.full(n, 1.0 / penalty))


def random_problems(rng, H, count):
    """Exact solutions by construction, a third of the points with neither force nor slack."""
    n = len(H)
    state = rng.integers(0, 3, (count, n))
    exact = np.where(state == 0, rng.exponential(size=(count, n)), 0.0)
    slack = np.where(state == 1, rng.exponential(size=(count, n)), 0.0)
    slack *= 10.0 ** rng.uniform(-6, 1, (count, 1))
    return exact, slack - exact @ H


def random_candidates(rng, exact):
    size = 10.0 ** rng.uniform(-8, 1, (len(exact), 1))
    return np.maximum(exact + size * rng.standard_normal(exact.shape), 0.0)


def norms(H, forces):
    return np.sqrt(np.maximum(((forces @ H) * forces).sum(axis=-1), 0.0))


def assert_enclosed(H, g_free, candidate, exact):
    ball = enclose(flexibility(H), g_free, candidate)
    error = norms(H, candidate - exact)
    allowance = ROUND_OFF * (norms(H, candidate) + norms(H, exact) + 1.0)
    assert (error <= np.sqrt(2 * ball.energy) + allowance).all()
    assert (norms(H, ball.centre - exact) <= ball.radius + allowance).all()
    return np.sqrt(2 * ball.energy)


@pytest.mark.parametrize(
    ("rank", "penalty"),
    [(12, 10.0), (12, 1e4), (6, 10.0), (6, 1e4), (12, np.inf)],
    ids=["soft", "stiff", "fewer pairs, soft", "fewer pairs, stiff", "hard"],
)
def test_never_violated_in_ten_thousand_problems(rank, penalty):
    rng = np.random.default_rng(rank)
    for _ in range(20):
        H = random_flexibility(rng, 12, rank, penalty)
        exact, g_free = random_problems(rng, H, 500)
        assert_enclosed(H, g_free, random_candidates(rng, exact), exact)


def test_never_violated_where_hard_contact_has_more_points_than_displacements():
    rng = np.random.default_rng(5)
    for _ in range(50):
        shapes = rng.dirichlet(np.ones(6), 12)  # a partition of unity, as shape functions are
        H = shapes @ np.diag(10.0 ** rng.uniform(-2, 0, 6)) @ shapes.T
        exact, g_free = random_problems(rng, H, 100)
        bound = assert_enclosed(H, g_free, random_candidates(rng, exact), exact)
        assert np.isfinite(bound).all()


@settings(max_examples=100)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 15),
    penalty=st.floats(1e-2, 1e6),
    size=st.floats(0.0, 10.0),
)
def test_never_violated_against_the_solver(seed, n, penalty, size):
    rng = np.random.default_rng(seed)
    H = random_flexibility(rng, n, rng.integers(1, n + 1), penalty)
    g_free = rng.standard_normal(n)
    exact = fy.contact_problem(H, g_free).solve().forces
    candidate = np.maximum(exact + size * rng.standard_normal(n), 0.0)
    assert_enclosed(H, g_free, candidate, exact)


def test_the_bound_of_the_exact_solution_vanishes():
    rng = np.random.default_rng(1)
    H = random_flexibility(rng, 12, 12, 1e3)
    exact, g_free = random_problems(rng, H, 50)
    ball = enclose(flexibility(H), g_free, exact)
    # s is zero only to ε ‖H‖ ‖λ‖, and so is the square root of the bound.
    assert np.sqrt(2 * ball.energy).max() < 1e-9 * norms(H, exact).max()


def test_the_bound_is_of_second_order_in_the_error_where_the_contact_area_is_known():
    rng = np.random.default_rng(2)
    H = random_flexibility(rng, 10, 10, 100.0)
    exact = np.where(np.arange(10) < 6, 1.0, 0.0)
    g_free = np.where(exact > 0, 0.0, 1.0) - H @ exact
    direction = np.where(exact > 0, rng.standard_normal(10), 0.0)
    candidates = exact + np.array([[1e-2], [1e-3], [1e-4]]) * direction
    bound = np.sqrt(2 * enclose(flexibility(H), g_free, candidates).energy)
    # Bound and error shrink tenfold together; a bound of first order would shrink by √10.
    np.testing.assert_allclose(bound[:-1] / bound[1:], 10.0, rtol=1e-2)


def random_increments(rng, H, n, count):
    """Exact solutions with fixed bounds by construction: points open or press, stick or slip."""
    force, slack = np.zeros((2, count, 3, n))
    presses = rng.random((count, n)) < 0.7
    force[:, 0] = np.where(presses, rng.exponential(size=(count, n)), 0.0)
    slack[:, 0] = np.where(presses, 0.0, rng.exponential(size=(count, n)))
    bound = rng.exponential(size=(count, n)) * (rng.random((count, n)) < 0.8)
    angle = rng.uniform(0, 2 * np.pi, (count, n))
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    slips = rng.random((count, n)) < 0.5
    force[:, 1:] = (bound * np.where(slips, 1.0, rng.random((count, n))))[:, None] * along
    slides = np.where(slips | (bound == 0), rng.exponential(size=(count, n)), 0.0)
    slack[:, 1:] = -slides[:, None] * along
    return force, slack.reshape(count, -1) - force.reshape(count, -1) @ H, bound


@pytest.mark.parametrize("penalty", [10.0, 1e4, np.inf], ids=["soft", "stiff", "hard"])
def test_tresca_increments_are_never_violated(penalty):
    rng, n, count = np.random.default_rng(7), 4, 500
    sharpest = np.inf
    for _ in range(7):
        H = random_flexibility(rng, 3 * n, 3 * n, penalty)
        exact, z_free, bound = random_increments(rng, H, n, count)
        size = 10.0 ** rng.uniform(-8, 1, (count, 1, 1))
        given = exact + size * rng.standard_normal(exact.shape)
        given[:, 0] = np.maximum(given[:, 0], 0.0)
        length = np.hypot(given[:, 1], given[:, 2])
        given[:, 1:] *= np.minimum(1.0, bound / np.maximum(length, 1e-300))[:, None]
        slack = (given.reshape(count, -1) @ H + z_free).reshape(given.shape)
        energy = tresca_gap(flexibility(H), given, slack, np.arange(n), bound)
        apart, most = (
            norms(H, one.reshape(count, -1)) for one in (given - exact, np.abs(given) + exact)
        )
        allowance = ROUND_OFF * (most + 1.0)
        assert (apart <= np.sqrt(2 * energy) + allowance).all()
        large = apart > 1e-3
        sharpest = min(sharpest, (np.sqrt(2 * energy[large]) / apart[large]).min())
    assert sharpest < 1.5  # else the bound says little even at its best; 1.0 is measured
