"""Modes that ring down: linear vibration in closed form, and the backbone of one that slips."""

import numpy as np
import pytest

import faying as fy
from faying.assessment import ring_down, stuck_modes
from faying.assessment.ring_down import Decay
from faying.assessment.stuck_modes import stuck_mode
from faying.exceptions import ModelError
from faying.simulation.cycles import MOST_CYCLES
from lap_joints import tiny_lap

BETA = 3e-7


@pytest.fixture(scope="module")
def rom():
    model = tiny_lap(penalty=1e6, damping=fy.Rayleigh(alpha=0.0, beta=BETA))
    rubbing = model.with_bolt_forces({"bolt": 8e3}).with_friction(0.2)
    return fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=15), compliance=True)


@pytest.mark.long
def test_small_vibrations_die_out_by_the_damping_matrix(rom):
    """Cycles that were there before move points off their bounds, and nothing slips then."""
    path = [fy.Load({"tip.Fz": force}) for force in (0.0, 30.0, -30.0, 20.0, -20.0, 10.0, 0.0)]
    found = fy.ring_down(rom, 1, 1e-5, path=path, increments=2)
    rest = fy.solve_path(rom, path)
    mode = stuck_mode(rom, rest, 1)
    assert found.small_frequency == mode.frequency
    circular = 2 * np.pi * mode.frequency
    damping = mode.shape @ (rom.C @ mode.shape) / (2 * circular)
    assert damping > 3e-4
    # Steps of a hundredth of the period: 3e-4 of the frequency, and of the damping.
    np.testing.assert_allclose(found.decay.damping_ratio, damping, rtol=1e-2)
    np.testing.assert_allclose(found.decay.frequency, mode.frequency, rtol=2e-3)
    # Its first loading slips a little: 2.7 % are measured.
    assert found.motion[0] == pytest.approx(1e-5, rel=0.05)
    assert found.measured_at == "tip"
    np.testing.assert_array_equal(found.solution.states.shape, (401, len(rom.K)))


@pytest.mark.long
def test_the_sign_of_a_mode_is_not_the_eigensolvers(rom, monkeypatch):
    """Masing's first loading and a ring-down begin on one side: that of the place they name."""

    def begun(at):
        curve = fy.backbone(rom, 1, [0.1], at=at, masing=True, increments=12)
        motion = fy.ring_down(rom, 1, 0.1, at=at, increments=3, periods=3, steps_per_period=20)
        return curve.masing_damping[0], motion.motion, motion.solution.displacement("tip")[0, 2]

    up, other = begun("tip"), begun("-tip")
    lowest = stuck_modes.lowest_modes

    def turned(*arguments):
        squares, shapes = lowest(*arguments)
        return squares, -shapes

    monkeypatch.setattr(stuck_modes, "lowest_modes", turned)
    for before, now in zip(up, begun("tip"), strict=True):
        np.testing.assert_array_equal(now, before)
    # The tip goes up by most of the amplitude, and down on the other side, where contact opens.
    assert up[2] > 0.05 > -0.05 > other[2]
    assert (up[1][0], other[1][0]) == pytest.approx((0.1, 0.1), rel=0.2)
    assert abs(up[0] / other[0] - 1) > 0.1


@pytest.mark.long
def test_a_joint_that_settles_is_not_damped_by_what_friction_takes():
    """Pulled and let go before, it slips on in every cycle, by energy that was left in it."""
    slippery = tiny_lap(penalty=1e6)
    slippery = slippery.with_bolt_forces({"bolt": 8e3}).with_friction(0.05)
    rom = fy.reduce(slippery, fy.craig_bampton(slippery, normal_modes=10), compliance=True)
    path = [fy.Load({"tip.Fx": 200.0 * pull}) for pull in (0, 1, 2, 3, 4, 5, 4, 3, 2, 1, 0)]
    curve = fy.backbone(rom, 1, [0.01], initial=fy.solve_path(rom, path), increments=12)
    assert curve.cycles[0] == MOST_CYCLES
    assert not curve.stationary[0]
    assert "cycles still changed after 30" in curve.remarks[-1]
    options = {"path": path, "increments": 3, "periods": 3, "steps_per_period": 60}
    free = fy.ring_down(rom, 1, 0.01, **options)
    assert len(free.energies) == MOST_CYCLES
    assert "cycles still changed after 30" in free.remarks[0]
    # Twelve increments a cycle: 11 % are measured, where friction takes 11 times as much.
    assert curve.damping_ratio[0] == pytest.approx(free.decay.damping_ratio.mean(), rel=0.15)
    assert curve.energy_per_cycle[0] > 5 * curve.loop_area[0]
    # Let go at once, its first swings differ.
    fresh = fy.ring_down(rom, 1, 0.01, **options, cycles=0)
    assert fresh.decay.damping_ratio[0] < 0.8 * free.decay.damping_ratio[0]


def test_a_swing_that_grows_is_remarked(rom, monkeypatch):
    decays = Decay(
        times=np.zeros(2),
        amplitude=np.ones(2),
        frequency=np.ones(2),
        damping_ratio=np.array([0.01, -0.0055]),
    )
    monkeypatch.setattr(ring_down, "free_decay", lambda *_: decays)
    options = {"increments": 1, "cycles": 0, "periods": 3, "steps_per_period": 20}
    (remark,) = fy.ring_down(rom, 2, 1e-4, **options).remarks
    assert "the swing grew in 1 of 2 periods" in remark


@pytest.mark.slow
def test_a_mode_that_slips_dies_out_as_its_cycles_say(rom):
    found = fy.ring_down(rom, 2, 0.05, at="tip.uy")
    assert found.measured_at == "tip.uy"
    cycles = fy.backbone(rom, 2, [0.04, 0.05], at="tip.uy")
    assert (cycles.friction_damping > 2 * cycles.linear_damping).all()
    at = np.log(cycles.amplitude)
    expected = np.exp(np.interp(np.log(found.decay.amplitude), at, np.log(cycles.damping_ratio)))
    # What other modes do is not in cycles: 2 % are measured.
    assert found.decay.damping_ratio.mean() == pytest.approx(expected.mean(), rel=0.05)


@pytest.mark.slow
def test_loads_that_stay_stay(rom):
    """About a pulled joint: at rest after a long time where nothing is let go is where it began."""
    path = [fy.Load(), fy.Load({"tip.Fx": 500.0})]
    found = fy.ring_down(rom, 1, 0.01, path=path, increments=4, periods=3)
    middle = found.solution.displacement("tip")[:, 0].mean()
    assert middle == pytest.approx(fy.solve_path(rom, path).displacement("tip")[-1, 0], rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((0, 0.1), {}, "there is no mode 0; modes are whole numbers from 1"),
        ((1, -0.1), {}, r"the amplitude is -0\.1; give a positive number"),
        ((1, 0.1), {"increments": 0}, "found 0 increments; give one or more"),
        ((1, 0.1), {"cycles": -1}, "found -1 cycles; give none or more"),
        ((1, 0.1), {"periods": 1.0}, "found 1 periods of 100 steps; give 3 periods or more of 20"),
        ((1, 0.1), {"at": "top"}, "mode 1: there is no boundary 'top'; the boundaries are tip"),
    ],
)
def test_what_does_not_ring_is_refused(rom, arguments, options, message):
    with pytest.raises(ModelError, match=message):
        fy.ring_down(rom, *arguments, **options)


def test_a_joint_without_friction_is_refused():
    smooth = tiny_lap()
    with pytest.raises(ModelError, match="no interface has friction"):
        fy.ring_down(smooth, 1, 0.1)
