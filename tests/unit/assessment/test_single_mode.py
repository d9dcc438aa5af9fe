"""A mode from a frequency response: exact where there is nothing else, told where there is none."""

import numpy as np
import pytest

from faying.assessment.single_mode import single_mode
from faying.exceptions import ModelError

F = np.linspace(79.0, 81.0, 41)


def mode(f, frequency=80.3, ratio=0.002):
    return (1 + 2j) / (frequency**2 - f**2 + 2j * ratio * frequency * f)


def test_a_mode_and_a_constant_are_found_exactly():
    fitted = single_mode(F, mode(F) + 0.02 - 0.01j)
    # Least squares end where steps are 1e-12 of what they change.
    assert fitted.frequency == pytest.approx(80.3, rel=1e-9)
    assert fitted.damping_ratio == pytest.approx(0.002, rel=1e-7)
    assert fitted.residual < 1e-8


def test_another_mode_far_away_is_a_constant():
    fitted = single_mode(F, mode(F) + mode(F, frequency=300.0))
    # Over 2 Hz the other one changes by 4e-3 of its 1e-4 of the peak.
    assert fitted.frequency == pytest.approx(80.3, rel=1e-6)
    assert fitted.damping_ratio == pytest.approx(0.002, rel=1e-3)


@pytest.mark.parametrize(
    ("chosen", "match"),
    [(slice(0, 4), "needs 5 points"), (slice(0, 20), "on both sides of the resonance")],
)
def test_what_is_wrong_is_said(chosen, match):
    with pytest.raises(ModelError, match=match):
        single_mode(F[chosen], mode(F[chosen]))
