"""Factors at which a joint opens: against separate solutions, in increments, and with friction."""

import numpy as np
import pytest

import faying as fy
from faying.assessment import opening
from faying.simulation.without_friction import released_state

BEND = fy.Load({"tip.Fx": 6e3, "tip.Fz": -500.0}, name="bend")


@pytest.fixture(scope="module")
def pair():
    model = fy.lap_joint(
        element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)), hole_radius=None
    )
    return fy.preload(model, dict.fromkeys(model.bolts, 8e3))


def share_left(model, factor):
    """Share of the area pressed at rest that a separate solution presses."""
    rest, loaded = (fy.solve_static(model, BEND.scaled(f)).pressure > 0 for f in (0.0, factor))
    weights = model.contact.weights
    return weights @ (rest & loaded) / (weights @ rest)


@pytest.mark.parametrize("open_below", [0.4, None, 0.9])
def test_less_than_the_share_is_left_from_there_on(pair, open_below):
    wanted = fy.Requirements(open_below=open_below, min_opening_factor=1.0)
    found = fy.assess(pair, [BEND], wanted)
    factor = found.interfaces["joint"].opening["bend"]
    share = 0.5 if open_below is None else open_below
    assert share_left(pair, factor * (1 - 1e-6)) >= share > share_left(pair, factor * (1 + 1e-6))
    around = [one.opening_around["joint"]["bend"] for one in found.bolts.values()]
    assert min(around) <= factor <= max(around)
    (verdict,) = found.verdicts
    assert verdict.value == min(factor, *around)
    assert verdict.place in {"joint", *(f"joint around {name}" for name in pair.bolts)}
    # The load bends: something stays pressed for ever, and the first edge opens early.
    assert found.interfaces["joint"].loss_of_clamp["bend"] == np.inf
    assert found.interfaces["joint"].first_opening["bend"] < 0.5 * factor


def test_increments_lead_to_the_same_factors(pair, monkeypatch):
    exact = fy.assess(pair, [BEND])
    monkeypatch.setattr(opening, "MOST_EXACT", 0)
    searched = fy.assess(pair, [BEND])
    # Bisected to a thousandth.
    factor = exact.interfaces["joint"].opening["bend"]
    assert searched.interfaces["joint"].opening["bend"] == pytest.approx(factor, rel=1e-3)
    for name, one in exact.bolts.items():
        around = searched.bolts[name].opening_around["joint"]
        assert around["bend"] == pytest.approx(one.opening_around["joint"]["bend"], rel=1e-3)
    assert not searched.interfaces["joint"].first_opening


def test_hard_contact_without_unique_forces_is_followed():
    """At more points than there are relative displacements: bricks with Gauss points."""
    hard = fy.lap_joint(element_size=5.0, penalty="hard", quadrature="gauss")
    stiff = fy.lap_joint(element_size=5.0, penalty=1e8, quadrature="gauss")
    factors = [
        fy.assess(fy.preload(one, {"bolt": 10e3}), [BEND]).interfaces["joint"].opening["bend"]
        for one in (hard, stiff)
    ]
    # A hard facet opens as a whole, of an elastic one a point after the other: 4 % is measured.
    assert factors[0] == pytest.approx(factors[1], rel=0.06)


def test_openings_are_followed_with_friction():
    """Next to no friction opens as none does; the path has its increments."""
    smooth = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    load = fy.Load({"tip.Fz": -600.0}, name="bend")
    expected = fy.assess(smooth, [load]).interfaces["joint"].opening["bend"]
    rubbing = smooth.with_friction(1e-3, tangential_penalty=8e5)
    released = released_state(rubbing)
    found = fy.slip_reserve(rubbing, load, released, increments=5, open_below=0.5)
    assert found.areas == ("joint",)
    # Bisected to a thousandth; a thousandth of friction moves it by less than that of its share.
    assert found.openings[0] == pytest.approx(expected, rel=5e-3)
    assert fy.slip_reserve(rubbing, load, released, increments=5, largest=1.0).areas == ()
