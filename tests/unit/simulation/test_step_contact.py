"""Contact forces of one step against complementarity problems solved by trying every active set."""

from itertools import product

import numpy as np
import pytest
import scipy.sparse as sp

from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import normal_law
from faying.contact.pressing import PressingContact
from faying.contact.state import ContactState
from faying.contact.yielding import YieldingContact
from faying.simulation.step_contact import EndContact, MeanContact

N = 4
WEIGHTS = np.array([2.0, 0.5, 1.0, 3.0])
GAP = np.array([0.01, -0.02, 0.0, 0.05])
RANDOM = np.random.default_rng(11)
INTERPOLATION = np.eye(N) + 0.2 * RANDOM.random((N, N))


def definite(size):
    root = RANDOM.normal(size=(N, N))
    return size * (root @ root.T + 0.1 * np.eye(N))


COMPLIANCE, RESIDUAL = definite(1e-2), definite(3e-3)
SOFT, STIFF = normal_law(40.0), normal_law(400.0)
HARD = normal_law(np.inf)


def condensed(laws, residual=None, compliance=COMPLIANCE):
    contact = Contact(
        relative_operator=np.eye(N),
        interpolation=sp.csr_array(INTERPOLATION),
        initial_gap=GAP,
        weights=WEIGHTS,
        laws={"one": laws[0], "two": laws[1]},
        slices={"one": slice(0, 2), "two": slice(2, N)},
        residual_compliance=residual,
    )
    return CondensedContact(contact=contact, compliance=compliance)


def solved(H, g):
    """The one λ ≥ 0 with H λ + g ≥ 0 and no force where it is open."""
    for closed in product([False, True], repeat=N):
        at, forces = np.flatnonzero(closed), np.zeros(N)
        forces[at] = np.linalg.solve(H[np.ix_(at, at)], -g[at])
        slack = H @ forces + g
        slack[at] = 0.0
        if (forces >= 0).all() and (slack >= 0).all():
            return forces, slack
    raise AssertionError


def yielding(laws, residual):
    """W = D + N R Nᵀ."""
    penalties = np.repeat([law.penalty for law in laws], 2)
    behind = np.zeros((N, N)) if residual is None else residual
    return np.diag(1 / (penalties * WEIGHTS)) + INTERPOLATION @ behind @ INTERPOLATION.T


def cases(W, count=24):
    """Free displacements, and forces at the start that some point had and some had not."""
    random = np.random.default_rng(5)
    size = np.geomspace(3e-3, 0.3, count)[:, None]
    free = size * random.normal(size=(count, N))
    last = np.array([solved(W, g)[0] for g in size * random.normal(size=(count, N))])
    return free, last, [ContactState(active=row > 0) for row in last]


LAWS = [(SOFT, STIFF), (SOFT, HARD), (HARD, HARD)]
# Of sums of a few products; the conditions of these matrices are below 1e4.
SAME = {"rel": 1e-10, "abs": 1e-11}


@pytest.mark.parametrize("residual", [None, RESIDUAL])
@pytest.mark.parametrize("laws", LAWS)
def test_the_law_at_the_end_of_a_step(laws, residual):
    problem = condensed(laws, residual)
    free, last, states = cases(np.eye(N))
    acting, ends, after = EndContact(problem).solve(free, states, last)
    H = INTERPOLATION @ COMPLIANCE @ INTERPOLATION.T + yielding(laws, residual)
    for relative, force, end, state in zip(free, acting, ends, after, strict=True):
        forces, slack = solved(H, INTERPOLATION @ relative + GAP)
        assert force == pytest.approx(forces, **SAME)
        assert end.increment.forces[0] == pytest.approx(forces, **SAME)
        assert end.increment.slack[0] == pytest.approx(slack, **SAME)
        assert (state.active == (forces > 0)).all()


