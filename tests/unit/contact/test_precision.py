"""Steps in single precision: their fallback to double, and the sums that Newton's method ends with.

Compared with dense solutions and with what forces move.
"""

from dataclasses import replace

import numpy as np
import pytest

from faying.contact import glued_pairs
from faying.contact.between_pairs import ByCompliance
from faying.contact.glued_pairs import GluedPairs
from faying.contact.held_pairs import SMALLEST_SINGLE_PIVOT, HeldPairs
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_descent import solve_yielding
from faying.contact.pair_factors import LU, PairSystem
from few_points import ELASTIC, PAIRS, N, free, joint


@pytest.mark.parametrize(("margin", "precision"), [(4.0, np.float32), (0.25, np.float64)])
def test_an_inverse_of_small_pivots_is_in_double_precision(margin, precision):
    """Its pivots tell: one is ``margin`` times the least that single precision serves with."""
    plain, _ = joint(0, ELASTIC)
    pairs = GluedPairs.of(plain.contact.rows, plain.laws.springs, ByCompliance(plain.S))
    structure = np.diag(np.r_[np.ones(3 * PAIRS - 1), margin * SMALLEST_SINGLE_PIVOT])
    held = HeldPairs.for_steps(pairs.points, np.zeros((3, N)), structure)
    assert held.compliance.dtype == precision
    always = HeldPairs.on_springs(pairs.points, np.zeros((3, N)), structure)
    assert always.compliance.dtype == np.float64
    np.testing.assert_allclose(held.compliance, np.linalg.inv(structure), rtol=1e-6)


@pytest.mark.parametrize("failing", ["singular", "useless"])
def test_a_step_that_single_precision_does_not_solve_is_solved_in_double(failing, monkeypatch):
    """Where factors in single precision are singular, and where they answer nonsense."""
    monkeypatch.setattr(glued_pairs, "DIRECT", 0)
    plain, _ = joint(1, ELASTIC)
    springs = plain.laws.springs
    # U itself in double, so that steps tell in which precision they were solved.
    pairs = GluedPairs.of(plain.contact.rows, springs, ByCompliance(plain.S)).glued_by(springs)
    K = np.zeros((N, 3, 3))
    K[:, np.arange(3), np.arange(3)] = pairs.glued.springs.T
    K[[0, 3]] *= 0.3
    right = np.random.default_rng(1).normal(size=3 * PAIRS)
    factorized, precisions = PairSystem.factorized, []

    def spoilt(system, product):
        precisions.append(product.dtype)
        if product.dtype == np.float64:
            return factorized(system, product)
        size = len(system.rows)
        # Either refused by LAPACK, or a factor of a matrix that overflows single precision.
        return LU.of(
            np.zeros((size, size), np.float32)
            if failing == "singular"
            else 1e-38 * np.eye(size, dtype=np.float32)
        )

    monkeypatch.setattr(PairSystem, "factorized", spoilt)
    monkeypatch.setattr(glued_pairs, "MOST_CORRECTIONS", 2)
    d, _, factors = pairs.step(K, right, 0.0)
    assert precisions == [np.float32, np.float64]
    assert factors is None
    rows = plain.contact.rows.toarray()
    at = (np.arange(3)[:, None] * N + np.arange(N)).T
    held = sum(rows[i].T @ own @ rows[i] for i, own in zip(at, K, strict=True))
    exact = np.linalg.solve(np.linalg.inv(plain.S) + held, right)
    np.testing.assert_allclose(d, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize("by_compliance", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_sums_of_newton_steps_are_formed_once_more(seed, by_compliance):
    """From a state 1e7 away: what steps add up to has seven digits less than where they end."""
    plain, _ = joint(seed, ELASTIC)
    laws, rows, S = LawsAtPoints(contact=plain.contact), plain.contact.rows, plain.S
    pairs, still = GluedPairs.of(rows, laws.springs, ByCompliance(S)), np.zeros(3 * PAIRS)
    near = solve_yielding(laws, pairs, still, free(seed))
    away = 1e7 * np.random.default_rng(seed).normal(size=3 * PAIRS)
    moved_by = S.__matmul__ if by_compliance else None
    far = replace(near, moved=away)
    found = solve_yielding(laws, pairs, still, free(seed), far, moved_by=moved_by)
    left = np.linalg.inv(S) @ found.moved - rows.T @ found.forces.ravel()
    assert np.abs(left).max() <= 1e-13 * np.abs(found.forces).max()
