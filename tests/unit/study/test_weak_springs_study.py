"""Weak springs in studies: what they carry is told, and a warning says where that is too much."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from faying.cli import app
from faying.study.inputs.load_model import build
from faying.study.keys.schema import read_study

PLATES = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, plates = 3, hole_radius = 0.0, washer_radius = 11.0, \
tip_suspension = [0.0, 0.0] }
weak_springs = WEAK

[[interface]]
name = "joint-1"
penalty = 1e6
FRICTION

[[interface]]
name = "joint-2"
penalty = 1e6
FRICTION

[[bolt]]
name = "bolt"
preload = 10e3

[[load_case]]
name = "pull"
kind = "static"
forces = [{ boundary = "tip", component = "Fx", value = 300.0 }]

[reduction]
normal_modes = 3
methods = ["compliance"]

[output]
report = false
"""


def written(folder, friction, weak='"auto"'):
    path = folder / "plates.toml"
    path.write_text(PLATES.replace("WEAK", weak).replace("FRICTION", friction))
    return path


def invoked(*words):
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


@pytest.mark.long
def test_friction_leaves_them_next_to_nothing(tmp_path):
    study = written(tmp_path, "friction = 0.4")
    assert "hold what nothing but contact does: " in invoked("check", study)
    invoked("run", study, "--out", tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    share = summary["load_cases"]["pull"]["reference"]["weak_share"]
    assert 0 < sum(share.values()) < 1e-5
    assert not [text for text in summary["warnings"] if "weak springs" in text]


@pytest.mark.long
def test_without_friction_run_and_solve_warn(tmp_path):
    study = written(tmp_path, "")
    said = invoked("run", study, "--out", tmp_path / "out")
    assert "pull: the weak springs lower-middle carry" in said
    share = json.loads((tmp_path / "out" / "summary.json").read_text())
    share = share["load_cases"]["pull"]["reference"]["weak_share"]["lower-middle"]
    invoked("reduce", study, "--out", tmp_path / "plates.faying")
    (tmp_path / "loads.csv").write_text("case,tip.Fx\nnone,0.0\nhalf,150.0\npull,300.0\n")
    solved = tmp_path / "solved"
    said = invoked("solve", tmp_path / "plates.faying", tmp_path / "loads.csv", "--out", solved)
    assert "pull: the weak springs lower-middle carry" in said
    worst = json.loads((solved / "summary.json").read_text())["static"]["worst"]
    # The same statics in modes and in finite elements.
    assert worst["weak_share.lower-middle"][0]["value"] == pytest.approx(share, rel=1e-6)


def test_a_study_is_checked_without_matrices(tmp_path, monkeypatch):
    def never(_assembly):
        pytest.fail("the matrices of the whole model were formed")

    monkeypatch.setattr("faying.joint.free_matrices.assemble_matrices", never)
    monkeypatch.setattr("faying.joint.expected_memory.MOST_COUNTED", 0)
    said = invoked("check", written(tmp_path, "friction = 0.4"))
    assert "hold what nothing but contact does: " in said


def test_a_number_is_their_stiffness(tmp_path):
    model = build(read_study(written(tmp_path, "friction = 0.4", "2.5")))
    pairs = np.concatenate([one.pairs for one in model.interfaces.values()])
    touching = model.assembly.mesh.node_ids[pairs].tolist()
    for support in model.weak_supports.values():
        assert support.stiffness == 2.5
        assert all(pair in touching for pair in support.nodes.tolist())


def test_a_dense_budget_of_studies_is_that_of_the_model(tmp_path):
    path = written(tmp_path, "friction = 0.1")
    path.write_text(path.read_text().replace("weak_springs", "dense_budget = 1e3\nweak_springs"))
    model = build(read_study(path))
    assert model.structure.dense_budget == model.contact.dense_budget == 1000
