"""The condensed contact problem against independent solvers, and where simpler methods fail."""

import itertools

import numpy as np
import pytest
import scipy.linalg as la
import scipy.optimize

from faying.contact import active_set
from faying.contact.dense_points import DensePoints, contact_problem
from faying.exceptions import ConvergenceError, ModelError


def random_flexibility(rng, n, condition=1e3):
    vectors = la.qr(rng.standard_normal((n, n)))[0]
    return (vectors * np.geomspace(1.0, 1 / condition, n)) @ vectors.T


def by_nnls(H, g_free):
    """min ‖Lᵀλ + L⁻¹g‖² over λ ≥ 0 is the same problem, solved by Lawson and Hanson's method."""
    factor = la.cholesky(H, lower=True)
    target = -la.solve_triangular(factor, g_free, lower=True)
    return scipy.optimize.nnls(factor.T, target, maxiter=10**5)[0]


@pytest.mark.parametrize("n", [1, 2, 3, 5, 10, 30, 80])
@pytest.mark.parametrize("seed", range(5))
def test_forces_are_those_of_nonnegative_least_squares(n, seed):
    rng = np.random.default_rng([n, seed])
    H, g_free = random_flexibility(rng, n), rng.standard_normal(n)
    solution = contact_problem(H, g_free).solve()
    # NNLS works with L, so its error is round-off times the condition 1e3.
    expected = by_nnls(H, g_free)
    np.testing.assert_allclose(
        solution.forces, expected, rtol=0, atol=1e-9 * max(1.0, expected.max())
    )
    np.testing.assert_array_equal(solution.active, solution.forces > 0)


@pytest.mark.parametrize("seed", range(10))
def test_any_start_ends_at_the_same_forces(seed):
    rng = np.random.default_rng(seed)
    n = 40
    H, g_free = random_flexibility(rng, n), rng.standard_normal(n)
    bare = contact_problem(H, g_free)
    cold = bare.solve()
    for start in (np.zeros(n, bool), np.ones(n, bool), rng.random(n) < 0.5, cold.active):
        warm = bare.solve(active=start)
        np.testing.assert_array_equal(warm.active, cold.active)
        # The same linear system, solved from another factorization: round-off times condition 1e3.
        np.testing.assert_allclose(warm.forces, cold.forces, rtol=0, atol=1e-12 * cold.forces.max())
    assert bare.solve(active=cold.active).iterations == 1


def test_start_is_left_as_it_was():
    start = np.array([True, True])
    contact_problem(np.eye(2), np.array([1.0, -1.0])).solve(active=start)
    np.testing.assert_array_equal(start, [True, True])


# Found by search over integer matrices: exchanging all wrong signs at once (semismooth Newton)
# returns to an earlier active set although H is symmetric positive definite.
CYCLES = [
    ([[27, 24, -18], [24, 22, -15], [-18, -15, 14]], [2, 1, -2]),
    ([[36, -6, 34], [-6, 3, -4], [34, -4, 34]], [-5, 3, -1]),
    ([[19, -9, -7], [-9, 25, 18], [-7, 18, 13]], [-3, 1, 1]),
]


def plain_exchange_cycles(H, g_free, active):
    seen = set()
    while active.tobytes() not in seen:
        seen.add(active.tobytes())
        forces = np.zeros(len(g_free))
        forces[active] = np.linalg.solve(H[np.ix_(active, active)], -g_free[active])
        wrong = np.where(active, forces < 0, H @ forces + g_free < 0)
        if not wrong.any():
            return False
        active = active ^ wrong
    return True


@pytest.mark.parametrize(("H", "g_free"), CYCLES)
def test_solves_where_semismooth_newton_cycles(H, g_free):
    H, g_free = np.array(H, dtype=float), np.array(g_free, dtype=float)
    start = np.zeros(3, dtype=bool)
    assert plain_exchange_cycles(H, g_free, start)
    solution = contact_problem(H, g_free).solve(active=start)
    # Round-off times the condition, which stays below 1e5.
    np.testing.assert_allclose(solution.forces, by_nnls(H, g_free), rtol=0, atol=1e-10)


@pytest.mark.parametrize("seed", range(5))
def test_solves_many_cycles_at_once(seed):
    rng = np.random.default_rng(seed)
    blocks = [CYCLES[i] for i in rng.integers(0, len(CYCLES), 12)]
    H = la.block_diag(*(np.array(H, dtype=float) for H, _ in blocks))
    g_free = np.concatenate([np.array(g, dtype=float) for _, g in blocks])
    solution = contact_problem(H, g_free).solve(active=np.zeros(36, dtype=bool))
    # Blocks do not know of each other: each has its own solution, to round-off times condition.
    alone = [by_nnls(np.array(H, dtype=float), np.array(g, dtype=float)) for H, g in blocks]
    np.testing.assert_allclose(solution.forces, np.concatenate(alone), rtol=0, atol=1e-10)


