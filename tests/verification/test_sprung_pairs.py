"""Contact problems solved from a similar one, against the same problems solved anew."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from faying.contact.pair_space import PairSpace, solve_between_pairs
from faying.contact.pivoting import solve_complementarity
from faying.contact.sprung_pairs import InaccurateError, SprungPairs

N_PAIR, N_POINT = 60, 240
STIFFNESS = 1e3


def parts(rng, *, stiffness=STIFFNESS):
    """S of condition 100, an interpolation with four pairs a point, and penalty springs."""
    shapes = la.qr(rng.standard_normal((N_PAIR, N_PAIR)))[0]
    S = (shapes * np.geomspace(1.0, 1e-2, N_PAIR)) @ shapes.T
    columns = np.array([rng.choice(N_PAIR, 4, replace=False) for _ in range(N_POINT)])
    shares = rng.uniform(0.05, 1.0, (N_POINT, 4))
    shares /= shares.sum(axis=1, keepdims=True)
    rows = np.repeat(np.arange(N_POINT), 4)
    N = sp.csr_array((shares.ravel(), (rows, columns.ravel())), shape=(N_POINT, N_PAIR))
    return {"N": N, "S": (S + S.T) / 2, "D": rng.uniform(0.1, 1.0, N_POINT) / stiffness}


def drifting_gaps(rng, N, count):
    """Free gaps of a joint that opens here and closes there, most of it pressed."""
    start, end = (N @ (rng.standard_normal(N.shape[1]) - 1.0) for _ in range(2))
    rough = 1e-2 * rng.standard_normal(len(start))
    return [(1 - t) * start + t * end + rough for t in np.linspace(0.0, 0.5, count)]


def test_a_drifting_contact_is_that_solved_anew():
    rng = np.random.default_rng(0)
    given = parts(rng)
    space, active = PairSpace(**given), None
    for gap in drifting_gaps(rng, given["N"], 60):
        found = solve_between_pairs(space, gap, active)
        anew = solve_complementarity(PairSpace(**given), gap)
        # Closed to 1e-11 of the largest force; the condition of S + D adds a digit.
        small = 1e-10 * anew.forces.max()
        np.testing.assert_allclose(found.forces, anew.forces, rtol=0, atol=small)
        np.testing.assert_allclose(found.slack, anew.slack, rtol=0, atol=small * given["D"].max())
        assert (found.forces >= 0).all()
        assert (found.slack >= 0).all()
        assert not (found.slack * found.forces).any()
        active = found.active
    assert space._held.pairs is not None
    assert not space._held.useless


def test_many_systems_are_not_made_anew():
    rng = np.random.default_rng(1)
    given = parts(rng)
    gaps = drifting_gaps(rng, given["N"], 200)
    pairs = SprungPairs(**given, own=PairSpace(**given).diagonal)
    active, renewed, systems = solve_complementarity(PairSpace(**given), gaps[0]).active, 0, 0
    for gap in gaps:
        if not pairs.near(active):
            pairs.renew(active)
            renewed += 1
        found = pairs.solve(gap, active)
        assert found is not None
        active, systems = found.active, systems + found.iterations
    assert 0 < renewed < 40
    assert systems >= 200


@pytest.mark.parametrize("n_changed", [0, 1, 7, 14])
def test_points_that_changed_sides(n_changed):
    rng = np.random.default_rng(2)
    given = parts(rng)
    pairs = SprungPairs(**given, own=PairSpace(**given).diagonal)
    active = rng.random(N_POINT) < 0.6
    pairs.renew(active)
    active[rng.choice(N_POINT, n_changed, replace=False)] ^= True
    gap = rng.standard_normal(N_POINT)
    changed = (active ^ pairs._inside).nonzero()[0]
    moved = pairs._with_changed(pairs._alone(gap), gap, changed, active)
    N, S, D = given["N"].toarray()[active], given["S"], given["D"][active]
    forces = la.solve(N @ S @ N.T + np.diag(D), -gap[active])
    # Round-off of springs a thousand times as stiff as S, taken away and put on again.
    np.testing.assert_allclose(moved, S @ N.T @ forces, rtol=0, atol=1e-10 * np.abs(moved).max())


def test_a_far_set_is_left_to_others():
    rng = np.random.default_rng(3)
    given = parts(rng)
    pairs = SprungPairs(**given, own=PairSpace(**given).diagonal)
    active = np.zeros(N_POINT, dtype=bool)
    pairs.renew(active)
    assert pairs.solve(-np.ones(N_POINT), active) is None


def test_a_singular_compliance_is_solved_by_factorizations():
    rng = np.random.default_rng(4)
    given = parts(rng)
    shapes = rng.standard_normal((N_PAIR, 5))
    given["S"] = shapes @ shapes.T
    with pytest.raises(la.LinAlgError, match="singular compliance"):
        SprungPairs(**given, own=np.ones(N_POINT))
    space, active = PairSpace(**given), None
    for gap in drifting_gaps(rng, given["N"], 5):
        found = solve_between_pairs(space, gap, active)
        anew = solve_complementarity(PairSpace(**given), gap)
        # Round-off times the stiffness.
        small = 1e-9 * max(anew.forces.max(), 1.0)
        np.testing.assert_allclose(found.forces, anew.forces, rtol=0, atol=small)
        active = found.active
    assert space._held.useless


def test_forces_that_do_not_become_exact_are_refused():
    rng = np.random.default_rng(5)
    given = parts(rng)
    pairs = SprungPairs(**given, own=PairSpace(**given).diagonal)
    gap = drifting_gaps(rng, given["N"], 2)[0]
    active = solve_complementarity(PairSpace(**given), gap).active
    pairs.renew(active)
    pairs._E = pairs._E * (1 + 1e-2)  # as if round-off had spoiled it
    with pytest.raises(InaccurateError):
        pairs._refined(np.zeros(N_POINT), gap, np.empty(0, dtype=int), active)
