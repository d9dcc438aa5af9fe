"""Friction in one step: Coulomb's law at its end and on its mean, of a few points and of one."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.contact.state import ContactState
from faying.contact.yielding import YieldingContact
from faying.exceptions import ModelError
from faying.simulation.step_contact import EndContact, MeanContact, _start
from faying.simulation.stepping import transient_solver
from few_points import ELASTIC, ELASTIC_YIELD, LAWS, PAIRS, SAME, YIELD, N, check_forces, joint
from lap_joints import tiny_lap

GAP = np.array([0.02, -0.05, 0.0, 0.03, -0.01, 0.0])


def steps_of(kind, laws, behind):
    """A scheme's contact, what displacements of pairs move at points, and S, W between points."""
    plain, G = joint(3, laws)
    root = np.random.default_rng(4).normal(size=(3 * PAIRS, 3 * PAIRS))
    R = 0.03 * root @ root.T / PAIRS if behind else None
    contact = replace(plain.contact, initial_gap=GAP, residual_compliance=R)
    rows = G.reshape(3 * N, -1)
    W = np.diag((YIELD if laws is LAWS else ELASTIC_YIELD).ravel())
    if behind:
        W = W + rows @ R @ rows.T
    return kind(CondensedContact(contact=contact, compliance=plain.S)), rows, rows @ plain.S, W


def moved_at_random(count=10):
    """Of the pairs, in two cases side by side: pressed together, sheared little and by far."""
    random = np.random.default_rng(5)
    normal = random.normal(0.8, 0.5, (count, 2, PAIRS))
    shear = np.resize([0.1, 0.2, 0.8], count)[:, None, None, None]
    shear = shear * random.normal(size=(count, 2, PAIRS, 2))
    return np.concatenate([normal[..., None], shear], axis=3).reshape(count, 2, -1)


def by_points(W, forces):
    return (W @ forces.ravel()).reshape(3, N)


def assert_same(found, expected):
    """To what an increment is solved to, over the largest."""
    atol = SAME * max(np.abs(expected).max(), 1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=atol)


def check_end(end, state, slip, x, z):
    """What a step says of its end is the law there, and the next step begins with it."""
    assert_same(end.increment.forces[0], x[0])
    assert_same(end.increment.forces[1:], x[1:])
    assert_same(end.increment.slack[0], z[0])
    assert_same(end.slip, slip)
    np.testing.assert_array_equal(state.active, x[0] > 0)
    np.testing.assert_array_equal(state.slip, end.slip)


@pytest.mark.parametrize("behind", [False, True])
@pytest.mark.parametrize("laws", [LAWS, ELASTIC])
def test_the_law_holds_at_the_end_of_steps(laws, behind):
    scheme, rows, moving, W = steps_of(EndContact, laws, behind)
    H = moving @ rows.T + W
    states, last = [ContactState(active=np.zeros(N, dtype=bool))] * 2, np.zeros((2, 3 * N))
    slips, kinds = np.zeros((2, 2, N)), np.zeros(3)
    for free in moved_at_random():
        last, ends, states = scheme.solve(free, states, last)
        for case, (x, end, state) in enumerate(
            zip(last.reshape(2, 3, N), ends, states, strict=True)
        ):
            z = by_points(H, x) + (rows @ free[case]).reshape(3, N)
            z[0] += GAP
            z[1:] -= slips[case]
            slipping, sticking = check_forces(x, z)
            kinds += [slipping.sum(), sticking.sum(), (x[0] == 0).sum()]
            slips[case] += z[1:]
            check_end(end, state, slips[case], x, z)
            assert end.dissipation == pytest.approx(-(x[1:] * z[1:]).sum(), abs=SAME)
            np.testing.assert_array_equal(state.forces, x)
            assert end.iterations >= 1
    assert kinds.min() > 5  # points that slip, stick and are open


