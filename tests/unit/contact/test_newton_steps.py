"""A Newton step of increments against the same equations written out as dense matrices."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import block_diag, qr

from faying.contact.newton_steps import PROXIMAL, NewtonSteps

N_POINT, N_PAIR = 12, 9
OPEN = [0, 5]
"""Points that admit nothing; the first alone touches the first pair."""

EXACT = 1e-10
"""Round-off of systems with conditions up to 1e4."""


@pytest.fixture
def random():
    return np.random.default_rng(5)


@pytest.fixture
def steps(random):
    """Every point moves with two or three of the pairs, turned in some way."""
    rows = np.zeros((3 * N_POINT, 3 * N_PAIR))
    for point in range(N_POINT):
        turn = qr(random.normal(size=(3, 3)))[0]
        pairs = [0] if point == 0 else [1 + point % 8, 1 + (3 * point + 1) % 8]
        for pair in pairs:
            rows[point::N_POINT, 3 * pair : 3 * pair + 3] = random.uniform(0.2, 0.8) * turn
    root = random.normal(size=(3 * N_PAIR, 3 * N_PAIR))
    return NewtonSteps(G=sp.csr_array(rows), S=root @ root.T / (3 * N_PAIR) + np.eye(3 * N_PAIR))


@pytest.fixture
def system(random):
    """F, J, r and c′ of points that stick, slip or are open; a third of them are rigid."""
    slope = np.stack([half_space(random) for _ in range(N_POINT)])
    slope[OPEN] = 0.0
    slope[7] = np.diag([0.7, 0.0, 0.0])  # without friction
    wrong, scale, compliance = random.uniform(0.5, 2.0, (3, 3, N_POINT))
    compliance[:, ::3] = 0.0
    return wrong - 1.2, slope, scale, compliance


def half_space(random):
    """Return the derivative of some projection: symmetric, between zero and one."""
    turn = qr(random.normal(size=(3, 3)))[0]
    return turn @ np.diag(random.uniform(0.3, 0.9, 3)) @ turn.T


def yielding(steps, compliance):
    moved = steps.G.toarray() @ steps.S @ steps.G.toarray().T
    own = np.diag(moved).reshape(3, N_POINT).copy()
    own[1:] = own[1:].mean(axis=0)
    return np.maximum(compliance, PROXIMAL * own)


def by_points(blocks):
    """Return blocks (n_point, 3, 3) as a matrix over all normal and all tangential components."""
    order = np.arange(3 * N_POINT).reshape(N_POINT, 3).T.ravel()
    return block_diag(*blocks)[np.ix_(order, order)]


def dense(steps, system):
    """Solve (F2): A dx + E G S Gᵀ dx = −F, E = J r, A = I − J + E c′."""
    wrong, slope, scale, compliance = system
    E = by_points(slope * scale.T[:, None, :])
    A = np.eye(3 * N_POINT) - by_points(slope) + E * yielding(steps, compliance).ravel()
    G = steps.G.toarray()
    return np.linalg.solve(A + E @ G @ steps.S @ G.T, -wrong.ravel()).reshape(3, N_POINT)


def test_step_solves_its_equations(steps, system):
    assert steps.step(*system) == pytest.approx(dense(steps, system), rel=EXACT, abs=EXACT)


def test_step_where_nothing_is_admissible(steps, system):
    wrong, slope, scale, compliance = system
    assert steps.step(wrong, 0 * slope, scale, compliance) == pytest.approx(-wrong, abs=0)


def springs(random):
    K = np.stack([half_space(random) for _ in range(N_POINT)])
    K[OPEN] = 0.0
    K[7] = np.diag([0.7, 0.0, 0.0])
    return 20.0 * K


def test_springs_of_points_between_pairs(steps, random):
    K = springs(random)
    K[3, 0, 1] += 1.0  # laws with friction are not symmetric
    G = steps.G.toarray()
    assert steps.springs.between_pairs(K).toarray() == pytest.approx(
        G.T @ by_points(K) @ G, abs=EXACT
    )


def test_own_displacements_of_points(steps, random):
    forces = random.normal(size=(3, N_POINT))
    G = steps.G.toarray()
    moved = (G @ steps.S @ G.T @ forces.ravel()).reshape(3, N_POINT)
    assert steps.moved(forces) == pytest.approx(moved, rel=EXACT)
    own = np.diag(G @ steps.S @ G.T).reshape(3, N_POINT)
    assert steps.own[0] == pytest.approx(own[0], rel=EXACT)
    assert steps.own[1:] == pytest.approx(np.array([own[1:].mean(axis=0)] * 2), rel=EXACT)
