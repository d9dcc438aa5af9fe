"""Backbones: closed form of a mass on a slider, the same path by solve_path, full and reduced."""

import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.assessment.stuck_modes import stuck_mode
from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Penalty
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.load_pattern import LoadPattern
from faying.model.boundary import Boundary
from lap_joints import tiny_lap
from small_system import SmallSystem

MASS, SPRING, SLIDER, LIMIT, DAMPER = 2.0, 300.0, 500.0, 6.0, 0.4


def mass_on_a_slider():
    """A mass on a spring and on a slider that is pressed on by 20, beside a mass of its own.

    Coordinates: along the slider, along its normal, and the other mass.
    """
    K = np.diag([SPRING, 1e4, 900.0])
    pressed = 20.0 * (1 / 1e4 + 1 / 1e3)
    contact = Contact(
        relative_operator=np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 0]]),
        interpolation=sp.csr_array([[1.0, 0, 0]]),
        shear=sp.csr_array([[0.0, 1, 0], [0, 0, 1]]),
        initial_gap=np.array([-pressed]),
        weights=np.ones(1),
        tangents=np.eye(3)[:2, None],
        laws={"slider": Coulomb(Penalty(1e3), LIMIT / 20.0, SLIDER)},
        slices={"slider": slice(0, 1)},
    )
    ends = {
        name: Boundary(name=name, nodes=[dof], components=[0], dofs=[dof])
        for name, dof in (("mass", 0), ("other", 2))
    }
    return SmallSystem(
        M=np.diag([MASS, 1e-3, 1.0]),
        C=np.diag([DAMPER, 0, 0]),
        K=K,
        contact=contact,
        boundaries=ends,
    )


@pytest.fixture(scope="module")
def slider():
    return mass_on_a_slider()


@pytest.fixture(scope="module")
def joint():
    return fy.lap_joint(element_size=5.0).with_bolt_forces({"bolt": 10e3}).with_friction(0.2)


@pytest.mark.long
def test_a_mass_on_a_slider_has_its_closed_form(slider):
    """Slip at constant force: exact for any increments, to the residual of an increment."""
    found = fy.backbone(slider, 1, [0.002, 0.02, 0.1, 0.5], masing=True, increments=100)
    stuck = (SPRING + SLIDER) / MASS
    assert found.small_frequency == pytest.approx(np.sqrt(stuck) / (2 * np.pi), rel=1e-10)
    force = found.load * np.sqrt(MASS)
    slips = force * SLIDER / (SPRING + SLIDER) > LIMIT
    assert slips.tolist() == [False, True, True, True]
    moved = np.where(slips, (force - LIMIT) / SPRING, force / (SPRING + SLIDER))
    np.testing.assert_allclose(found.amplitude, moved, rtol=1e-9)
    circular = np.sqrt(force / moved / MASS)
    np.testing.assert_allclose(found.frequency, circular / (2 * np.pi), rtol=1e-9)
    lost = np.where(slips, 4 * LIMIT * (moved - LIMIT / SLIDER), 0.0)
    np.testing.assert_allclose(found.energy_per_cycle, lost, rtol=1e-9, atol=1e-12)
    friction = lost / (2 * np.pi * force * moved)
    np.testing.assert_allclose(found.friction_damping, friction, rtol=1e-9, atol=1e-12)
    linear = DAMPER / (2 * MASS * circular)
    np.testing.assert_allclose(found.damping_ratio, friction + linear, rtol=1e-9)
    assert found.macroslip.tolist() == slips.tolist()
    np.testing.assert_array_equal(found.stick_share, np.where(slips, 0.0, 1.0))
    # Trapezoids miss the corners of the loop: of second order in the increment.
    np.testing.assert_allclose(found.loop_area, lost, rtol=0.01, atol=1e-12)
    # Normal forces do not change here, so Masing's rule holds; the same corners.
    np.testing.assert_allclose(found.masing_damping[1:], friction[1:], rtol=0.02)
    np.testing.assert_allclose(found.masing_frequency, found.frequency, rtol=1e-9)
    assert (np.abs(found.masing_deviation) < 0.02).all()
    assert "all that is closed on an interface slips" in found.remarks[0]
    assert re.search(r"from an amplitude of [0-9.]+ mm on", found.remarks[0])
    # Half of force times displacement, of a mass that alone moves.
    np.testing.assert_allclose(found.energy, force * moved / 2, rtol=1e-9)
    axes = found.plot(over="energy")
    np.testing.assert_array_equal(axes.lines[0].get_xdata(), found.energy)
    assert axes.get_xlabel().startswith("energy of the vibration [")
    with pytest.raises(ModelError, match="no abscissa 'force'; give 'amplitude' or 'energy'"):
        found.plot(over="force")