@pytest.mark.parametrize("n", [3, 10, 25, 80])
def test_interior_points_alone_find_the_solution(n, monkeypatch):
    monkeypatch.setattr(active_set, "BLOCK_ATTEMPTS", -1)
    for seed in range(5):
        rng = np.random.default_rng([n, seed])
        H, g_free = random_flexibility(rng, n), rng.standard_normal(n)
        forces = contact_problem(H, g_free).solve(active=rng.random(n) < 0.5).forces
        # As above.
        np.testing.assert_allclose(
            forces, by_nnls(H, g_free), rtol=0, atol=1e-9 * max(1, forces.max())
        )


@pytest.mark.parametrize("attempts", [0, 1])
@pytest.mark.parametrize(("H", "g_free"), CYCLES)
def test_interior_points_end_where_exchanges_cycle(H, g_free, attempts, monkeypatch):
    """Whatever the order of the points and the start: in 9 systems, besides exchanges."""
    monkeypatch.setattr(active_set, "BLOCK_ATTEMPTS", attempts)
    H, g_free = np.array(H, dtype=float), np.array(g_free, dtype=float)
    expected = by_nnls(H, g_free)
    for order in map(list, itertools.permutations(range(3))):
        problem = contact_problem(H[np.ix_(order, order)], g_free[order])
        for start in itertools.product([False, True], repeat=3):
            found = problem.solve(active=np.array(start))
            # As above.
            np.testing.assert_allclose(found.forces, expected[order], rtol=0, atol=1e-10)
            assert found.iterations <= 12 + 3 * attempts


@pytest.mark.parametrize("n_points", [200, 800])
def test_more_hard_points_than_displacements_take_no_more_systems(n_points):
    """Points on a plate between few nodes, on a back that is curved: gaps nearly depend."""
    nodes, at = np.linspace(0, 1, 60), np.linspace(0, 1, n_points)
    hats = np.maximum(0.0, 1.0 - np.abs(at[:, None] - nodes) * 59)
    N = np.hstack([hats * np.cos(at)[:, None], hats * np.sin(at)[:, None]])
    S = np.exp(-10.0 * np.abs(nodes[:, None] - nodes)) + np.eye(60)
    H = N @ np.kron(np.eye(2), S) @ N.T + 1e-10 * np.eye(n_points)
    g_free = 0.3 + np.cos(9 * at) + 0.1 * np.sin(200 * at)
    found = contact_problem(H, g_free).solve()
    assert found.iterations <= 60
    gap = H @ found.forces + g_free
    # Round-off 1e-16 of forces up to 1e3.
    assert gap.min() > -1e-11
    assert np.abs(gap[found.forces > 0]).max() < 1e-11


def redundant_problem(rng, n, rank):
    """Hard contact with more points than normal displacements; g = Bᵀc keeps it solvable."""
    B = rng.standard_normal((rank, n))
    c = rng.standard_normal(rank)
    return B, c, B.T @ B, B.T @ c


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize(("n", "rank"), [(4, 2), (12, 5), (40, 20)])
def test_redundant_hard_contact(n, rank, seed):
    B, c, H, g_free = redundant_problem(np.random.default_rng([n, seed]), n, rank)
    solution = contact_problem(H, g_free).solve()
    expected = scipy.optimize.nnls(B, -c, maxiter=10**5)[0]
    # Forces are not unique but what they do is; the proximal iteration closes gaps to 1e-13.
    np.testing.assert_allclose(B @ solution.forces, B @ expected, rtol=0, atol=1e-9)
    assert solution.forces.min() >= 0
    assert (H @ solution.forces + g_free).min() > -1e-11
    assert solution.forces @ (H @ solution.forces + g_free) < 1e-10


def test_redundant_points_share_as_a_stiff_penalty_would():
    # Two identical points: only the sum of their forces is determined.
    H = np.array([[2.0, 2.0], [2.0, 2.0]])
    solution = contact_problem(H, np.array([-1.0, -1.0])).solve()
    # The proximal term is 1e-7 of H, so round-off 1e-16 may tilt the sharing by 1e-9.
    np.testing.assert_allclose(solution.forces, [0.25, 0.25], rtol=1e-8)


def test_no_points():
    solution = contact_problem(np.empty((0, 0)), np.empty(0)).solve()
    assert solution.forces.shape == solution.slack.shape == (0,)


@pytest.mark.parametrize(("gap", "force", "slack"), [(-3.0, 1.5, 0), (3.0, 0, 3.0), (0, 0, 0)])
def test_one_point(gap, force, slack):
    solution = contact_problem(np.array([[2.0]]), np.array([gap])).solve()
    assert solution.forces[0] == pytest.approx(force, rel=1e-15)  # round-off
    assert solution.slack.tolist() == [slack]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_refuses_numbers_that_are_none(bad):
    with pytest.raises(ModelError, match="gap without contact forces holds NaN"):
        contact_problem(np.eye(2), np.array([bad, 1.0]))
    with pytest.raises(ModelError, match="flexibility holds NaN"):
        contact_problem(np.array([[1.0, bad], [bad, 1.0]]), np.array([-1.0, 1.0]))


