"""Responses estimated from a backbone: linear where nothing slips, balanced at the peak."""

from dataclasses import replace

import numpy as np
import pytest
from test_backbone import DAMPER, LIMIT, MASS, SLIDER, SPRING, mass_on_a_slider

import faying as fy
from faying.assessment.backbone_response import LinearResponse
from faying.exceptions import ModelError


@pytest.fixture(scope="module")
def slider():
    return mass_on_a_slider()


@pytest.fixture(scope="module")
def curve(slider):
    return fy.backbone(slider, 1, np.geomspace(0.005, 2.0, 60), increments=100)


def test_where_nothing_slips_it_is_the_linear_response(slider, curve):
    level = 1e-3
    found = fy.backbone_response(slider, curve, {"mass.Fx": 1 + 1j}, (1.0, 6.0), [level])
    circular = 2 * np.pi * found.curves[0].frequency
    expected = level * (1 + 1j) / (SPRING + SLIDER - MASS * circular**2 + 1j * DAMPER * circular)
    # The backbone's stiffness ω² is α/q to the residual of its increments.
    np.testing.assert_allclose(found.curves[0].response("mass.ux"), expected, rtol=1e-7)
    still = found.linear.response("mass.ux")
    circular = 2 * np.pi * found.linear.frequency
    expected = (1 + 1j) / (SPRING + SLIDER - MASS * circular**2 + 1j * DAMPER * circular)
    np.testing.assert_allclose(still, expected, rtol=1e-12)


def test_at_the_peak_the_load_feeds_what_slip_and_damper_take(slider, curve):
    level = 12.0
    found = fy.backbone_response(slider, curve, {"mass.Fx": 1.0}, (1.0, 6.0), [level])
    peak = found.curves[0].peak("mass.ux")
    assert "friction takes 63% of the loss at the peak" in found.remarks[1]
    slipped = peak.amplitude - LIMIT / SLIDER
    lost = 4 * LIMIT * slipped + np.pi * DAMPER * 2 * np.pi * peak.frequency * peak.amplitude**2
    fed = -np.pi * level * peak.amplitude * np.sin(np.radians(peak.phase))
    # Interpolation between 60 amplitudes, and a damping ratio that is one at frequencies beside
    # that of the backbone.
    assert fed == pytest.approx(lost, rel=0.02)


def test_a_softening_mode_folds(slider, curve):
    """Between the turning points three motions belong to one frequency."""
    soft = replace(
        curve,
        frequency=curve.small_frequency / (1 + curve.modal_amplitude),
        damping_ratio=np.full(len(curve.frequency), 0.01),
    )
    found = fy.backbone_response(slider, soft, {"mass.Fx": 1.0}, (1.0, 6.0), [6.0])
    assert (np.diff(found.curves[0].frequency) < 0).any()


@pytest.mark.parametrize(
    ("load", "frequencies", "levels", "text"),
    [
        ({"mass.Fx": 0.0}, (1.0, 2.0), [1.0], "harmonic load is zero"),
        ({"other.Fx": 1.0}, (1.0, 2.0), [1.0], "does no work on mode 1"),
        ({"mass.Fx": 1.0}, (2.0, 1.0), [1.0], "give the lower first"),
        ({"mass.Fx": 1.0}, (1.0, 2.0), [-1.0], "give positive numbers"),
    ],
)
def test_what_is_refused(slider, curve, load, frequencies, levels, text):
    with pytest.raises(ModelError, match=text):
        fy.backbone_response(slider, curve, load, frequencies, levels)


def test_a_backbone_that_ends_below_the_peak_is_cut_and_says_so(slider, curve):
    found = fy.backbone_response(slider, curve, {"mass.Fx": 1.0}, (1.0, 6.0), [1e3])
    assert "beyond the largest amplitude" in found.remarks[1]
    with pytest.raises(ModelError, match=r"no component 'mass\.uy'"):
        found.curves[0].peak("mass.uy")
    above, below = found.plot("mass.ux")
    assert "per level" in above.get_ylabel()
    assert "phase" in below.get_ylabel()


@pytest.mark.parametrize(("apart", "said"), [(0.001, True), (0.5, False)])
def test_a_mode_beside_this_one_is_told(apart, said):
    """Two modes of equal load: beside each other both swing, half an octave apart one does."""
    frequency, damping = np.array([1.0]), 0.01
    linear = LinearResponse(
        components=("mass.Fx",),
        circular=2 * np.pi * np.array([1.0, 1.0 + apart]),
        damping=np.full(2, damping),
        forced=np.ones(2, dtype=complex),
        moved=np.ones((1, 2), dtype=complex),
        rest=np.zeros(1, dtype=complex),
    )
    swing = linear.swung(1.0, frequency)[:, 0]
    remarks = list(linear.companion(1.0, frequency, swing, 1))
    assert [remark[:24] for remark in remarks] == ["level 1: at the peak mod"] * said