def test_a_mode_that_does_not_move_the_joint_says_so(slider):
    found = fy.backbone(slider, 2, [0.1])
    assert found.measured_at == "other"
    assert found.frequency[0] == pytest.approx(30 / (2 * np.pi), rel=1e-9)
    assert found.energy_per_cycle[0] == found.damping_ratio[0] == 0
    assert "mode 2 does not move the joint" in found.remarks[0]


@pytest.mark.long
def test_cycles_are_those_of_the_path(joint):
    """The load of the mode as a pattern, through solve_path and all displacements."""
    found = fy.backbone(joint, 2, [0.05], increments=20)
    rest = fy.solve_path(joint, [fy.Load()])
    mode = stuck_mode(joint, rest, 2)
    force = joint.M @ mode.shape
    loaded = replace(joint, load_patterns={"mode": LoadPattern(name="mode", forces=force)})
    shares = [0.2, 0.4, 0.6, 0.8, 1.0, *(1 - 0.2 * np.arange(1, 11)), *(0.2 * np.arange(1, 11) - 1)]
    cycles = shares[:5] + shares[5:] * int(found.cycles[0])
    loads = [fy.Load(), *(fy.Load({"mode": float(found.load[0]) * f}) for f in cycles)]
    path = fy.solve_path(loaded, loads)
    modal = (path.states - path.states[0]) @ force
    # Two sums of the same forces: round-off of the modal coordinate.
    assert (modal[-1] - modal[-11]) / 2 == pytest.approx(found.modal_amplitude[0], rel=1e-8)
    assert path.dissipation[-20:].sum() == pytest.approx(found.energy_per_cycle[0], rel=1e-8)
    tip = path.displacement("tip")[-21:, 1]  # the mode is in the plane of the interface
    assert np.ptp(tip) / 2 == pytest.approx(found.amplitude[0], rel=1e-3)


def test_small_amplitudes_are_small_vibrations(joint):
    found = fy.backbone(joint, 1, [1e-4])
    assert found.frequency[0] == pytest.approx(found.small_frequency, rel=1e-8)
    assert found.energy_per_cycle[0] == 0
    assert found.stick_share[0] == 1
    assert "nothing slips in mode 1" in found.remarks[0]


def test_what_lies_on_its_bound_sticks_once_small_cycles_repeat():
    """Tightening leaves points on their bounds: a first loading slips, however small it is."""
    smooth = tiny_lap(penalty=1e6)
    rubbing = smooth.with_bolt_forces({"bolt": 8e3}).with_friction(0.05, tangential_penalty=8e5)
    tight = fy.solve_path(
        rubbing, [fy.Load(bolt_forces={"bolt": 8e3 * k / 10}) for k in range(1, 11)]
    )
    found = fy.backbone(rubbing, 2, [1e-4], initial=tight, masing=True, increments=12)
    # What an increment is solved to; 1e-13 is measured.
    assert found.frequency[0] == pytest.approx(found.small_frequency, rel=1e-9)
    assert found.masing_frequency[0] < found.small_frequency * (1 - 1e-4)  # 1e-3 is measured
    shear, normal = tight.shear_forces[-1], tight.contact_forces[-1]
    on = (normal > 0) & (np.hypot(*shear) >= (1 - 1e-6) * 0.05 * normal)
    weights = rubbing.contact.weights
    share = weights[on].sum() / weights[normal > 0].sum()
    assert share > 0
    assert f"{share:.0%} of the area in contact lies on its friction" in found.remarks[-1]


def test_energies_stand_for_amplitudes(slider):
    """Half of force times displacement, if nothing slipped."""
    by_place = fy.backbone(slider, 1, [0.002, 0.1])
    stuck = MASS * (2 * np.pi * by_place.small_frequency) ** 2
    by_energy = fy.backbone(slider, 1, stuck * np.array([0.002, 0.1]) ** 2 / 2, over="energy")
    np.testing.assert_allclose(by_energy.amplitude, by_place.amplitude, rtol=1e-12)
    np.testing.assert_allclose(by_energy.load, by_place.load, rtol=1e-12)
    assert (by_place.over, by_energy.over) == ("amplitude", "energy")
    with pytest.raises(ModelError, match="no abscissa 'force'; give over='amplitude' or 'energy'"):
        fy.backbone(slider, 1, [1.0], over="force")


