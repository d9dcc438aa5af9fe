"""Increments with fixed friction bounds against their definition, and how far a step descends."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import LinAlgError

from faying.contact import fixed_bounds
from faying.contact.fixed_bounds import LEAST_YIELD, SOLVED_RESIDUAL, FixedBounds
from faying.contact.laws_at_points import LawsAtPoints
from few_points import ELASTIC, ELASTIC_YIELD, FRICTION, LAWS, YIELD, N, apart, free, joint


def bounded(seed, laws=LAWS, size=1.0):
    """A problem about some admissible forces of a size, and its yield written out."""
    plain, _ = joint(seed, laws)
    about = plain.laws.admissible(size * (10 * free(seed + 30, shear=2.0) + 5), None)
    own = plain.steps.own
    given = YIELD if laws is LAWS else ELASTIC_YIELD
    found = np.maximum(given, LEAST_YIELD * own)
    found[1:, 3] = 1.0  # nothing moves a point without friction along its tangents
    z_free = 3 * size * free(seed)
    problem = FixedBounds(steps=plain.steps, laws=plain.laws, z_free=z_free, about=about)
    return problem, found, given * about


def admissible(trial, about):
    """Pressed, and sheared by no more than friction times what the forces so far pressed with."""
    size = np.hypot(*trial[1:])
    bound = np.where(trial[0] > 0, FRICTION * np.maximum(about[0], 0.0), 0.0)
    cut = np.minimum(1.0, bound / np.where(size > 0, size, 1.0))
    return np.vstack([np.maximum(trial[:1], 0.0), cut * trial[1:]])


@pytest.mark.parametrize(("laws", "size"), [(LAWS, 1.0), (ELASTIC, 1.0), (LAWS, 1e6)])
@pytest.mark.parametrize("seed", range(6))
def test_forces_obey_their_definition(seed, laws, size):
    problem, yielding, closed = bounded(seed, laws, size)
    x, steps = problem.solve()
    y = problem.steps.moved(x)
    trial = problem.about - (y + closed + problem.z_free) / yielding
    wrong = x - admissible(trial, problem.about)
    assert np.abs(wrong).max() <= SOLVED_RESIDUAL * np.abs(x).max()
    assert 1 <= steps <= 15


def test_what_is_solved_takes_no_step():
    """Forces that are the answer to themselves; nothing is to be found beside nothing."""
    problem, _, _ = bounded(0)
    start = problem.solve()[0]
    again = problem.laws.admissible(start, None)
    z_free = -problem.steps.moved(again) - problem.laws.closure(again)[0]
    solved = FixedBounds(steps=problem.steps, laws=problem.laws, z_free=z_free, about=again)
    x, steps = solved.solve()
    assert steps == 0
    np.testing.assert_array_equal(x, again)


def test_points_that_nothing_moves_have_a_yield_too():
    """Rigid, and nothing behind them: one is as good as any, for no force closes them."""
    plain, _ = joint()
    still = SimpleNamespace(own=np.zeros((3, N)), moved=np.zeros_like)
    laws = LawsAtPoints(contact=plain.contact)
    problem = FixedBounds(steps=still, laws=laws, z_free=free(0), about=np.zeros((3, N)))
    expected = np.where(YIELD > 0, YIELD, 1.0)
    np.testing.assert_array_equal(problem._yield, expected)


@pytest.mark.parametrize(
    ("over", "length"), [(1.0, 1.0), (0.3, 1.0), (2.0, 0.5), (4.0, 0.25), (1 / 0.7, 0.75)]
)
def test_a_step_is_as_long_as_it_descends(over, length):
    """Newton's step of a point that sticks, made too long or too short by so much.

    Its energy is least at 1 / ``over``; 0.75 is near enough to 0.7, where a half is not.
    """
    plain, about = apart(1, compliance=0.2), np.array([[1000.0], [60.0], [80.0]])
    z_free = np.array([[-200.0], [-10.0], [20.0]])
    problem = FixedBounds(steps=plain.steps, laws=plain.laws, z_free=z_free, about=about)
    answer, steps = problem.solve()
    assert steps <= 2
    away = 0.1 * about
    x, dx = answer - away, over * away
    found = problem._descending(x, problem.steps.moved(x), dx, problem.steps.moved(dx))
    assert found == length


def test_a_kink_is_found_by_halves(monkeypatch):
    """Where the slope jumps over nothing, steps are halved as often as is allowed."""
    plain, about = apart(1, compliance=0.2), np.array([[10.0], [0.0], [0.0]])
    # Pressed apart it opens at a third of the step, and its energy falls until there.
    z_free, dx = np.array([[-1.0], [0.0], [0.0]]), np.array([[0.0], [9.0], [0.0]])
    problem = FixedBounds(steps=plain.steps, laws=plain.laws, z_free=z_free, about=about)
    x = problem.solve()[0]
    y, dy = problem.steps.moved(x), problem.steps.moved(dx)
    monkeypatch.setattr(fixed_bounds, "FLAT", 0.0)
    found = problem._descending(x - 0.37 * dx, y - 0.37 * dy, dx, dy)
    assert found == pytest.approx(0.37, abs=2.0**-39)


class Stub:
    """What forces move, and steps that a test wants."""

    def __init__(self, plain, step):
        self.own, self.moved, self.wanted = plain.own, plain.moved, step

    def step(self, wrong, *_):
        return self.wanted(wrong)


def test_it_ends_where_a_step_is_singular_or_leads_uphill():
    problem, _, _ = bounded(2)
    true = problem.steps

    def singular(_):
        message = "singular"
        raise LinAlgError(message)

    for wanted in (singular, lambda wrong: 1e-3 * wrong):
        other = FixedBounds(
            steps=Stub(true, wanted), laws=problem.laws, z_free=problem.z_free, about=problem.about
        )
        x, steps = other.solve()
        assert steps == 1
        np.testing.assert_array_equal(x, problem.about)


def test_steps_that_do_nothing_end_at_last(monkeypatch):
    monkeypatch.setattr(fixed_bounds, "MOST_STEPS", 7)
    problem, _, _ = bounded(3)
    other = FixedBounds(
        steps=Stub(problem.steps, lambda wrong: -1e-9 * wrong),
        laws=problem.laws,
        z_free=problem.z_free,
        about=problem.about,
    )
    assert other.solve()[1] == 7
