"""Increments with friction that nobody chose: solved to the residual promised, or refused."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.contact import augmented
from faying.digits import SOLVED
from random_friction import Joints, outcomes


@pytest.fixture(scope="module")
def joints():
    return Joints()


@pytest.mark.long
@settings(max_examples=12)
@given(index=st.integers(0, 10**6))
def test_increments_are_solved_or_refused_with_the_reason(joints, index):
    """The residual is computed by the law written out again; twice for the sums in another order.

    `benchmarks/friction_robustness.py` runs thousands.
    """
    for one in outcomes(index, joints):
        if one.refused:
            assert "contact was not solved" in one.refused
            assert "take smaller increments, or a smaller coefficient of friction" in one.refused
        else:
            assert one.residual <= 2 * SOLVED


@pytest.mark.long
@pytest.mark.parametrize("index", [1, 23, 57, 95, 1234, 2200, 2905])
def test_paths_that_newton_steps_alone_do_not_solve(joints, index):
    """Rank-deficient and stiff: points that yield at first lead to the end.

    Of the last three Newton's method went in circles where it took steps that do not descend.
    """
    found = list(outcomes(index, joints))
    assert len(found) == 5
    assert all(not one.refused and one.residual <= 2 * SOLVED for one in found)


@pytest.mark.parametrize("index", [657, 1264, 3326, 3392])
def test_increments_of_few_digits_are_solved_to_all_they_have(joints, index):
    """A last stage whose Newton steps ended at 7e-10, and nearly singular S, left up to 3e-6."""
    assert all(one.residual <= 1e-11 for one in outcomes(index, joints))


@pytest.mark.long
def test_stages_that_go_astray_from_where_a_load_left_begin_anew(joints):
    """Few hard points under friction, of which the third increment has a solution elsewhere."""
    assert [one.refused for one in outcomes(370, joints)] == [""] * 5


@pytest.mark.parametrize(
    ("index", "reason"), [(1, "smaller increments"), (208, "may contradict each other")]
)
def test_refusals_say_whether_there_is_a_solution(joints, monkeypatch, index, reason):
    """One with penalties, where few steps are allowed, and one whose rigid gaps contradict."""
    monkeypatch.setattr(augmented, "MOST_TRIALS", 1)
    monkeypatch.setattr("faying.contact.newton_descent.MOST_STEPS", 1)
    *_, last = outcomes(index, joints)
    assert reason in last.refused
