"""Many loads on one file of a joint with friction: from where its bolts were tightened."""

import csv
import json

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.cli import app
from faying.exceptions import FormatError, ModelError, StudyError
from faying.execution.processes import ProcessExecutor
from faying.reduction.model_reader import PRELOAD_PATH, preload_path_of
from faying.study.inputs.load_set import read_loads
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.workflow.reduce import reduce_study
from faying.workflow.run import run
from faying.workflow.solve import bolt_loads, solve_loads
from faying.workflow.solve_cases import SolveOptions
from small_study import BEND, NO_REPORT, TINY_JOINT, UNCHECKED, reduction, static, step

LOADS = BEND + static("pull", "Fx", 1500.0) + step("jump", "Fx", 900.0).replace("0.5", "0.25")
STUDY = (
    "friction_during_preload = SWITCH\n"
    + TINY_JOINT.replace("5e3", "8e3")
    + '[damping]\nbeta = 1e-6\n[[interface]]\nname = "joint"\npenalty = 1e6\nfriction = 0.2\n'
    + reduction("compliance")
    + UNCHECKED
    + NO_REPORT
    + LOADS
)

EQUAL = 1e-9
"""Of the largest: both solve the same increments, each to 1e-11 of the largest force."""


@pytest.fixture(scope="module", params=["true", "false"])
def reduced(request, tmp_path_factory):
    """A study tightened with or without friction, its file, and the loads."""
    folder = tmp_path_factory.mktemp("rubbing")
    (folder / "study.toml").write_text(STUDY.replace("SWITCH", request.param))
    (folder / "loads.toml").write_text(LOADS)
    study = read_study(folder / "study.toml")
    reduce_study(study, folder / "one.faying", shapes=False)
    return study, folder / "one.faying", folder / "loads.toml"


def solved(file, loads, out, **given):
    rom = fy.read_reduced_model(file)
    path = bolt_loads(preload_path_of(file))
    return solve_loads(rom, read_loads(loads, rom), out, tightening=path, **given)


def column(path, name):
    with path.open(newline="") as file:
        return np.array([float(row[name]) for row in csv.DictReader(file)])


def off(found, expected):
    return np.abs(np.asarray(found) - expected).max() / np.abs(expected).max()


@pytest.mark.long
def test_results_are_those_of_a_run(reduced, tmp_path):
    """Static cases in the increments of a study; the step begins where the bolts were tightened."""
    study, file, loads = reduced
    assert run(study, tmp_path / "run")["converged"]
    cases = read_results(tmp_path / "run" / "results.h5").cases
    out = tmp_path / "solved"
    assert solved(file, loads, out, options=SolveOptions(named=("bend", "pull")))["converged"]
    expected = {name: case.methods["compliance"][0].response for name, case in cases.items()}
    with h5py.File(out / "fields.h5") as fields:
        names = fields["static/names"].asstr()[()].tolist()
        for name in ("bend", "pull"):
            pressure = fields["static/pressure"][names.index(name)]
            assert off(pressure, expected[name].pressure) < EQUAL
    traction, slip = (
        column(out / "metrics.csv", f"{one}.joint") for one in ("max_traction", "max_slip")
    )
    for row, name in enumerate(("bend", "pull")):
        path = expected[name].path
        assert traction[row] == pytest.approx(
            np.linalg.norm(path.traction[-1], axis=-1).max(), rel=EQUAL
        )
        assert slip[row] == pytest.approx(np.linalg.norm(path.slip[-1], axis=-1).max(), rel=EQUAL)
    bolt = column(out / "history_jump.csv", "bolt_force.bolt")
    assert off(bolt, expected["jump"].bolt_forces["bolt"]) < EQUAL


@pytest.mark.long
def test_workers_solve_the_same(reduced, tmp_path):
    _, file, loads = reduced
    solved(file, loads, tmp_path / "alone")
    solved(file, loads, tmp_path / "shared", executor=ProcessExecutor(2))
    for name in ("metrics.csv", "history_jump.csv"):
        alone, shared = ((tmp_path / one / name).read_bytes() for one in ("alone", "shared"))
        assert alone == shared


def test_files_that_do_not_say_how_they_were_tightened_are_refused(reduced, tmp_path):
    _, file, loads = reduced
    old = tmp_path / "old.faying"
    old.write_bytes(file.read_bytes())
    with h5py.File(old, "a") as members:
        del members["provenance"][PRELOAD_PATH]
    assert preload_path_of(old) is None
    result = CliRunner().invoke(app, ["solve", str(old), str(loads), "--out", str(tmp_path / "x")])
    assert result.exit_code != 0
    rom = fy.read_reduced_model(old)
    with pytest.raises(ModelError, match=r"'joint' has friction.*write it again"):
        solve_loads(rom, read_loads(loads, rom), tmp_path / "out")
    with h5py.File(old, "a") as members:
        members["provenance"][PRELOAD_PATH] = "[1]"
    with pytest.raises(FormatError, match="preload_path is not a list of bolt forces"):
        preload_path_of(old)


def test_increments_of_a_case_are_refused(reduced, tmp_path):
    _, file, loads = reduced
    rom = fy.read_reduced_model(file)
    finer = tmp_path / "finer.toml"
    finer.write_text(loads.read_text().replace('"static"', '"static"\nincrements = 20'))
    with pytest.raises(StudyError, match="'bend' has 'increments'"):
        read_loads(finer, rom)


@pytest.mark.long
def test_many_loads_have_the_verdict_of_a_run(tmp_path):
    """Followed until they open and slide, and at both ends of the scatter, in each its worst."""
    study, model = tmp_path / "rubbing.toml", tmp_path / "rubbing.faying"
    bolt = 'size = "M5"\ngrade = "8.8"\ntightening_factor = 1.4\n[damping]'
    demanded = "[requirement]\nmin_opening_factor = 1.2\nmin_sliding_factor = 1.2\n"
    demanded += "min_slip_safety = 1.1\n"
    once = STUDY.replace("SWITCH", "true").replace("[damping]", bolt)
    study.write_text(once.partition('[[load_case]]\nname = "jump"')[0] + demanded)
    read = read_study(study)
    expected = run(read, tmp_path / "run")
    reduce_study(read, model, shapes=False)
    runner = CliRunner()
    runner.invoke(app, ["solve", str(model), str(study), "--out", str(tmp_path / "out")])
    found = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert found["verdict"]["open_questions"] == expected["verdict"]["open_questions"]
    checks, others = (
        [check for part in one["verdict"]["parts"] for check in part["checks"]]
        for one in (found, expected)
    )
    assert {"opening", "sliding", "slip", "yield"} <= {check["quantity"] for check in checks}
    for check, other in zip(checks, others, strict=True):
        told = ["part", "quantity", "outcome", "limit"]
        # The range of a stress is over all cases, and both ends shift it alike.
        told += [] if check["quantity"] == "fatigue" else ["case", "scatter"]
        assert [check[key] for key in told] == [other[key] for key in told]
        # Factors are cut to a thousandth.
        assert check["value"] == pytest.approx(other["value"], rel=1e-3)
