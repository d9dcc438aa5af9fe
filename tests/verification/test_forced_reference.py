"""Forced response of a lap joint: transients of another program, the linear limit, balances."""

from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.assessment.stuck_modes import stuck_stiffness
from faying.joint.system import input_forces
from faying.simulation.load import harmonic_inputs

FORCED = Path(__file__).parents[1] / "data" / "forced"
REFERENCE = np.genfromtxt(FORCED / "mode1.csv", delimiter=",", names=True)
LONGER = 1 + 2e-5
"""Periods of its integrator, 400 steps each, over true ones."""


@pytest.fixture(scope="module")
def joint():
    model = fy.lap_joint(element_size=5.0, penalty=1e6, damping=fy.Rayleigh(alpha=50.0, beta=2e-7))
    model = model.with_bolt_forces({"bolt": 8e3}).with_friction(0.2, tangential_penalty=8e5)
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)


def at(curve, frequencies):
    """Points of a curve at frequencies it was asked for."""
    return [int(np.abs(curve.frequency - frequency).argmin()) for frequency in frequencies]


@pytest.mark.parametrize(
    "level", [pytest.param(0.3, marks=pytest.mark.long), pytest.param(5.0, marks=pytest.mark.slow)]
)
def test_steady_states_of_transients(joint, level):
    """Generalized-α of a program apart from faying, settled over 120 to 300 periods.

    At 649.75 the eleventh harmonic meets mode 6: 0.63 % off where nine of all modes alone moved.
    """
    rows = REFERENCE[REFERENCE["level"] == level]
    asked = rows["frequency"] * LONGER
    (curve,) = fy.frequency_response(joint, {"tip.Fz": 1.0}, asked, [level], harmonics=9).curves
    assert curve.missed == ()
    points, contact = at(curve, asked), curve.contact
    moved = curve.response("tip.uz")[points]
    np.testing.assert_allclose(np.abs(moved), rows["amplitude"], rtol=5e-3)
    np.testing.assert_allclose(np.degrees(np.angle(moved)), rows["phase"], atol=0.5)
    rubs = rows["friction_energy"] > 0.1 * rows["load_work"]
    assert rubs.all() == (level == 5.0)
    np.testing.assert_allclose(
        contact.friction_energy[points][rubs], rows["friction_energy"][rubs], rtol=0.03
    )
    assert np.abs(contact.imbalance).max() < 0.02
    assert contact.error.max() < 1e-6


@pytest.mark.slow
def test_harmonics_chosen_for_a_tolerance_meet_it(joint):
    """Seven, the first choice, were 0.49 % off at 649.75, where modes that join move as well."""
    tolerance, halved_steps = 3e-3, 8e-4
    rows = REFERENCE[(REFERENCE["level"] == 5.0) & (np.abs(REFERENCE["frequency"] - 648.5) < 1.5)]
    asked = rows["frequency"] * LONGER
    assert len(asked) == 2
    (curve,) = fy.frequency_response(
        joint, {"tip.Fz": 1.0}, asked, [5.0], tolerance=tolerance
    ).curves
    assert curve.deviation.max() < tolerance
    moved = np.abs(curve.response("tip.uz")[at(curve, asked)])
    np.testing.assert_allclose(moved, rows["amplitude"], rtol=tolerance + halved_steps)


@pytest.mark.long
@pytest.mark.parametrize("harmonics", [1, 9])
def test_small_vibrations_are_linear(joint, harmonics):
    """Without directions beside the modes (F17) it was 2e-4 off with one harmonic."""
    rest, asked = fy.solve_path(joint, [fy.Load()]), (640.0, 648.0, 656.0)
    found = fy.frequency_response(
        joint, {"tip.Fz": 1.0}, asked, [1e-3], harmonics=harmonics, initial=rest
    )
    (curve,) = found.curves
    K = stuck_stiffness(joint, rest)
    force = input_forces(joint, harmonic_inputs(joint, {"tip.Fz": 1.0}).real)
    for one in (curve, found.linear):
        moved = [
            one.level * force @ np.linalg.solve(K + 1j * w * joint.C - w**2 * joint.M, force)
            for w in 2 * np.pi * one.frequency
        ]
        np.testing.assert_allclose(one.response("tip.uz"), moved, rtol=1e-8)
    assert set(asked) <= set(curve.frequency.round(9))
    assert (curve.contact.friction_energy == 0).all()


@pytest.mark.slow
def test_a_mode_whose_second_harmonic_meets_another(joint):
    """Mode 3 and mode 6, beside transients of faying: to 1 %, of 600 steps a period at 3850."""
    rows = np.genfromtxt(FORCED / "mode3.csv", delimiter=",", names=True)
    (curve,) = fy.frequency_response(
        joint, {"tip.Fz": 1.0}, rows["frequency"], [6.0], harmonics=3
    ).curves
    assert curve.missed == ()
    moved = np.abs(curve.response("tip.uz")[at(curve, rows["frequency"])])
    np.testing.assert_allclose(moved, rows["amplitude"], rtol=0.07)


@pytest.mark.slow
def test_harmonics_past_those_named_follow_modes_through_resonance(joint):
    """1.8° off where all shapes had twelve and no more."""
    longer, amplitude, phase = 1 + 0.9e-5, 8.783129e-03, -87.241
    (curve,) = fy.frequency_response(
        joint, {"tip.Fz": 1.0}, [3850.0 * longer], [6.0], harmonics=12
    ).curves
    (moved,) = curve.response("tip.uz")
    assert abs(moved) == pytest.approx(amplitude, rel=5e-3)
    assert np.degrees(np.angle(moved)) == pytest.approx(phase, abs=1.5)


@pytest.mark.slow
def test_too_few_harmonics_where_a_multiple_meets_a_mode_are_said(joint):
    found = fy.frequency_response(joint, {"tip.Fz": 1.0}, [3850.0], [6.0], harmonics=1)
    assert "3 harmonics more than 1 change the motion at 3850 by" in found.curves[0].remarks[0]
