"""pyMOR takes the linear hand-over, agrees with it, and reduces it further."""

import sys

import numpy as np
import pytest

import faying as fy
from faying.exceptions import StudyError
from faying.export.linearized import linearize
from faying.export.pymor import second_order_model

pytestmark = pytest.mark.filterwarnings("ignore:::pymor")  # its own deprecations


@pytest.fixture(scope="module")
def given(joint, classic):
    pytest.importorskip("pymor", reason="pyMOR is not installed")
    return fy.reduce(joint, classic, compliance=True)


@pytest.fixture(scope="module")
def linear(given):
    return linearize(given)


@pytest.fixture(scope="module")
def fom(given):
    return second_order_model(given)


def test_frequency_response(linear, fom):
    for frequency in (0.0, 300.0, 644.0, 2000.0):
        s = 2j * np.pi * frequency
        dynamic = s**2 * linear.M + s * linear.C + linear.K
        own = linear.outputs @ np.linalg.solve(dynamic, linear.inputs) + linear.feedthrough
        # The same dense matrices in two programs; K of condition 1e8 at most.
        np.testing.assert_allclose(
            fom.transfer_function.eval_tf(s), own, rtol=1e-7, atol=1e-10 * np.abs(own).max()
        )


def test_poles_are_the_damped_frequencies(linear, fom):
    poles = fom.poles()
    found = np.sort(np.abs(poles[poles.imag > 0]))[:6] / (2 * np.pi)
    # |pole| is the undamped frequency under proportional damping; contact's stiffness has none,
    # which changes it by the square of a damping of at most 1 %.
    np.testing.assert_allclose(found, linear.frequencies(6), rtol=1e-3)


def test_static_gain_is_the_preloaded_joints_response(given, linear, fom):
    gain = fom.transfer_function.eval_tf(0.0).real
    column = gain[:, linear.input_names.index("tip.Fz")]
    first, second = (fy.solve_static(given, fy.Load({"tip.Fz": force})) for force in (1e-2, -1e-2))
    step = (first.displacement("tip") - second.displacement("tip")) / 2e-2
    # Differences of two solutions round to 1e-7.
    np.testing.assert_allclose(column[linear.output_names.index("tip.uz")], step[2], rtol=1e-6)


def test_pymor_reduces_it_further(linear):
    from pymor.reductors.interpolation import SOBHIReductor

    fom = second_order_model(linear, inputs=["tip.Fz"], outputs=["tip.uz"])
    # At points that are given; reductors that look for them magnify round-off beyond any bound.
    at = 2j * np.pi * np.array([0.0, 640.0, -640.0])
    rom = SOBHIReductor(fom).reduce(at, np.ones((3, 1)), np.ones((3, 1)))
    assert rom.order == 3
    for frequency in (0.0, 300.0, 630.0, 900.0):
        s = 2j * np.pi * frequency
        exact, found = (one.transfer_function.eval_tf(s)[0, 0] for one in (fom, rom))
        # Three of 17 coordinates around the first resonance at 645 Hz; 9e-5 were found at 900 Hz.
        assert abs(found / exact - 1) < 3e-4


def test_unknown_names_are_refused(linear):
    with pytest.raises(StudyError, match=r"no input 'tip\.fz'; did you mean 'tip\.Fz'"):
        second_order_model(linear, inputs=["tip.fz"])
    with pytest.raises(StudyError, match="no output 'pressure'"):
        second_order_model(linear, outputs=["pressure"])


def test_other_states_and_models(joint, classic, linear, fom):
    rom = fy.reduce(joint, classic, compliance=True)
    opened = second_order_model(fy.solve_static(rom, fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})))
    plain = second_order_model(rom)
    assert plain.order == opened.order == len(linear.K)
    at = 2j * np.pi * 100.0
    a, b, c = (one.transfer_function.eval_tf(at)[2, 2] for one in (fom, plain, opened))
    assert abs(a / b - 1) < 1e-6  # the same joint, R formed in two ways
    assert abs(a / c - 1) > 1e-3  # another contact area


def test_missing_pymor_names_the_extra(monkeypatch, linear):
    monkeypatch.setitem(sys.modules, "pymor.models.iosys", None)
    with pytest.raises(StudyError, match=r"faying\[pymor\]"):
        second_order_model(linear)
