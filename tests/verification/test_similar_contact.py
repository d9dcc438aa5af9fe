"""Contact problems solved from a similar one, against the same problems solved anew."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from faying.contact.active_set import solve_complementarity
from faying.contact.elastic import FEW_PAIRS, ElasticContact
from faying.contact.pair_space import PairSpace
from faying.contact.state import ContactState
from faying.contact.supported_pairs import InaccurateError, SupportedPairs

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


def solver(given):
    space = PairSpace(**given)
    return ElasticContact(space=space, pairs=supported(given))


def supported(given):
    return SupportedPairs(**given, own=PairSpace(**given).diagonal)


def check_drift(given, gaps, accuracy):
    """Solve in sequence and compare with problems solved anew."""
    contact, state = solver(given), None
    for gap in gaps:
        found, state = contact.solve(gap, state)
        anew = solve_complementarity(PairSpace(**given), gap)
        small = accuracy * max(anew.forces.max(), 1.0)
        np.testing.assert_allclose(found.forces, anew.forces, rtol=0, atol=small)
        np.testing.assert_allclose(found.slack, anew.slack, rtol=0, atol=small * given["D"].max())
        assert (found.forces >= 0).all()
        assert (found.slack >= 0).all()
        assert not (found.slack * found.forces).any()
    return state


def test_a_drifting_contact_is_that_solved_anew():
    rng = np.random.default_rng(0)
    given = parts(rng)
    # Closed to 1e-11 of the largest force; the condition of S + D adds a digit.
    state = check_drift(given, drifting_gaps(rng, given["N"], 60), 1e-10)
    assert state.supported is not None


def test_a_singular_compliance_is_solved_from_its_shapes():
    rng = np.random.default_rng(4)
    given = parts(rng)
    shapes = rng.standard_normal((N_PAIR, 5))
    given["S"] = shapes @ shapes.T
    # Round-off times the stiffness.
    state = check_drift(given, drifting_gaps(rng, given["N"], 5), 1e-9)
    assert state.supported is not None


def test_the_same_call_gives_the_same_digits_whatever_ran_before():
    rng = np.random.default_rng(7)
    given = parts(rng)
    gaps = drifting_gaps(rng, given["N"], 12)
    contact = solver(given)
    _, start = contact.solve(gaps[0])
    first, after = contact.solve(gaps[5], start)
    for gap in gaps:  # fills what the factorization has seen
        contact.solve(gap, start)
    again, _ = contact.solve(gaps[5], start)
    np.testing.assert_array_equal(first.forces, again.forces)
    # A state that was stored as its masks goes on with the same digits.
    stored = ContactState(active=after.active, supported=after.supported, steady=after.steady)
    kept, fresh = solver(given).solve(gaps[6], after), solver(given).solve(gaps[6], stored)
    np.testing.assert_array_equal(kept[0].forces, fresh[0].forces)


def test_many_systems_share_a_factorization():
    rng = np.random.default_rng(1)
    given = parts(rng)
    pairs, state = supported(given), None
    contact = ElasticContact(space=PairSpace(**given), pairs=pairs)
    renewed, systems = 0, 0
    for gap in drifting_gaps(rng, given["N"], 200):
        before = None if state is None else state.factor
        found, state = contact.solve(gap, state)
        renewed, systems = renewed + (state.factor is not before), systems + found.iterations
    assert 0 < renewed < 40
    assert systems >= 200


@pytest.mark.parametrize("n_changed", [0, 1, 7, 14])
def test_points_that_changed_sides(n_changed):
    rng = np.random.default_rng(2)
    given = parts(rng)
    pairs = supported(given)
    active = rng.random(N_POINT) < 0.6
    support = pairs.supported(active)
    active[rng.choice(N_POINT, n_changed, replace=False)] ^= True
    gap = rng.standard_normal(N_POINT)
    changed = (active ^ support.closed).nonzero()[0]
    moved = pairs._changed(changed, active, support).moved(pairs._alone(gap, support), gap)
    N, S, D = given["N"].toarray()[active], given["S"], given["D"][active]
    forces = la.solve(N @ S @ N.T + np.diag(D), -gap[active])
    # Round-off of springs a thousand times as stiff as S, taken away and put on again.
    np.testing.assert_allclose(moved, S @ N.T @ forces, rtol=0, atol=1e-10 * np.abs(moved).max())


def test_large_interfaces_are_solved_anew_until_problems_are_similar():
    rng = np.random.default_rng(3)
    n_pair = FEW_PAIRS + 20
    N = sp.eye_array(n_pair, format="csr")
    S = np.eye(n_pair) + 0.1 / n_pair
    given = {"N": N, "S": S, "D": np.full(n_pair, 0.1)}
    contact = solver(given)
    gap = rng.standard_normal(n_pair) - 1.0
    _, cold = contact.solve(gap)
    assert cold.supported is None
    _, once = contact.solve(gap, cold)
    assert once.supported is None
    assert once.steady
    _, twice = contact.solve(gap, once)
    assert twice.supported is not None


@pytest.mark.parametrize(("touched", "pays"), [(0.12, False), (0.13, True)])
def test_pairs_are_supported_where_an_eighth_of_them_touches(touched, pays):
    n_pair = FEW_PAIRS + 100
    given = {"N": sp.eye_array(n_pair, format="csr"), "S": np.eye(n_pair), "D": np.ones(n_pair)}
    contact, state = solver(given), None
    gap = np.where(np.arange(n_pair) < touched * n_pair, -1.0, 1.0)
    for _ in range(3):
        _, state = contact.solve(gap, state)
    assert (state.supported is not None) is pays


def test_forces_that_do_not_become_exact_are_refused():
    rng = np.random.default_rng(5)
    given = parts(rng)
    pairs = supported(given)
    gap = drifting_gaps(rng, given["N"], 2)[0]
    active = solve_complementarity(PairSpace(**given), gap).active
    support = pairs.supported(active)
    spoiled = replace(support, E=support.E * (1 + 1e-2))  # as if by round-off
    nothing = pairs._changed(np.empty(0, dtype=int), active, spoiled)
    with pytest.raises(InaccurateError):
        pairs._refined(np.zeros(N_POINT), gap, nothing, active, spoiled)
