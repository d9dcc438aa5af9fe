"""Factors at which a joint opens: against separate solutions, in increments, and with friction."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.opening import (
    area_name,
    areas_that_open,
    opening_factors,
    opening_margins,
)
from faying.simulation.start import released_state

BEND = fy.Load({"tip.Fx": 6e3, "tip.Fz": -500.0}, name="bend")


STEPS = (-2e-6, 2e-6)


def share_left(model, factor, area=True):
    """Share of what of an area is pressed at rest that a separate solution presses."""
    rest, loaded = (fy.solve_static(model, BEND.scaled(f)).pressure > 0 for f in (0.0, factor))
    weights = model.contact.weights * area
    return weights @ (rest & loaded) / (weights @ rest)


@pytest.mark.parametrize("open_below", [None, 0.7, 1.0])
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


def test_around_each_bolt_less_than_half_is_left_from_its_factor_on(pair):
    judged = fy.assess(pair, [BEND])
    areas = areas_that_open(pair.interfaces, pair.contact.slices, pair.bolts)
    around = {name: one.opening_around["joint"]["bend"] for name, one in judged.bolts.items()}
    around = {name: factor for name, factor in around.items() if np.isfinite(factor)}
    assert around
    for name, factor in around.items():
        # Found to a millionth.
        left = [share_left(pair, factor * (1 + e), areas[area_name("joint", name)]) for e in STEPS]
        assert left[0] >= 0.5 - 1e-9 > left[1]


def test_one_solution_says_on_which_side_of_its_factor_a_load_is(pair):
    areas = areas_that_open(pair.interfaces, pair.contact.slices, pair.bolts)
    bolts = fy.Load({"tip.Fx": 6e3}, bolt_forces={"bolt-1": 4e3})
    loads = [BEND, BEND.scaled(0.5), bolts, *(BEND.scaled(0.1 * part) for part in range(6, 9))]
    inputs = np.array([load.inputs(pair, np.zeros(1))[0] for load in loads])
    factors = np.array([min(opening_factors(pair, row, areas).opened.values()) for row in inputs])
    for number, factor in enumerate(factors):
        # Factors are found to a millionth.
        below, above = (
            opening_margins(pair, inputs, areas, factor * (1 + change)) for change in (-1e-5, 1e-5)
        )
        assert below[number] > 0 > above[number]
        np.testing.assert_array_equal(above < 0, factor * (1 + 1e-5) >= factors)


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


@pytest.mark.long
def test_openings_are_followed_with_friction():
    """Next to no friction opens as none does; the path has its increments."""
    smooth = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    load = fy.Load({"tip.Fz": -600.0}, name="bend")
    expected = fy.assess(smooth, [load]).interfaces["joint"].opening["bend"]
    rubbing = smooth.with_friction(1e-3, tangential_penalty=8e5)
    released = released_state(rubbing)
    found = fy.slip_reserve(rubbing, load, released, increments=5, open_below=0.5)
    assert found.areas == ("joint",)
    # A thousandth of friction moves it by less than that of its share.
    assert found.openings[0] == pytest.approx(expected, rel=5e-3)
    assert fy.slip_reserve(rubbing, load, released, increments=5, largest=1.0).areas == ()