def test_refuses_a_shape_that_does_not_fit():
    with pytest.raises(ModelError, match="one row per gap"):
        contact_problem(np.eye(3), np.zeros(2))


@pytest.mark.parametrize("H", [[[0.0]], [[-1.0]], [[1.0, 2.0], [2.0, 1.0]]])
def test_refuses_a_flexibility_that_is_not_semidefinite(H):
    with pytest.raises(ConvergenceError, match="not positive semidefinite"):
        contact_problem(np.array(H), -np.ones(len(H))).solve(active=np.ones(len(H), bool))


def test_refuses_points_that_cannot_be_parted():
    # Pushing one point apart pushes the other together: no forces close both gaps.
    with pytest.raises(ConvergenceError, match="not closed"):
        contact_problem(np.array([[1.0, -1.0], [-1.0, 1.0]]), -np.ones(2)).solve()


def test_a_joint_pressed_everywhere_takes_one_system():
    """Without a better start the points that overlap are closed, and no others."""
    flexibility = np.diag([1.0, 2.0, 3.0])
    pressed = contact_problem(flexibility, np.array([-1.0, -2.0, -0.5])).solve()
    assert pressed.iterations == 1
    assert pressed.active.all()
    mixed = contact_problem(flexibility, np.array([-1.0, 0.5, 2.0])).solve()
    assert mixed.iterations == 1
    np.testing.assert_array_equal(mixed.active, [True, False, False])


def test_surfaces_that_just_touch_are_open():
    touching = contact_problem(np.eye(2), np.array([0.0, -1.0])).solve()
    np.testing.assert_array_equal(touching.active, [False, True])


@pytest.mark.parametrize("H", [np.eye(2), np.array([[2.0, 2.0], [2.0, 2.0]])])
@pytest.mark.parametrize("closed", [False, True])
def test_a_joint_that_nothing_presses_stays_as_it_starts(H, closed):
    """Forces and gaps of exactly zero are right on either side, of redundant points too."""
    start = np.full(2, closed)
    found = contact_problem(H, np.zeros(2)).solve(active=start)
    np.testing.assert_array_equal(found.active, start)
    np.testing.assert_array_equal([found.forces, found.slack], np.zeros((2, 2)))


@pytest.mark.parametrize("share", [1e-14, -1e-14])
@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
def test_forces_below_round_off_do_not_open_a_point(unit, share):
    """1e-14 of the gap is less than a factorization leaves, in any unit of compliance."""
    H = unit * np.array([[1.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1.0]])
    g_free = np.append(-H[:2, :2] @ [1.0, share], 0.0)
    found = contact_problem(H, g_free).solve(active=np.array([True, True, False]))
    assert found.iterations == 1
    np.testing.assert_array_equal(found.active, [True, True, False])
    assert found.forces.min() >= 0


def test_redundant_points_beside_one_that_nothing_moves():
    """A point held on both sides has no compliance: it keeps its gap, and disturbs no other."""
    H = np.array([[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
    found = contact_problem(H, np.array([-1.0, -1.0, 0.0])).solve()
    # As above: round-off over the proximal term.
    np.testing.assert_allclose(found.forces, [0.25, 0.25, 0.0], rtol=1e-8)
    np.testing.assert_allclose(found.slack, 0.0, atol=1e-12)


def test_redundant_points_that_touch_beside_one_that_is_open():
    H = np.array([[2.0, 2.0, 1.0], [2.0, 2.0, 1.0], [1.0, 1.0, 2.0]])
    found = contact_problem(H, np.array([-1.0, -1.0, 0.2])).solve()
    np.testing.assert_allclose(found.forces, [0.25, 0.25, 0.0], rtol=1e-8)
    # The open gap: 0.2 and what half a unit of force adds; closed ones are closed to 1e-13.
    np.testing.assert_allclose(found.slack, [0.0, 0.0, 0.7], atol=1e-12)
    assert found.slack.min() >= 0


@pytest.mark.parametrize("unit", [2.0**-30, 2.0**20])
def test_redundant_hard_contact_in_other_units(unit):
    _, _, H, g_free = redundant_problem(np.random.default_rng(3), 12, 5)
    plain = contact_problem(H, g_free).solve()
    scaled = contact_problem(H, unit * g_free).solve()
    # Powers of two scale without rounding, so every step is the same.
    np.testing.assert_array_equal(scaled.forces, unit * plain.forces)
    assert scaled.iterations == plain.iterations


def test_all_linear_systems_are_counted(monkeypatch):
    """Those of redundant contact too, which solves many problems that are not."""
    answered, closing = [], DensePoints.closing

    def counted(*arguments):
        answer = closing(*arguments)
        answered.append(answer)
        return answer

    monkeypatch.setattr(DensePoints, "closing", counted)
    _, _, H, g_free = redundant_problem(np.random.default_rng(3), 12, 5)
    # All points at once are singular, so that nothing is answered before they are regularized.
    found = contact_problem(H, g_free).solve(active=np.ones(12, dtype=bool))
    assert found.iterations == len(answered) > 1
