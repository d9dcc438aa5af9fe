"""Scans of surfaces as study keys: what the gap becomes, what is noted, what is refused."""

import numpy as np
import pytest

from faying.cli.check import check
from faying.display.quantities import percent, quantity
from faying.exceptions import ModelError, StudyError
from faying.study.inputs.load_model import build
from faying.study.judgement.model_warnings import overlapping
from faying.study.keys.schema import parse_study

STUDY = """
[model]
source = "lap-joint"
lap_joint = { element_size = 5.0, hole_radius = 0.0 }

[[interface]]
name = "joint"

[[interface.topography]]
file = "scan.csv"
of = "plus"
origin = [0.0, 0.0, 0.0]
along = [1.0, 0.0, 0.0]
scale = 1e-3

[[bolt]]
name = "bolt"
preload = 1e3

[[load_case]]
name = "pull"
kind = "static"
forces = [{ boundary = "tip", component = "Fx", value = 1.0 }]
"""


@pytest.fixture
def built(tmp_path):
    x, y = (one.ravel() for one in np.meshgrid(np.linspace(-25, 25, 51), np.linspace(-12, 12, 25)))
    rows = np.column_stack([x, y, -0.02 * x**2 + 0.5 * y])
    np.savetxt(tmp_path / "scan.csv", rows, delimiter=",", header="x,y,z", comments="")

    def call(old="", new=""):
        assert old in STUDY
        return build(parse_study(STUDY.replace(old, new), tmp_path / "study.toml"))

    return call


def test_the_gap_is_that_of_the_scan(built):
    model = built()
    joint = model.interfaces["joint"]
    bowl = 2e-5 * joint.points[:, 0] ** 2
    np.testing.assert_allclose(joint.initial_gap, bowl - bowl.min(), atol=1e-9)
    (note,) = [text for text in model.assembly.ignored if text.startswith("topography")]
    assert note.startswith("topography of interface 'joint', plus: 1275 samples")
    assert "a tilt of 0.0005 removed" in note


def test_surfaces_that_a_tilt_brings_into_each_other_are_said_to_overlap(built):
    assert overlapping(built()) == []
    model = built("scale = 1e-3\n", 'scale = 1e-3\ntilt = "keep"\n')
    joint = model.interfaces["joint"]
    share = joint.weights[joint.initial_gap < 0].sum() / joint.area
    (said,) = overlapping(model)
    deepest = quantity(-joint.initial_gap.min(), "mm")
    assert f"interface 'joint' overlap by up to {deepest} on {percent(share)} of its" in said


@pytest.mark.long
def test_check_draws_the_gap(built, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    check(tmp_path / "study.toml", out=tmp_path)
    assert (tmp_path / "initial_gap.png").stat().st_size > 0


def test_both_keys_add_up(built):
    shimmed = built('name = "joint"\n', 'name = "joint"\ninitial_gap = 0.5\n')
    assert shimmed.interfaces["joint"].initial_gap.min() == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("old", "new", "error", "match"),
    [
        ('"scan.csv"', '"none.csv"', StudyError, "none.csv"),
        ('"plus"', '"upper"', StudyError, "of"),
        ('"plus"', '"gap"', ModelError, "the scan holds heights of a side, and is of 'gap'"),
        ("origin = [0.0", "origin = [99.0", ModelError, "lies off the samples"),
    ],
)
def test_what_is_wrong_is_said(built, old, new, error, match):
    with pytest.raises(error, match=match):
        built(old, new)
