"""Crowned and hollow surfaces: what the gap becomes, alone and as a study key."""

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.interface.topography import Crown, crown_gap
from faying.study.inputs.load_model import build
from faying.study.keys.schema import parse_study
from small_study import TINY_JOINT

STUDY = (
    TINY_JOINT
    + """
[[interface]]
name = "joint"

[[interface.crown]]
origin = [0.0, 0.0, 0.0]
along = [2.0, 0.0, 0.0]
distance = 10.0
height = 0.01

[[load_case]]
name = "pull"
kind = "static"
forces = [{ boundary = "tip", component = "Fx", value = 1.0 }]
"""
)


@pytest.fixture
def joint(tmp_path):
    def call(old="", new=""):
        return build(parse_study(STUDY.replace(old, new), tmp_path / "s.toml")).interfaces["joint"]

    return call


def test_the_gap_grows_with_a_power_of_the_distance(joint):
    crowned, cubic = joint(), joint("height = 0.01", "height = 0.01\nexponent = 3")
    s = np.abs(crowned.points[:, 0]) / 10.0
    np.testing.assert_allclose(crowned.initial_gap, 0.01 * (s**2 - (s**2).min()), atol=1e-15)
    np.testing.assert_allclose(cubic.initial_gap, 0.01 * (s**3 - (s**3).min()), atol=1e-15)


def test_hollow_surfaces_touch_at_their_ends(joint):
    hollow = joint("height = 0.01", "height = -0.01")
    far = np.abs(hollow.points[:, 0])
    assert hollow.initial_gap.min() == 0.0
    assert far[np.argmin(hollow.initial_gap)] == pytest.approx(far.max())


def test_a_direction_is_needed(joint):
    crown = Crown(origin=(0, 0, 0), along=(0, 0, 0), distance=1.0, height=1.0)
    with pytest.raises(ModelError, match="is no direction"):
        crown_gap(joint(), [crown])