@pytest.mark.parametrize("residual", [None, RESIDUAL])
@pytest.mark.parametrize("laws", LAWS)
def test_the_mean_over_a_step_and_the_law_at_its_end(laws, residual):
    """s = γ₁ + W (2 λ̄ − λ₀), and the contact law at γ₁; hard points have their mean instead."""
    problem, W = condensed(laws, residual), yielding(laws, residual)
    free, last, states = cases(W + 1e-3 * np.eye(N))
    acting, ends, after = MeanContact(problem).solve(free, states, last)
    S = INTERPOLATION @ COMPLIANCE @ INTERPOLATION.T
    corrected = 0
    for i, (relative, before, end, state) in enumerate(zip(free, last, ends, after, strict=True)):
        gap = INTERPOLATION @ relative + GAP
        twice, slack = solved(S + W, gap - W @ before)
        at_end = gap + S @ twice
        hard = (np.diag(W) == 0) if residual is None else np.zeros(N, dtype=bool)
        forces = twice / 2
        if not hard.all():
            own = ~hard
            D = W + np.diag(hard.astype(float))  # hard points yield nowhere else: kept apart
            lawful, open_by = solved(D, np.where(hard, 1.0, at_end))
            forces, slack = np.where(own, lawful, forces), np.where(own, open_by, slack)
        corrected += bool(np.abs(forces - (twice - before)).max() > 1e-6)
        assert acting[i] == pytest.approx(twice, **SAME)
        assert end.increment.forces[0] == pytest.approx(forces, **SAME)
        assert end.increment.slack[0] == pytest.approx(slack, **SAME)
        assert (state.active == (end.increment.forces[0] > 0)).all()
    assert corrected > 3  # forces at the end that the mean alone does not tell


def test_all_linear_systems_of_a_step_are_counted():
    """Those of the mean, and those of the law at the end where that is asked too."""
    problem = condensed((SOFT, STIFF), RESIDUAL)
    W = yielding((SOFT, STIFF), RESIDUAL)
    free, last, states = cases(W)
    scheme = MeanContact(problem)
    _, ends, _ = scheme.solve(free, states, last)
    alone, offset = [], problem.contact.offset()
    for relative, before in zip(free, last, strict=True):
        # As the scheme forms it, to the last digit: what counts steps tells round-off.
        way = scheme._given_way(np.vstack([before, np.zeros((2, N))]))
        alone.append(problem.increments.solve(relative, offset - way))
    more = np.array(
        [end.iterations - mean.iterations for end, mean in zip(ends, alone, strict=True)]
    )
    asked = np.array(
        [
            np.abs(end.increment.forces[0] - (mean.forces[0] - before)).max() > 1e-6
            for end, mean, before in zip(ends, alone, last, strict=True)
        ]
    )
    assert asked.any()
    assert not asked.all()
    assert (more[asked] > 0).all()
    assert (more[~asked] == 0).all()


@pytest.mark.parametrize(("share", "counts"), [(0.9e-9, False), (1.1e-9, True)])
def test_residual_compliance_of_round_off_is_none_where_contact_is_hard(share, counts):
    """1e-9 of the whole on the diagonal; below it hard points have their mean."""
    residual = share * np.diag(np.diag(COMPLIANCE).max() * np.array([1.0, 0.1, 0.1, 0.1]))
    problem = condensed((HARD, HARD), residual)
    free = -0.3 * np.ones((1, N))
    last = np.full((1, N), 2.0)
    acting, (end,), _ = MeanContact(problem).solve(free, [ContactState(active=last[0] > 0)], last)
    half = end.increment.forces[0] == pytest.approx(acting[0] / 2, **SAME)
    assert half is not counts
    soft = condensed((SOFT, HARD), residual)
    acting, (end,), _ = MeanContact(soft).solve(free, [ContactState(active=last[0] > 0)], last)
    assert (end.increment.forces[0][2:] == pytest.approx(acting[0, 2:] / 2, **SAME)) is not counts


def test_forces_are_unknowns_where_contact_is_hard_alone():
    assert isinstance(condensed((SOFT, STIFF)).increments, YieldingContact)
    assert isinstance(condensed((SOFT, HARD)).increments, PressingContact)
