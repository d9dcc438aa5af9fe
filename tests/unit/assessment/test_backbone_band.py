"""Bands of backbones: their ends, and amplitudes that not all of them reach."""

from types import SimpleNamespace

import numpy as np
import pytest

from faying.assessment.backbone_band import backbone_band
from faying.exceptions import ModelError


def curve(amplitude, frequency, damping):
    return SimpleNamespace(
        amplitude=np.array(amplitude),
        frequency=np.array(frequency),
        damping_ratio=np.array(damping),
        measured_at="tip",
        units="mm-t-s",
    )


def test_ends_are_those_of_the_backbones_that_reach_an_amplitude():
    first = curve([0.01, 0.1, 1.0], [100.0, 99.0, 98.0], [1e-3, 2e-3, 4e-3])
    # Round-off at its start, and an end before that of the other.
    other = curve([0.01 * (1 + 1e-12), 0.1, 0.5], [101.0, 97.0, 96.0], [1e-3, 4e-3, 8e-3])
    band = backbone_band([first, other])
    np.testing.assert_array_equal(band.samples, [2, 2, 1])
    np.testing.assert_allclose(band.frequency_low, [100.0, 97.0, 98.0])
    np.testing.assert_allclose(band.frequency_high, [101.0, 99.0, 98.0])
    np.testing.assert_allclose(band.damping_high, [1e-3, 4e-3, 4e-3])


def test_a_band_needs_backbones():
    with pytest.raises(ModelError, match="give one at least"):
        backbone_band([])