@pytest.mark.parametrize("behind", [False, True])
def test_means_of_steps_obey_the_law_and_give_no_energy(behind):
    """z = γ₁ + W (2 λ̄ − λ₀), the law at γ₁ with the slip that leaves, and what contact stores."""
    scheme, rows, moving, W = steps_of(MeanContact, ELASTIC, behind)
    S = moving @ rows.T
    solver, contact = scheme.condensed.increments, scheme.condensed.contact
    states, last = [ContactState(active=np.zeros(N, dtype=bool))] * 2, np.zeros((2, 3, N))
    slips, before = np.zeros((2, 2, N)), np.zeros((2, 3, N))
    given, corrected, kept = np.zeros(2), 0, 0
    for number, free in enumerate(moved_at_random()):
        asked = states
        twice, ends, states = scheme.solve(free, states, last.reshape(2, -1))
        for case, (x, end, state) in enumerate(
            zip(twice.reshape(2, 3, N), ends, states, strict=True)
        ):
            moved = by_points(S, x) + (rows @ free[case]).reshape(3, N)
            moved[0] += GAP
            gamma = moved - np.vstack([np.zeros((1, N)), slips[case]])
            z = gamma + by_points(W, x - last[case])
            check_forces(x, z)
            np.testing.assert_array_equal(state.forces, x)
            y = end.increment.forces
            behind_it = np.vstack([z[:1], np.zeros((2, N))]) - by_points(W, x - last[case])
            added = behind_it + by_points(W, y)
            check_forces(y, added)
            taken = -0.5 * (x[1:] * z[1:]).sum() - (y[1:] * added[1:]).sum()
            assert end.dissipation == pytest.approx(taken, abs=SAME)
            slips[case] += z[1:] + added[1:]
            check_end(end, state, slips[case], y, added)
            # Work on the structure, stored energy and friction: never more than there was.
            stored = [0.5 * one.ravel() @ by_points(W, one).ravel() for one in (last[case], y)]
            work = 0.5 * (x * (moved - before[case])).sum()
            gained = work + stored[1] - stored[0] + end.dissipation
            assert number == 0 or gained < SAME
            given[case] += gained
            before[case] = moved
            # As the scheme forms it, to the last digit: what counts steps tells round-off.
            offset = contact.offset(asked[case].slip) - scheme._given_way(last[case])
            start = _start(solver, free[case], asked[case])
            alone = solver.solve(free[case], offset, start)
            lawful = np.abs(y - (x - last[case])).max() < SAME
            corrected, kept = corrected + (not lawful), kept + lawful
            # A second problem is solved only where the mean does not tell the end.
            assert (end.iterations > alone.iterations) == (behind and not lawful)
            last[case] = y
    assert corrected > 3
    assert kept > 1


STIFF, TANGENTIAL, FRICTION = 10.0, 5.0, 0.3
ELASTIC_POINT = Penalty(STIFF)


def one_point(normal=ELASTIC_POINT, tangential=TANGENTIAL, behind=None, compliance=None):
    """A point that nothing but its law and what is behind it yields at, unless a compliance is."""
    contact = Contact(
        relative_operator=np.eye(3),
        interpolation=sp.csr_array(np.eye(1, 3)),
        initial_gap=np.zeros(1),
        weights=np.ones(1),
        laws={"one": Coulomb(normal, FRICTION, tangential)},
        slices={"one": slice(0, 1)},
        shear=sp.csr_array(np.eye(2, 3, k=1)),
        residual_compliance=behind,
    )
    S = np.zeros((3, 3)) if compliance is None else compliance
    return CondensedContact(contact=contact, compliance=S)


def walked(scheme, way):
    """Forces in the balance, at the end, slip and energy, along displacements of one point."""
    states, last, found = [ContactState(active=np.zeros(1, dtype=bool))], np.zeros((1, 3)), []
    for free in way:
        acting, (end,), states = scheme.solve(np.array([free]), states, last)
        if isinstance(scheme, MeanContact):
            last = np.array([[*end.increment.forces[:, 0]]])
        else:
            last = acting
        found.append((acting[0], last[0], end.slip[:, 0], end.dissipation, end.iterations))
    return [np.array(column) for column in zip(*found, strict=True)]


WAY = [(-1.0, 0.0, 0.0), (-1.0, 0.3, 0.4), (-1.0, 1.2, 1.6), (-1.0, 3.0, 4.0), (-1.0, 2.4, 3.2)]
"""Pressed by 10, which holds 3 of shear or 0.6 of way; sheared by 0.5, 2, 5, 4 along (3, 4)/5."""
DIRECTION = np.array([0.6, 0.8])


def test_a_point_that_is_sheared_by_its_ends():
    acting, last, slip, taken, _ = walked(EndContact(one_point()), WAY)
    np.testing.assert_allclose(acting[:, 0], 10.0, rtol=SAME)
    shear = np.array([0.0, 2.5, 3.0, 3.0, -2.0])
    np.testing.assert_allclose(acting[:, 1:], -np.outer(shear, DIRECTION), rtol=0, atol=SAME)
    np.testing.assert_array_equal(acting, last)
    slipped = np.array([0.0, 0.0, 1.4, 4.4, 4.4])
    np.testing.assert_allclose(slip, np.outer(slipped, DIRECTION), rtol=0, atol=SAME)
    np.testing.assert_allclose(taken, [0, 0, 3 * 1.4, 3 * 3.0, 0], rtol=0, atol=10 * SAME)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_point_that_is_sheared_by_its_means(share):
    """The mean from 2.5 to where it slips is 2.75, in 0.1 of the way; then it is on the bound.

    ``share`` of the yield is behind the point, not its law; the point is the same.
    """
    stiff, shear = np.array([STIFF, TANGENTIAL]) / (1 - share)
    behind = share * np.diag([1 / STIFF, 1 / TANGENTIAL, 1 / TANGENTIAL]) if share else None
    scheme = MeanContact(one_point(Penalty(stiff), shear, behind))
    acting, last, slip, taken, _ = walked(scheme, WAY)
    # Twice the mean; pressed at once it is half of the force at the end.
    np.testing.assert_allclose(acting[:, 0], [10.0, 20.0, 20.0, 20.0, 20.0], rtol=SAME)
    np.testing.assert_allclose(last[:, 0], 10.0, rtol=SAME)
    # 2 λ̄ may be 6, so that λ̄ is 3 from 2.5 on: 3.5 at the end, which is cut to 3 there.
    twice = np.array([0.0, 2.5, 6.0, 6.0, 1.0])
    np.testing.assert_allclose(acting[:, 1:], -np.outer(twice, DIRECTION), rtol=0, atol=10 * SAME)
    ends = np.array([0.0, 2.5, 3.0, 3.0, -2.0])
    np.testing.assert_allclose(last[:, 1:], -np.outer(ends, DIRECTION), rtol=0, atol=10 * SAME)
    slipped = np.array([0.0, 0.0, 1.4, 4.4, 4.4])
    np.testing.assert_allclose(slip, np.outer(slipped, DIRECTION), rtol=0, atol=10 * SAME)
    # 1.3 at the mean of 3, where 3.5 would be at the end; 0.1 more at the 3 that is.
    lost = [0, 0, 3 * 1.3 + 3 * 0.1, 3 * 3.0, 0]
    np.testing.assert_allclose(taken, lost, rtol=0, atol=100 * SAME)


