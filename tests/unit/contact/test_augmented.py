"""Laws at points that yield besides, as stages of hard contact have them (F1a)."""

from dataclasses import replace

import numpy as np
import pytest

from faying.contact.augmented import SoftenedLaws
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.contact.laws.power import PowerClosure
from faying.contact.laws.table import TableClosure
from faying.contact.laws_at_points import LawsAtPoints
from few_points import LAWS, N, joint

CURVES = LAWS | {
    "one": Coulomb(PowerClosure(pressure=2.0, depth=0.3, exponent=2.0), 0.4, 1.5),
    "two": TableClosure(closures=(0.0, 0.2, 0.5), pressures=(0.0, 0.1, 0.6)),
}


def softened(laws, added=0.05):
    contact = joint(0, laws)[0].contact
    return SoftenedLaws(LawsAtPoints(contact=contact), np.full((3, N), added))


@pytest.mark.parametrize("laws", [LAWS, CURVES], ids=["proportional", "curves"])
def test_what_points_yield_and_are_closed_by_agree(laws):
    """c(λ) + d λ is what closes a point, forces are admissible, and open points have none."""
    answers = softened(laws)
    moved = np.random.default_rng(1).normal(-0.5, 0.6, (3, N))
    forces, stiffness = answers.respond(moved)
    closed = forces[0] > 0
    assert closed.any()
    assert not closed.all()
    # Newton's method ends at 1e-12.
    np.testing.assert_allclose(answers.yielded(forces)[0, closed], -moved[0, closed], rtol=1e-11)
    assert (moved[0, ~closed] > 0).all()
    assert not forces[:, ~closed].any()
    np.testing.assert_allclose(answers.laws.admissible(forces), forces, rtol=1e-15)  # round-off
    way = np.random.default_rng(2).standard_normal(moved.shape)
    ends = [answers.respond(moved + h * way)[0] for h in (1e-7, -1e-7)]
    found = -np.einsum("pij,jp->ip", stiffness, way)
    # Round-off of the differences; no point lies within 1e-7 of a kink.
    np.testing.assert_allclose(
        found, (ends[0] - ends[1]) / 2e-7, rtol=0, atol=1e-6 * np.abs(found).max()
    )


def test_hard_points_have_springs_where_they_yield():
    springs = softened(LAWS).springs
    assert np.isfinite(springs).all()
    np.testing.assert_allclose(springs[:, 4:], 1 / 0.05, rtol=1e-15)  # round-off
    rigid = replace(softened({name: Hard() for name in LAWS}), added=np.full((3, N), 0.05))
    np.testing.assert_allclose(rigid.springs[0], 1 / 0.05, rtol=1e-15)
    soft = softened(dict.fromkeys(LAWS, Penalty(2.0)), 0.5).springs[0]
    weights = joint()[0].contact.weights
    np.testing.assert_allclose(soft, 1 / (1 / (2.0 * weights) + 0.5), rtol=1e-15)


def test_curves_that_begin_far_softer_than_they_end():
    """The slope at zero force, a thousandth up the curve, is far below that of small forces."""
    steps = np.arange(332)
    curve = TableClosure(
        closures=(-1.0, *(0.01 * steps - 0.99)), pressures=(0.0, *(0.07 * np.exp(0.05 * steps)))
    )
    answers = softened(LAWS | {"two": curve}, added=1.4e-3)
    (points,) = (at for law, at in answers.laws.members if law is curve)
    moved = np.zeros((3, N))
    moved[0, points] = np.linspace(-0.1, 0.5, points.stop - points.start)
    forces = answers.respond(moved)[0]
    # Newton's method ends at 1e-12.
    np.testing.assert_allclose(
        answers.yielded(forces)[0, points], -moved[0, points], rtol=1e-11, atol=1e-12
    )
