"""[[frequency]] in studies: read, computed, kept, resumed, told, refused."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from faying.assessment import forced_joint
from faying.assessment.response_curve import ResponseCurve
from faying.exceptions import StudyError
from faying.files.flattening import flattened, restored
from faying.report.figures.frequency import frequency_figure
from faying.report.slip import measured_table, peak_table
from faying.study.judgement.remarks import vibrations
from faying.study.judgement.summary import summarize
from faying.study.keys.schema import parse_study, read_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import TINY_JOINT

STUDY = (
    TINY_JOINT
    + """
[[interface]]
name = "joint"
friction = 0.2

[damping]
alpha = 50.0

[reduction]
methods = ["compliance"]
normal_modes = 8

[validation]
reference = "none"

[output]
report = false

[requirement]
max_pressure = 5.0

[[frequency]]
name = "shaker"
forces = [{ boundary = "tip", component = "Fz", value = 2.0, phase = 90.0 }]
levels = [0.1, 1.0]
from = 640.0
to = 660.0
points = 2
harmonics = 1
samples = 16
"""
)


BESIDE = """
[[measurement]]
name = "test"
frequency = "shaker"
response = [{ file = "test.csv", level = 1.0, of = "acceleration", factor = 9810.0 }]
"""


def write_test(folder):
    """One mode at 650 and 1 %, in g per force, 0.02 per force at the peak."""
    f = np.linspace(620.0, 680.0, 61)
    displaced = 0.02 * 2j * 0.01 / (1 - (f / 650.0) ** 2 + 2j * 0.01 * f / 650.0)
    values = displaced * (2j * np.pi * f) ** 2 / 9810.0
    rows = [f"{x},{y.real},{y.imag}" for x, y in zip(f, values, strict=True)]
    (folder / "test.csv").write_text("\n".join(["frequency,real,imag", *rows]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("frequency")
    (path / "shaker.toml").write_text(STUDY + BESIDE)
    write_test(path)
    return path


def kept_curves(out):
    return read_results(out / "results.h5").frequencies["shaker"].response.curves


@pytest.mark.long
def test_a_run_keeps_its_levels_and_resumes(folder, monkeypatch):
    study, out = read_study(folder / "shaker.toml"), folder / "out"
    whole = forced_joint.ForcedJoint.curve

    def stopped(self, level, **arguments):
        if level == 1.0:
            raise KeyboardInterrupt
        return whole(self, level, **arguments)

    monkeypatch.setattr(forced_joint.ForcedJoint, "curve", stopped)
    with pytest.raises(KeyboardInterrupt):
        run(study, out)

    def only_the_last(self, level, **arguments):
        assert level == 1.0
        return whole(self, level, **arguments)

    monkeypatch.setattr(forced_joint.ForcedJoint, "curve", only_the_last)
    found = run(study, out, resume=True)
    assert found["converged"]
    (named,) = found["frequencies"].values()
    assert [one["level"] for one in named["levels"]] == [0.1, 1.0]
    verdict = found["verdict"]
    # Periods are load cases: what is demanded of the interface fails where pressure is largest.
    assert not verdict["holds"]
    (curve,) = [one for one in kept_curves(out) if one.level == 1.0]
    worst = max(curve.periods, key=lambda name: curve.periods[name].pressure.max())
    (row,) = [row for row in verdict["table"] if row["part"] == "joint"]
    assert (row["verdict"], row["where"]) == ("not met", f"shaker, level 1, {worst} Hz")
    largest = curve.contact.peak_pressure.max()
    assert curve.periods[worst].pressure.max() == pytest.approx(largest, rel=1e-12)
    kept = read_results(out / "results.h5")
    assert summarize(kept)["frequencies"] == found["frequencies"]
    record = kept.frequencies["shaker"]
    # The load leads the cosine by 90 degrees: i times the amplitude.
    assert record.response.load["tip.Fz"] == pytest.approx(2j)
    assert record.backbone.mode == 1
    small, large = record.response.curves
    assert {640.0, 660.0} <= set(small.frequency.round(9))
    assert [level.peak.at_end for level in record.peaks()] == [False, False]
    assert "peaks at" in "".join(vibrations(kept))
    *_, highest = record.peaks()
    rise = slice(highest.index + 1)
    rising = replace(
        large, frequency=large.frequency[rise], harmonics=large.harmonics[rise], contact=None
    )
    cut = replace(record, response=replace(record.response, curves=(rising,)))
    (said,) = vibrations(replace(kept, frequencies={"shaker": replace(cut, checks=())}))
    assert "is largest, without a peak between 'from' and 'to', at" in said
    (at_end,) = peak_table(replace(kept, frequencies={"shaker": cut})).rows
    assert at_end[0].text == "shaker, level 1, no peak between its frequencies"
    ((name, test),) = record.measured.items()
    flank = test.frequency > 651.0
    falling = replace(test, frequency=test.frequency[flank], harmonics=test.harmonics[flank])
    beside_cut = replace(record, measured={name: falling})
    (row,) = measured_table(replace(kept, frequencies={"shaker": beside_cut})).rows
    assert [cell.text for cell in row] == ["test, level 1", "neither curve"]
    again = restored(ResponseCurve, flattened(large))
    np.testing.assert_array_equal(again.harmonics, large.harmonics)
    np.testing.assert_array_equal(again.contact.load_work, large.contact.load_work)
    beside = named["measured"]["test, level 1"]
    assert beside["frequency"] == 650.0
    # Of two newtons; a mode is fitted to what is one.
    assert beside["amplitude"] == pytest.approx(0.04, rel=1e-9)
    assert beside["damping_ratio"] == pytest.approx(0.01, rel=1e-6)
    computed = large.peak("tip.uz")
    assert beside["frequency_error"] == pytest.approx(computed.frequency / 650 - 1, rel=1e-9)
    assert beside["amplitude_error"] == pytest.approx(computed.amplitude / 0.04 - 1, rel=1e-6)
    drawn = frequency_figure(kept, "shaker")
    assert [cell.text for cell in measured_table(kept).rows[0][:3]] == [
        "test, level 1",
        "both",
        "650",
    ]
    heights = [line.get_ydata().max() for line in drawn.figure.axes[0].lines]
    assert pytest.approx(0.04, rel=1e-9) in heights
    with (out / "frf.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["component"] == "tip.uz"]
    first = [row for row in rows if row["level"] == "0.1" and row["harmonic"] == "1"]
    np.testing.assert_allclose(
        [float(row["amplitude"]) for row in first], np.abs(small.response("tip.uz")), rtol=1e-14
    )
    with (out / "peaks.csv").open() as file:
        peak = next(row for row in csv.DictReader(file) if row["level"] == "1")
    assert float(peak["amplitude"]) == pytest.approx(large.peak("tip.uz").amplitude, rel=1e-14)
    # Where a tenth of the loss is friction's, the backbone was 1 % off at peaks.
    assert float(peak["expected_amplitude"]) == pytest.approx(float(peak["amplitude"]), rel=0.03)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("from = 640.0", "from = 670.0", "not below 'to' = 660; exchange or change them"),
        ("value = 2.0", "value = 0.0", "all forces are zero; give one an amplitude"),
        ("levels = [0.1, 1.0]", "levels = [1.0, 1.0]", "a level occurs twice; keep one"),
        ("samples = 16", "samples = 3", "expected at least four per harmonic, 4"),
        ('"tip"', '"top"', "no boundary 'top'; did you mean 'tip'"),
        ("points = 2", "points = 1", "points"),
        ("level = 1.0", "level = 2.0", "has no level 2; its levels are 0.1, 1"),
        ("level = 1.0", "amplitude = 1.0", "needs 'level'; add it"),
        ('frequency = "shaker"', 'frequency = "shakr"', "did you mean 'shaker'"),
        ('frequency = "shaker"', "mode = 1", "give 'load_case' and 'mode', or"),
        ('= "shaker"\nresp', '= "shaker"\nmode = 1\nresp', "remove one of them"),
        (
            "phase = 90.0 }",
            'phase = 90.0 }, { boundary = "tip", component = "Fy", value = 1.0 }',
            "per force",
        ),
        ("harmonics = 1", "harmonic = 1", "did you mean 'harmonics'"),
    ],
)
def test_what_is_refused(tmp_path, old, new, text):
    from faying.study.inputs.load_model import load_model

    write_test(tmp_path)
    assert (STUDY + BESIDE).count(old) == 1
    with pytest.raises(StudyError, match=text):
        load_model(parse_study((STUDY + BESIDE).replace(old, new), tmp_path / "shaker.toml"))


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("friction = 0.2", 'friction = 0.2\npenalty = "hard"', "give it a penalty"),
        ("points = 2", 'points = 2\nat = "tip.uw"', "did you mean 'tip.u"),
    ],
)
def test_what_the_model_refuses(tmp_path, old, new, text):
    from faying.study.stages.offline import prepare_joint

    with pytest.raises(StudyError, match=text):
        prepare_joint(parse_study(STUDY.replace(old, new), tmp_path / "s.toml"))
