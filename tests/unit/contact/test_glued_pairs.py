"""Pairs on the springs of closed points, with bolts known by force, against dense inverses."""

import numpy as np
import pytest
from scipy.linalg import LinAlgError

import faying as fy
from faying.contact.between_pairs import ByCompliance
from faying.contact.glued_pairs import ACCURATE, GluedPairs
from faying.simulation.bolts_by_force import BoltsByForce
from few_points import ELASTIC, PAIRS, N, joint


def glued(seed):
    """Pairs, and what is written out: G, B₀ and Σ."""
    plain, _ = joint(seed, ELASTIC)
    springs = plain.laws.springs
    pairs = GluedPairs.of(plain.contact.rows, springs, ByCompliance(plain.S))
    G = plain.contact.rows.toarray()
    return pairs, G, G.T @ np.diag(springs.ravel()) @ G, np.linalg.inv(plain.S)


def dense(G, K):
    """Gᵀ K G for K (n_point, 3, 3)."""
    at = (np.arange(3)[:, None] * N + np.arange(N)).T
    return sum(G[rows].T @ own @ G[rows] for rows, own in zip(at, K, strict=True))


@pytest.mark.parametrize("direct", [0, 500])
@pytest.mark.parametrize("seed", range(4))
def test_steps_are_those_of_the_whole_matrix(seed, direct, monkeypatch):
    """With any springs at some of the points, anew and with the factors of the last step."""
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", direct)
    pairs, G, _, stiffness = glued(seed)
    random = np.random.default_rng(seed)
    K = np.zeros((N, 3, 3))
    diagonal = np.arange(3)
    K[:, diagonal, diagonal] = pairs.glued.springs.T
    factors = None
    for changed in ([], [0, 3], [0, 3], [1, 2, 5], range(N)):
        other = K.copy()
        other[list(changed)] *= 0.3
        other[list(changed), 1, 0] = random.uniform(0.0, 1.0, len(changed))
        right = random.normal(size=3 * PAIRS)
        d, _, factors = pairs.step(other, right, 0.0, factors)
        exact = np.linalg.solve(stiffness + dense(G, other), right)
        # What factors in single precision leave.
        small = 10 * ACCURATE * np.abs(exact).max()
        np.testing.assert_allclose(d, exact, rtol=0, atol=small)


def test_few_closed_points_are_solved_beside_open_ones(monkeypatch):
    """What weak springs alone would hold is held at points, so that single precision does."""
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", 0)
    plain, _ = joint(1, ELASTIC)
    rows, springs = plain.contact.rows, plain.laws.springs
    random = np.random.default_rng(1)
    motions = random.normal(size=(3 * PAIRS, 2))
    S = plain.S + 1e6 * motions @ motions.T
    pairs, stiffness = GluedPairs.of(rows, springs, ByCompliance(S)), np.linalg.inv(S)
    opened = pairs.opened
    assert 0 < np.count_nonzero(opened.springs[0]) < N
    # The largest of S is 1e7 times as much.
    assert np.abs(opened.compliance).max() < 10.0
    K, diagonal = np.zeros((N, 3, 3)), np.arange(3)
    K[:2, diagonal, diagonal] = springs[:, :2].T
    right = random.normal(size=3 * PAIRS)
    d, _, factors = pairs.step(K, right, 0.0)
    assert factors.reference is opened
    exact = np.linalg.solve(stiffness + dense(rows.toarray(), K), right)
    np.testing.assert_allclose(d, exact, rtol=0, atol=10 * ACCURATE * np.abs(exact).max())


def test_pairs_less_the_springs_of_bolts():
    pairs, _, glue, stiffness = glued(0)
    random = np.random.default_rng(5)
    shapes = random.normal(size=(2, 3 * PAIRS))
    # Stiffer than both springs take away: the rest still holds.
    yields = shapes @ np.linalg.inv(stiffness) @ shapes.T + np.diag([0.5, 0.8])
    found = pairs.loosened(shapes, yields)
    rest = stiffness - shapes.T @ np.linalg.solve(yields, shapes)
    moved = random.normal(size=3 * PAIRS)
    np.testing.assert_allclose(found.resisted(moved), rest @ moved, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        found.glued.compliance, np.linalg.inv(rest + glue), rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("ratio", [0.0, 1e-13])
def test_a_singular_compliance_has_no_stiffness(ratio):
    """As of rigid bodies, and of fewer modes than pairs; soft springs beside elasticity do."""
    plain, _ = joint(0, ELASTIC)
    rows, springs = plain.contact.rows, plain.laws.springs
    shapes = np.linalg.eigh(plain.S)[1]
    sizes = np.r_[ratio, np.ones(len(shapes) - 1)]
    singular, regular = (shapes * sizes) @ shapes.T, (shapes * np.r_[1e7, sizes[1:]]) @ shapes.T
    with pytest.raises(LinAlgError, match="not positive definite"):
        GluedPairs.of(rows, springs, ByCompliance(singular))
    GluedPairs.of(rows, springs, ByCompliance(regular))


def test_points_that_feel_every_pair_are_solved_with_the_whole_matrix(monkeypatch):
    """As those of a singular compliance, whose unknowns are its shapes."""
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", 0)
    plain, _ = joint(2, ELASTIC)
    G, springs = plain.contact.rows.toarray(), plain.laws.springs
    pairs, K = GluedPairs.of(G, springs, ByCompliance(plain.S)), np.zeros((N, 3, 3))
    K[:, np.arange(3), np.arange(3)] = 0.5 * springs.T
    right = np.random.default_rng(2).normal(size=3 * PAIRS)
    exact = np.linalg.solve(np.linalg.inv(plain.S) + dense(G, K), right)
    # What factors in single precision leave.
    small = 10 * ACCURATE * np.abs(exact).max()
    np.testing.assert_allclose(pairs.step(K, right, 0.0)[0], exact, rtol=0, atol=small)


def test_contact_zones_shrink_along_normals_between_steps(monkeypatch):
    """A bolt's first increment takes fewer whole steps to the same forces."""
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", 0)
    iterations, forces = [], []
    for normal in (GluedPairs.normal, None):
        monkeypatch.setattr(GluedPairs, "normal", normal)
        # Prepared anew: pairs remember what they are along normals.
        lap = fy.lap_joint(element_size=2.5).with_friction(0.2)
        bolt = BoltsByForce(joint=lap, bolts=np.array([0]))
        pressed, _ = bolt.solve(np.array([10e3]), np.zeros(1), 0.0, None)
        iterations.append(pressed.iterations)
        forces.append(pressed.forces)
    assert iterations[0] < iterations[1]
    np.testing.assert_allclose(forces[0], forces[1], rtol=0, atol=1e-11 * forces[1].max())


def test_open_pairs_are_made_from_the_stiffness_that_is_known(monkeypatch):
    """Not from S with all of its digits, which takes another Schur complement."""
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", 0)
    contact = fy.lap_joint(element_size=5.0).with_friction(0.2).static_contact
    pairs, structure = contact.increments.pairs, contact.between.stiffness
    opened = pairs.opened
    assert "compliance" not in vars(contact.between)
    held = structure @ opened.compliance + opened.glue @ opened.compliance
    np.testing.assert_allclose(held, np.eye(len(held)), rtol=0, atol=1e-4)
