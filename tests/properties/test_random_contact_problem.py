"""Properties of the condensed contact problem that hold for every flexibility and gap."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from faying.contact.dense_points import contact_problem

ENTRIES = st.floats(-10, 10, allow_subnormal=False).map(lambda x: round(x, 3))


@st.composite
def problems(draw, *, ridge=(1e-3, 1.0)):
    """H = BᵀB + δI with 0 to 12 points, and a gap of either sign."""
    n = draw(st.integers(0, 12))
    rows = draw(st.integers(0, 12))
    B = draw(arrays(float, (rows, n), elements=ENTRIES))
    delta = draw(st.floats(*ridge))
    gap = draw(arrays(float, n, elements=ENTRIES))
    return B.T @ B + delta * np.eye(n), gap


def tolerance(H, gap, forces):
    """Round-off of Hλ + g, with the condition of at most 1e7 in the forces."""
    return 1e-9 * (1 + np.abs(gap).max(initial=0) + np.abs(H).sum() * forces.max(initial=0))


@pytest.mark.long
@settings(max_examples=200)
@given(problems())
def test_forces_and_slack_are_complementary(drawn):
    H, gap = drawn
    solution = contact_problem(H, gap).solve()
    small = tolerance(H, gap, solution.forces)
    assert (solution.forces >= 0).all()
    assert (solution.slack >= 0).all()
    assert (solution.forces * solution.slack == 0).all()
    np.testing.assert_allclose(H @ solution.forces + gap, solution.slack, rtol=0, atol=small)


@settings(max_examples=100)
@given(problems(), st.data())
def test_start_does_not_matter(drawn, data):
    H, gap = drawn
    start = data.draw(arrays(bool, len(gap)))
    cold, warm = contact_problem(H, gap).solve(), contact_problem(H, gap).solve(active=start)
    # Different active sets can be right only where force and slack both vanish.
    small = tolerance(H, gap, cold.forces)
    np.testing.assert_allclose(warm.slack, cold.slack, rtol=0, atol=small)
    np.testing.assert_allclose(H @ warm.forces, H @ cold.forces, rtol=0, atol=small)


@settings(max_examples=50)
@given(problems(), st.sampled_from([2.0**-20, 2.0**10]), st.sampled_from([2.0**-30, 2.0**20]))
def test_units_do_not_matter(drawn, length, force):
    H, gap = drawn
    plain = contact_problem(H, gap).solve()
    scaled = contact_problem(H * (length / force), gap * length).solve()
    # Powers of two scale without rounding, so every pivot is the same.
    np.testing.assert_array_equal(scaled.forces, plain.forces * force)


@settings(max_examples=100)
@given(problems(), st.data())
def test_forces_minimize_the_energy(drawn, data):
    H, gap = drawn
    solution = contact_problem(H, gap).solve()
    other = np.abs(data.draw(arrays(float, len(gap), elements=ENTRIES)))
    energy = [0.5 * x @ H @ x + gap @ x for x in (solution.forces, other)]
    small = tolerance(H, gap, np.append(solution.forces, other)) * (1 + solution.forces.sum())
    assert energy[0] <= energy[1] + small


@settings(max_examples=100)
@given(problems(ridge=(0.0, 0.0)))
def test_redundant_points_are_pressed_or_open(drawn):
    H, gap = drawn
    gap = H @ gap  # gaps that displacements can make: the problem then has a solution
    solution = contact_problem(H, gap).solve()
    s = H @ solution.forces + gap
    # Gaps are closed to 1e-13 of the largest; the sums lose a few digits more.
    small = tolerance(H, gap, solution.forces)
    assert (solution.forces >= 0).all()
    assert s.min(initial=0) >= -small
    assert solution.forces @ s <= small * (1 + solution.forces.sum())
