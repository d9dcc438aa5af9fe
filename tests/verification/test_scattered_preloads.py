"""Scatter of preloads: bounds and quantiles against tightenings solved one by one."""

import pytest

import faying as fy
from faying.exceptions import ModelError

LOAD = fy.Load({"tip.Fz": -300.0}, name="bend")


@pytest.fixture(scope="module")
def joint():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})


def spreads(system, **keys):
    found = fy.assess(system, [LOAD], paths=False, scatter=fy.PreloadScatter(**keys)).scatter
    return {one.metric: one for one in found}


def at_factor(joint, factor, settlement=0.0):
    bolt = joint.bolts["bolt"]
    force = factor * bolt.initial_force - bolt.stiffness * settlement
    return fy.solve_static(joint.with_bolt_forces({"bolt": force}), LOAD)


def test_the_range_is_that_of_the_tightening_factor(joint):
    found = spreads(joint, tightening_factor=1.6, settlement=0.002)
    for metric, of in (
        ("clamp_force.joint", lambda one: float(one.contact_force("joint"))),
        ("bolt_force.bolt", lambda one: float(one.bolt_force("bolt"))),
    ):
        low, high = (of(at_factor(joint, f, 0.002)) for f in (2 / 2.6, 3.2 / 2.6))
        one = found[metric]
        # The ends are drawn within a two-hundredth of the range.
        assert low <= one.least <= low + (high - low) / 200
        assert high - (high - low) / 200 <= one.most <= high
        assert one.least < one.p05 < one.median < one.p95 < one.most
        assert one.meant == pytest.approx(of(at_factor(joint, 1.0)), rel=1e-9)  # solved alone


def test_without_scatter_all_are_as_meant(joint):
    for one in spreads(joint, samples=3).values():
        assert one.least == one.most == pytest.approx(one.meant, rel=1e-9, abs=1e-9)


def test_reduced_models_of_exact_pressures_scatter_alike(joint):
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5), compliance=True)
    some, others = spreads(joint, tightening_factor=2.0), spreads(rom, tightening_factor=2.0)
    assert some["max_pressure.joint"].p95 == pytest.approx(
        others["max_pressure.joint"].p95,
        rel=1e-8,  # exact to round-off of the compliance
    )


def test_bolts_scatter_on_their_own():
    places = [[-10.0, 0.0], [10.0, 0.0]]
    two = fy.lap_joint(element_size=5.0, bolt_positions=places, hole_radius=0.0)
    joint = fy.preload(two, {"bolt-1": 5e3, "bolt-2": 5e3})
    found = spreads(joint, tightening_factor=3.0)
    total, each = found["clamp_force.joint"], found["bolt_force.bolt-1"]
    # The mean of two independent ones spreads less than each.
    wide, narrow = ((one.p95 - one.p05) / one.median for one in (each, total))
    assert narrow < 0.9 * wide


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"tightening_factor": 0.9}, "tightening factor is 0.9; give 1 or more"),
        ({"settlement": -1.0}, "settlement is -1"),
        ({"samples": 0}, "0 samples"),
    ],
)
def test_bad_scatter_is_refused(keys, message):
    with pytest.raises(ModelError, match=message):
        fy.PreloadScatter(**keys)
