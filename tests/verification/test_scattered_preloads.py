"""Scatter of preloads: bounds and quantiles against tightenings solved one by one."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.preload_scatter import preload_spreads
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
        # Cases that are solved side by side are rounded by where they stand.
        assert [one.least, one.most] == pytest.approx([one.meant] * 2, rel=1e-9, abs=1e-9)


@pytest.mark.long
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


THREAD = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8", head_diameter=13.0)
RANGES = {"thread_friction": (0.08, 0.14), "head_friction": (0.10, 0.20)}


def torque_per_force(in_thread, at_head):
    """Of an M10 by hand: lead, flanks of 60 degrees, and head."""
    pitch_diameter = 10.0 - 0.6495190528383290 * 1.5
    return 1.5 / (2 * np.pi) + pitch_diameter * in_thread / np.sqrt(3) + 6.5 * at_head


def test_friction_in_thread_and_head_scatters_what_one_torque_gives(joint):
    scatter = fy.PreloadScatter(**RANGES)
    found = fy.assess(joint, [LOAD], paths=False, scatter=scatter, threads={"bolt": THREAD})
    force = {one.metric: one for one in found.scatter}["bolt_force.bolt"]
    middle = torque_per_force(0.11, 0.15)
    ends = [middle / torque_per_force(*both) for both in ((0.14, 0.20), (0.08, 0.10))]
    low, high = (float(at_factor(joint, factor).bolt_force("bolt")) for factor in ends)
    assert low < force.least < force.meant < force.most < high
    # The two are drawn on their own, which seldom are both at their ends.
    assert force.p05 > low + 0.02 * (high - low)
    shares = np.random.default_rng(7).random((2, 200_000))  # the same, tried far more often
    tried = middle / torque_per_force(0.08 + 0.06 * shares[0], 0.10 + 0.10 * shares[1])
    for share, value in ((0.05, force.p05), (0.5, force.median), (0.95, force.p95)):
        expected = float(at_factor(joint, np.quantile(tried, share)).bolt_force("bolt"))
        assert value == pytest.approx(expected, rel=0.03)  # of 200 tightenings


@pytest.mark.long
def test_friction_of_bolts_multiplies_the_scatter_of_the_torque(joint):
    def width(**keys):
        scatter = fy.PreloadScatter(**keys)
        found = fy.assess(joint, [LOAD], paths=False, scatter=scatter, threads={"bolt": THREAD})
        force = {one.metric: one for one in found.scatter}["bolt_force.bolt"]
        return np.log(force.p95 / force.p05)

    tool, friction = width(tightening_factor=1.5), width(**RANGES)
    both = width(tightening_factor=1.5, **RANGES)
    assert max(tool, friction) < both < tool + friction


@pytest.mark.long
def test_friction_of_the_surfaces_scatters_along_paths():
    preloaded = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3}).with_friction(0.2)
    rom = fy.reduce(preloaded, fy.craig_bampton(preloaded, normal_modes=3), compliance=True)
    load = fy.Load({"tip.Fx": 1200.0}, name="pull")
    scatter, solved = fy.PreloadScatter(surface_friction=(0.1, 0.3), samples=6), list[int]()
    full, reduced = (
        {
            one.metric: one
            for one in preload_spreads(one, rom.interfaces, load, scatter, progress=solved.append)
        }
        for one in (preloaded, rom)
    )
    assert solved == [1] * 2 * (1 + scatter.samples)  # each told as it is solved
    for metric, one in full.items():
        # Static pressures of the reduced model are exact, to what increments are solved to.
        assert reduced[metric].most == pytest.approx(one.most, rel=1e-6, abs=1e-9), metric
    slips = full["max_slip.joint"]
    assert slips.least < slips.meant < slips.most

    def farthest(friction):
        loads = [fy.Load({"tip.Fx": 120.0 * part}) for part in range(11)]
        path = fy.solve_path(preloaded.with_friction(friction), loads)
        return np.linalg.norm(path.shear_slip[-1], axis=0).max()

    # One of the six is drawn from each sixth of the range.
    assert farthest(0.3) < slips.least < farthest(0.3 - 0.2 / 6)
    assert farthest(0.1 + 0.2 / 6) < slips.most < farthest(0.1)


def test_scatter_of_what_is_not_there_is_refused(joint):
    with pytest.raises(ModelError, match="no interface has friction"):
        spreads(joint, surface_friction=(0.1, 0.2))
    with pytest.raises(ModelError, match="bolt 'bolt' has no thread"):
        spreads(joint, **RANGES)
    scatter = fy.PreloadScatter(**RANGES)
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8")
    with pytest.raises(ModelError, match=r"bolt 'bolt': .*head_diameter D_Km of the thread"):
        fy.assess(joint, [LOAD], paths=False, scatter=scatter, threads={"bolt": thread})


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"tightening_factor": 0.9}, "tightening factor is 0.9; give 1 or more"),
        ({"settlement": -1.0}, "settlement is -1"),
        ({"samples": 0}, "0 samples"),
        ({"surface_friction": (0.3, 0.1)}, "surface_friction goes from 0.3 to 0.1"),
        ({"thread_friction": (0.1, 0.2)}, "takes both thread_friction and head_friction"),
    ],
)
def test_bad_scatter_is_refused(keys, message):
    with pytest.raises(ModelError, match=message):
        fy.PreloadScatter(**keys)