@pytest.mark.long
def test_a_reduced_model_has_the_backbone_of_the_full_one(joint):
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)
    full, reduced = (fy.backbone(one, 1, [0.05, 0.3], increments=20) for one in (joint, rom))
    # 26 coordinates, and a residual compliance without mass; 1.2e-4 is measured.
    assert reduced.small_frequency == pytest.approx(full.small_frequency, rel=1e-3)
    np.testing.assert_allclose(reduced.frequency, full.frequency, rtol=1e-3)
    np.testing.assert_allclose(reduced.damping_ratio, full.damping_ratio, rtol=5e-3)


@pytest.mark.long
def test_loop_and_slip_agree_as_increments_shrink(joint):
    coarse, fine = (fy.backbone(joint, 2, [0.1], increments=n) for n in (20, 80))
    assert abs(fine.energy_difference[0]) < 0.6 * abs(coarse.energy_difference[0])


@pytest.mark.long
def test_masing_is_wrong_where_normal_forces_change(joint):
    """In bending the interface opens and closes; the first loading knows one side alone."""
    found = fy.backbone(joint, 1, [0.3], masing=True)
    assert found.masing_deviation[0] < -0.1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, [0.1]), "there is no mode 0; modes are whole numbers from 1"),
        ((1.5, [0.1]), "there is no mode 1.5; modes are whole numbers from 1"),
        ((1, [0.1, -1.0]), "the amplitudes are .0.1, -1.0.; give positive numbers"),
        ((1, []), "give positive numbers"),
    ],
)
def test_bad_requests_are_refused(slider, arguments, message):
    with pytest.raises(ModelError, match=message):
        fy.backbone(slider, *arguments)


def test_amplitudes_across_the_motion_of_a_place_are_told():
    """A bolt beside the middle: the bending mode moves the tip a little sideways."""
    joint = tiny_lap(bolt_positions=((0.0, 2.0),)).with_bolt_forces({"bolt": 10e3})
    rubbing = joint.with_friction(0.2)
    said, unsaid = (fy.backbone(rubbing, 1, [1e-4], at=at).remarks for at in ("tip.uy", "tip"))
    assert "mode 1 moves 'tip.uy' by 4.4e-03 of its motion there" in said[0]
    assert not any("of its motion there" in text for text in unsaid)


def test_places_where_nothing_moves_are_refused(slider):
    with pytest.raises(ModelError, match="leaves 'other' still; measure its amplitude"):
        fy.backbone(slider, 1, [0.1], at="other")
    with pytest.raises(ModelError, match="there is no boundary 'tip'; the boundaries are mass"):
        fy.backbone(slider, 1, [0.1], at="tip")
    with pytest.raises(ModelError, match="boundary 'mass' has no component 'up'"):
        fy.backbone(slider, 1, [0.1], at="mass.up")


def test_amplitudes_that_are_not_solved_are_named(slider, monkeypatch):
    def fails(*_):
        message = "no solution"
        raise ConvergenceError(message)

    monkeypatch.setattr("faying.assessment.modal_cycles.Swing.cycle", fails)
    with pytest.raises(ConvergenceError, match=r"mode 1 at amplitude 0\.1: no solution"):
        fy.backbone(slider, 1, [0.1])


def test_models_that_cannot_swing_or_rub_are_refused(slider):
    with pytest.raises(ModelError, match="the model has no mass: its materials have no density"):
        fy.backbone(replace(slider, M=0 * slider.M), 1, [0.1])
    smooth = fy.lap_joint(element_size=10.0, hole_radius=0.0)
    with pytest.raises(ModelError, match="no interface has friction; give it with"):
        fy.backbone(smooth, 1, [0.1])


@pytest.mark.long
def test_a_multiple_of_the_frequency_that_meets_another_mode_is_said():
    """Mode 3 of this joint in motion: 1.5 times what cycles damp, by mode 6 at twice its frequency.

    A transient had 2.3 times the damping at 0.01 mm; mode 1 met nothing.
    """
    model = fy.lap_joint(element_size=5.0, penalty=1e6, damping=fy.Rayleigh(alpha=50.0, beta=2e-7))
    rubbing = model.with_bolt_forces({"bolt": 8e3}).with_friction(0.2, tangential_penalty=8e5)
    rom = fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=20), compliance=True)
    rest = fy.solve_path(rom, [fy.Load()])
    third, first = (
        fy.backbone(rom, mode, [size], initial=rest, increments=24)
        for mode, size in ((3, 0.01), (1, 0.05))
    )
    said = [text for text in third.remarks if "2 times the frequency meets mode 6" in text]
    assert len(said) == 1
    assert "fy.frequency_response" in said[0]
    assert not any("meets mode" in text for text in first.remarks)
