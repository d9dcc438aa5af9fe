"""Measured curves beside computed backbones: read, compared, told, refused."""

import numpy as np
import pytest
from test_backbone_study import STUDY

from faying.assessment.measured_curve import MeasuredCurve, deviations
from faying.exceptions import StudyError
from faying.study.judgement.summary import summarize
from faying.study.keys.measurements import measured_curves
from faying.study.keys.schema import parse_study, read_study
from faying.study.results.store import read_results
from faying.workflow.run import run

TABLE = """
[[measurement]]
name = "hammer"
load_case = "ring"
mode = 1
file = "hammer.csv"
"""


@pytest.fixture
def study(tmp_path):
    def call(old="", new="", rows="amplitude,frequency,damping\n0.02,300,0.01\n0.002,310,0.005\n"):
        (tmp_path / "hammer.csv").write_text(rows)
        text = STUDY.replace("[2, 1]", "[1]").replace("[0.001, 0.1, 3]", "[0.001, 0.01, 2]")
        assert old in TABLE
        return parse_study(text + TABLE.replace(old, new), tmp_path / "ring.toml")

    return call


def curve(**columns):
    return MeasuredCurve(name="a", case="ring", mode=1, **columns)


def test_deviations_are_those_between_computed_amplitudes():
    class Computed:
        amplitude = np.array([1e-3, 1e-1])
        frequency = np.array([100.0, 90.0])
        damping_ratio = np.array([1e-3, 1e-1])

    found = deviations(
        curve(amplitude=np.array([1e-3, 1e-2, 1.0]), frequency=np.array([100.0, 100.0, 90.0])),
        Computed,
    )
    np.testing.assert_array_equal(np.isfinite(found.frequency), [True, True, False])
    # Half way by logarithms.
    np.testing.assert_allclose(found.frequency_error, [0.0, -0.05, np.nan], atol=1e-12)
    np.testing.assert_allclose(found.damping_ratio, [1e-3, 1e-2, np.nan], rtol=1e-12)
    assert np.isnan(found.damping_error).all()


@pytest.mark.long
def test_a_run_tells_how_far_it_is_off(study, tmp_path):
    read = study()
    text = STUDY.replace("[2, 1]", "[1]").replace("[0.001, 0.1, 3]", "[0.001, 0.01, 2]")
    (tmp_path / "ring.toml").write_text(text + TABLE)
    assert read.measurements[0].mode == 1
    summary = run(read_study(tmp_path / "ring.toml"), tmp_path / "out")
    found = summary["measurements"]["hammer"]
    assert found["amplitude"] == [0.002, 0.02]
    assert found["computed_frequency"][1] is None  # the backbone ends at 0.01
    error = found["computed_frequency"][0] / 310.0 - 1
    assert found["frequency_error"] == [pytest.approx(error, rel=1e-12), None]
    kept = read_results(tmp_path / "out" / "results.h5")
    assert summarize(kept)["measurements"] == summary["measurements"]


@pytest.mark.parametrize(
    ("old", "new", "rows", "match"),
    [
        ('"ring"', '"rign"', None, "there is no backbone 'rign'; did you mean 'ring'"),
        ("mode = 1", "mode = 2", None, "computes modes 1; name one of them"),
        ("", "", "amplitude,f\n1,2\n", "the first line must name either amplitude,frequency"),
        ("", "", "amplitude,frequency\n0,2\n", "must be positive"),
    ],
)
def test_what_is_wrong_is_said(study, old, new, rows, match):
    with pytest.raises(StudyError, match=match):
        study(old, new, **({} if rows is None else {"rows": rows}))


def response(frequency, ratio, derivatives=0):
    f = np.linspace(290.0, 310.0, 81)
    displacement = 1 / (frequency**2 - f**2 + 2j * ratio * frequency * f) + 1e-5
    return f, displacement * (2j * np.pi * f) ** derivatives


RESPONSES = """
[[measurement]]
name = "hammer"
load_case = "ring"
mode = 1

[[measurement.response]]
file = "large.csv"
amplitude = 0.02
of = "acceleration"

[[measurement.response]]
file = "small.FILE"
amplitude = 0.002
"""


def with_responses(study, tmp_path, ending):
    f, acceleration = response(300.0, 0.01, derivatives=2)
    rows = [f"{x},{y.real},{y.imag}" for x, y in zip(f, acceleration, strict=True)]
    (tmp_path / "large.csv").write_text("\n".join(["frequency,real,imag", *rows]))
    read = study(TABLE, RESPONSES.replace("FILE", ending))
    (curve,) = measured_curves(read)
    # A mode and a constant are all that there is; the text has 17 digits.
    np.testing.assert_allclose(curve.amplitude, [0.002, 0.02])
    np.testing.assert_allclose(curve.frequency, [301.0, 300.0], rtol=1e-8)
    np.testing.assert_allclose(curve.damping_ratio, [0.005, 0.01], rtol=1e-6)


def test_responses_give_a_point_each(study, tmp_path):
    f, small = response(301.0, 0.005)
    rows = [f"{x},{abs(y)},{np.angle(y)}" for x, y in zip(f, small, strict=True)]
    (tmp_path / "small.csv").write_text("\n".join(["frequency,magnitude,phase", *rows]))
    with_responses(study, tmp_path, "csv")
    with pytest.raises(StudyError, match="exactly one of 'file', 'response'"):
        study('file = "hammer.csv"', "")
    with pytest.raises(StudyError, match="no response is given; add a table"):
        study('file = "hammer.csv"', "response = []")
    (tmp_path / "small.csv").write_text("frequency,real,imag\n1,1,0\n2,1,0\n")
    with pytest.raises(StudyError, match="needs 5 points"):
        study(TABLE, RESPONSES.replace("FILE", "csv"))


def test_responses_of_uff_say_what_they_are(study, tmp_path):
    pyuff = pytest.importorskip("pyuff")
    f, velocity = response(301.0, 0.005, derivatives=1)
    path = tmp_path / "small.uff"
    function = pyuff.prepare_58(
        func_type=4, rsp_node=1, rsp_dir=3, ref_node=1, ref_dir=3, data=velocity, x=f,
        id1="velocity per force", rsp_ent_name="A", ref_ent_name="A", abscissa_spacing=1,
        binary=0, abscissa_spec_data_type=18, ordinate_spec_data_type=11,
        orddenom_spec_data_type=13,
    )  # fmt: skip
    pyuff.UFF(str(path)).write_sets([function], "overwrite")
    with_responses(study, tmp_path, "uff")
    path.write_text("no set")
    with pytest.raises(StudyError, match="found 0 functions"):
        study(TABLE, RESPONSES.replace("FILE", "uff"))
