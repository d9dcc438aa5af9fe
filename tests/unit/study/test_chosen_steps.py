"""Studies that leave time steps to the run: chosen, told, and the same for all methods."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from faying.cli import app
from faying.exceptions import StudyError
from faying.study.keys.schema import parse_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import NO_REPORT, TINY_JOINT, reduction, step

STUDY = (
    TINY_JOINT
    + "[damping]\nbeta = 1e-6\n"
    + reduction("compliance")
    + '[validation]\nreference = "REFERENCE"\n'
    + NO_REPORT
    + step("push", "Fz", -100.0, "rise_time = 4e-4\nduration = 4e-4\nSTEP\n")
)
AUTO = 'step = "auto"\ntolerance = 0.05\nsteps_per_period = 50'


def study(tmp_path, step=AUTO, reference="full"):
    text = STUDY.replace("STEP", step).replace("REFERENCE", reference)
    return parse_study(text, tmp_path / "joint.toml")


@pytest.mark.long
@pytest.mark.parametrize("reference", ["full", "none"])
def test_they_are_chosen_by_the_reference_and_told(tmp_path, reference):
    assert run(study(tmp_path, reference=reference), tmp_path / "out")["converged"]
    case = json.loads((tmp_path / "out" / "summary.json").read_text())["load_cases"]["push"]
    steps = case["steps"]
    assert steps["met"]
    assert 0 < steps["error"] <= steps["tolerance"] == 0.05
    kept = read_results(tmp_path / "out" / "results.h5").cases["push"]
    assert steps["count"] == kept.reference.substeps.sum() > len(kept.times)
    method = kept.methods["compliance"][0].response
    np.testing.assert_array_equal(method.substeps, kept.reference.substeps)
    assert kept.half_step is None
    assert "half_step" not in case
    assert case["step_check"] == "divided steps"
    assert case["methods"]["compliance"]["0"]["max_relative_error"] < 0.1


@pytest.mark.long
def test_console_and_report_name_them(tmp_path):
    text = STUDY.replace("STEP", AUTO).replace("REFERENCE", "none")
    (tmp_path / "joint.toml").write_text(text.replace("report = false", "report = true"))
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["run", str(tmp_path / "joint.toml"), "--out", str(out)])
    assert result.exit_code == 0
    for said in (result.output, (out / "report.html").read_text()):
        line = " ".join(said.split())
        assert " time steps were chosen in total, " in line
        assert "within the tolerance of 5.00%" in line
        assert "The half-step check is replaced by this estimate" in line
    assert "no time-step check was run" not in (out / "report.html").read_text()


def test_what_stands_for_auto(tmp_path):
    (case,) = study(tmp_path, 'step = "auto"').load_cases
    assert (case.step, case.tolerance, case.steps_per_period) == (None, 0.03, 100)
    (case,) = study(tmp_path, "step = 1e-5\ntolerance = 0.1").load_cases
    assert (case.step, case.tolerance) == (1e-5, 0.1)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('step = "auto"', 'step = "automatic"', "expected a positive number, or 'auto'"),
        ("tolerance = 0.05", "tolerance = 0", "tolerance"),
        ('kind = "step"\nrise_time = 4e-4', 'kind = "static"', "motion in time"),
    ],
)
def test_what_fits_nothing(tmp_path, old, new, said):
    text = STUDY.replace("STEP", AUTO).replace("REFERENCE", "full")
    assert old in text
    with pytest.raises(StudyError, match=said):
        parse_study(text.replace(old, new), tmp_path / "joint.toml")