def test_a_point_that_slips_on_needs_no_second_problem(monkeypatch):
    """2 λ̄ − λ₀ is on its bound exactly, but for round-off, and obeys the law; forces are large."""
    behind = np.diag([0.05, 0.1, 0.1])
    condensed = one_point(Penalty(20.0), 10.0, behind, np.diag([0.02, 0.03, 0.03]))
    way = 1e6 * np.array([(-1.0, 0.0, 0.0), *((-1.0, 0.3 * k, 0.4 * k) for k in range(2, 12))])
    solved, solve = [], YieldingContact.solve

    def counted(solver, *given):
        if np.array_equal(solver.S, behind):
            solved.append(given)
        return solve(solver, *given)

    monkeypatch.setattr(YieldingContact, "solve", counted)
    *_, taken, _ = walked(MeanContact(condensed), way)
    assert (taken[2:] > 0).all()
    assert len(solved) == 1  # where slip begins


def test_a_smooth_point_opens_beside_one_that_sticks():
    """Its mean is nothing from 10 on, which would pull at the end; the other keeps its 2.5."""
    contact = Contact(
        relative_operator=np.eye(4),
        interpolation=sp.csr_array(np.eye(4)[[0, 3]]),
        initial_gap=np.zeros(2),
        weights=np.ones(2),
        laws={"rough": Coulomb(ELASTIC_POINT, FRICTION, TANGENTIAL), "smooth": ELASTIC_POINT},
        slices={"rough": slice(0, 1), "smooth": slice(1, 2)},
        shear=sp.csr_array(np.eye(4)[1:3]),
    )
    scheme = MeanContact(CondensedContact(contact=contact, compliance=np.zeros((4, 4))))
    states, last = [ContactState(active=np.ones(2, dtype=bool))], np.zeros((1, 6))
    for way in ([-1.0, 0.3, 0.4, -1.0], [-1.0, 0.3, 0.4, 0.5]):
        _, (end,), states = scheme.solve(np.array([way]), states, last)
        last = np.array([end.increment.forces.ravel()])
    np.testing.assert_allclose(last[0], [10.0, 0.0, -1.5, 0.0, -2.0, 0.0], rtol=0, atol=10 * SAME)
    np.testing.assert_allclose(end.increment.slack[0], [0.0, 0.5], rtol=0, atol=SAME)


@pytest.mark.parametrize(
    ("normal", "tangential"), [(Hard(), TANGENTIAL), (ELASTIC_POINT, np.inf), (Hard(), np.inf)]
)
def test_a_mean_tells_no_force_of_a_rigid_point(normal, tangential):
    with pytest.raises(ModelError, match="need elastic contact: a hard point has no force"):
        MeanContact(one_point(normal, tangential))


def test_steps_of_many_pairs_begin_with_the_points_that_bolts_press_on(monkeypatch):
    """As the joint at rest does; few pairs, which are factorized whole, ask nothing of it."""
    joint = tiny_lap()
    joint = joint.with_bolt_forces({"bolt": 8e3}).with_friction(0.2)
    few = transient_solver(joint, step=1e-5).condensed.increments.pairs.glued.springs
    assert few.all()
    monkeypatch.setattr("faying.contact.glued_pairs.DIRECT", 0)
    steps = transient_solver(replace(joint, structure=replace(joint.structure)), step=1e-5)
    pairs = steps.condensed.increments.pairs
    at_rest = steps.system.static_contact.increments.pairs
    np.testing.assert_array_equal(pairs.glued.springs, at_rest.glued.springs)
    assert not pairs.glued.springs.all()
    assert pairs.structure[0, 0] > 1.01 * at_rest.structure[0, 0]  # inertia stiffens a step
