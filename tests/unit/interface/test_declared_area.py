"""How much of the contact area that a deck declares is kept, and where that is said."""

import json

import h5py
import pytest
from typer.testing import CliRunner

from faying.cli import app
from lap_joints import tiny_lap
from small_study import NO_REPORT
from stacked_cantilevers import Stack

STACK = Stack(counts=((12, 2, 1),) * 3, penalty=1e3, force=2e3)
STUDY = """
[model]
source = "nastran"
file = "job.bdf"
[reduction]
methods = ["compliance"]
[[load_case]]
name = "press"
kind = "static"
forces = [{ deck_load = "1", value = 1.0 }]
"""
TILTED = "BCTSET,5,2,1,0.,,1.\n,,4,3,0.,,"


@pytest.fixture
def said(tmp_path):
    """Write the deck with the search distance of its second pair; return what a command prints."""

    def call(command, distance, study=STUDY):
        text = STACK.nastran(contact=["BCSET = 5"], more=TILTED + distance)
        # The tip of the top beam stands up: its gap grows from 0.1 to 0.7.
        lines = text.splitlines()
        for i, line in enumerate(lines):
            if line.startswith("GRID"):
                *head, x, _, z = line.split(",")
                if float(z) > 8.1:
                    raised = float(z) + 0.6 * (float(x) / 60.0)
                    lines[i] = ",".join([*head, x, line.split(",")[4], f"{raised:.6f}"])
        (tmp_path / "job.bdf").write_text("\n".join(lines) + "\n")
        (tmp_path / "study.toml").write_text(study)
        out = ["--out", str(tmp_path / "out")] if command == "run" else []
        result = CliRunner().invoke(app, [command, str(tmp_path / "study.toml"), *out])
        assert result.exit_code == 0, result.output
        return " ".join(result.output.split())

    return call


@pytest.mark.long
def test_all_is_kept_without_a_search_distance(said, tmp_path):
    assert "Doubtful" not in said("check", "")
    assert "Doubtful" not in said("run", "", STUDY + NO_REPORT)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    for face in summary["interfaces"].values():
        assert face["declared_area"] == pytest.approx(600.0, rel=1e-4)  # half of the tilt's 5e-5
        assert face["area"] == pytest.approx(face["declared_area"], rel=1e-4)


@pytest.mark.long
def test_what_is_left_out_is_said(said, tmp_path):
    """Gaps up to 0.4 are the inner half of the second gap: six of twelve rows."""
    expected = "interface 'contact-4-3': 50% of the declared contact area is paired (300"
    assert f"Doubtful: {expected}" in said("check", ".4")
    assert expected in said("run", ".4")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert [text[: len(expected)] for text in summary["warnings"]] == [expected]
    face = summary["interfaces"]["contact-4-3"]
    assert face["area"] == pytest.approx(0.5 * face["declared_area"], rel=1e-4)
    with h5py.File(tmp_path / "out" / "results.h5") as file:
        kept = file["interfaces/contact-4-3/declared_area"][()]
    assert kept == pytest.approx(face["declared_area"])
    report = " ".join((tmp_path / "out" / "report.html").read_text().split())
    assert "of the declared [%]" in report


def test_a_study_sets_the_search_distance(said):
    own = '[[interface]]\nname = "contact-4-3"\nsearch_distance = 0.4\n'
    assert "50% of the declared" in said("check", "", STUDY + own)


@pytest.mark.long
def test_gaps_that_no_load_closes(said, tmp_path):
    """A run without any contact has results and no error."""
    small = STUDY.replace("value = 1.0", "value = 1e-3")
    assert "Report:" in said("run", "", small)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    case = summary["load_cases"]["press"]
    assert case["reference"]["max_pressure"] == case["reference"]["contact_force"] == 0
    assert case["methods"]["compliance"]["0"]["max_relative_error"] == 0


def test_bodies_declare_no_area():
    model = tiny_lap()
    assert model.interfaces["joint"].declared_area is None
