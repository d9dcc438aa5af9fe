import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from small_study import TINY_JOINT

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "nastran_deck.toml"


@pytest.fixture
def runner(monkeypatch):
    """A stand-in for the runner that records its calls and reports convergence as told."""
    calls = []
    summary = {
        "converged": True,
        "load_cases": {},
        "remarks": [],
        "warnings": [],
        "reference": {"kind": "full", "reason": ""},
        "timings": {"stages": {}},
        "verdict": {"holds": True, "sentence": "", "advice": [], "open_questions": [], "table": []},
    }

    def run(study, out, *, resume, progress, executor, since):
        calls.append((study, out, resume))
        return summary

    module = ModuleType("faying.workflow.run")
    module.run = run
    monkeypatch.setitem(sys.modules, "faying.workflow.run", module)
    return SimpleNamespace(calls=calls, result=summary)


def test_start_up_imports_nothing_heavy():
    heavy = ["numpy", "scipy", "matplotlib", "pydantic", "skfem", "h5py"]
    code = f"import sys, faying.cli; print([m for m in {heavy} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


@pytest.mark.parametrize("command", ["demo", "run", "check", "report"])
def test_every_command_has_help(call, command):
    status, out, _ = call(command, "--help")
    assert status == 0
    assert f"faying {command}" in out


def test_version(call):
    status, out, _ = call("--version")
    assert status == 0
    assert out.startswith("faying 0.")


@pytest.mark.parametrize("arguments", [["run"], ["runn"], ["check", "--colour"], ["demo", "extra"]])
def test_usage_errors_end_with_status_2(call, arguments):
    status, out, err = call(*arguments)
    assert status == 2
    assert out == ""
    assert "Error" in err


@pytest.mark.long
def test_bad_study_is_one_message_and_no_traceback(tmp_path):
    path = tmp_path / "STUDY.toml"
    path.write_text(EXAMPLE.read_text().replace("preload", "prelaod"))
    for command in ("run", "check"):
        arguments = [sys.executable, "-m", "faying", command, str(path)]
        found = subprocess.run(arguments, capture_output=True, text=True, cwd=tmp_path, check=False)
        assert found.returncode == 2
        assert found.stdout == ""
        assert "did you mean 'preload'?" in found.stderr
        assert "Traceback" not in found.stderr
    assert list(tmp_path.iterdir()) == [path]


def test_what_could_not_be_validated_is_said_and_changes_no_status(call, runner, tmp_path):
    runner.result["warnings"] = ["unseen loads: it met what nobody foresaw"]
    status, _, err = call("run", EXAMPLE, "--out", tmp_path / "results")
    assert status == 0
    assert "Warning: unseen loads: it met what nobody foresaw" in err


def test_run_passes_the_study_on(call, runner, tmp_path):
    out = tmp_path / "results"
    status, text, _ = call("run", EXAMPLE, "--out", out, "--resume")
    assert status == 0
    assert str(out) in text
    ((study, folder, resume),) = runner.calls
    assert (study.path, folder, resume) == (EXAMPLE, out, True)


def test_run_names_its_folder_after_the_study(call, monkeypatch, runner, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert call("run", EXAMPLE)[0] == 0
    assert (tmp_path / "nastran_deck-results").is_dir()
    assert runner.calls[0][2] is False


def test_missing_convergence_is_status_1(call, runner, tmp_path):
    runner.result["converged"] = False
    status, _, err = call("run", EXAMPLE, "--out", tmp_path)
    assert status == 1
    assert "summary.json" in err


@pytest.mark.parametrize(("options", "title"), [([], ""), (["--quick"], ", coarse")])
def test_demo_runs_the_packaged_study(call, runner, tmp_path, options, title):
    assert call("demo", "--out", tmp_path, *options)[0] == 0
    assert runner.calls[0][0].title == f"Bolted cantilever{title}"


def test_results_cannot_go_into_a_file(call, runner, tmp_path):
    (tmp_path / "file").write_text("")
    status, _, err = call("run", EXAMPLE, "--out", tmp_path / "file")
    assert status == 2
    assert "cannot write to folder" in err
    assert runner.calls == []


def test_nothing_to_compute(call, runner, tmp_path):
    path = tmp_path / "idle.toml"
    path.write_text(
        '[model]\nsource = "lap-joint"\n[[bolt]]\nname = "bolt"\npreload = 1.0\n'
        '[reduction]\nmethods = ["compliance"]\n'
    )
    status, _, err = call("run", path)
    assert status == 2
    assert "neither [[load_case]] nor [[frequency]]" in err


def test_check_tells_what_was_understood(call):
    status, out, _ = call("check", EXAMPLE)
    assert status == 0
    # 224 bricks of 5 x 5 x 5 mm and 7.82e-9 t/mm³ make 2.1896e-4 t; the M6 bar adds 4.42e-6 t
    for expected in ["224 hex8 (incompatible)", "0.000223382", "rigid couplings (RBE2)", "gauss-2"]:
        assert expected in out
    joint = next(line for line in out.splitlines() if line.strip().startswith("joint"))
    # 28 faces of 25 mm²; the automatic penalty is 10 E/h = 10 · 210000 / 5
    assert joint.split() == ["joint", "28", "44", "112", "gauss-2", "700", "0", "420000"]
    # The study's own names for the bodies, out of which and into which the normal points.
    sides = ["joint", "lower", "upper", "(0,", "0,", "1)", "both", "sides"]
    assert sides in [line.split() for line in out.splitlines()]


def test_report_needs_results(call, tmp_path):
    status, _, err = call("report", tmp_path)
    assert status == 2
    assert "no results.h5" in err


def test_tighten_prints_the_turns_and_writes_them(call, tmp_path):
    (tmp_path / "joint.toml").write_text(TINY_JOINT)
    table = tmp_path / "plan.csv"
    arguments = ("tighten", tmp_path / "joint.toml", "--passes", "2", "--out", table)
    status, output, error = call(*arguments)
    assert status == 0, error
    assert "All bolts end within 0.00% of their preloads" in output
    assert len(table.read_text().splitlines()) == 3
    loose = TINY_JOINT.replace("preload = 5e3", "preload = 0")
    (tmp_path / "loose.toml").write_text(loose)
    status, _, error = call("tighten", tmp_path / "loose.toml")
    assert status == 2
    assert "no bolt has a preload" in error


def test_fit_needs_parameters_and_band_needs_backbones(call, tmp_path):
    (tmp_path / "joint.toml").write_text(TINY_JOINT)
    status, _, error = call("fit", tmp_path / "joint.toml", "--out", tmp_path / "out")
    assert (status, "has no [[parameter]]" in error) == (2, True)
    parameter = '[[parameter]]\nname = "N"\nkeys = ["bolt.bolt.preload"]\nrange = [1e3, 9e3]\n'
    (tmp_path / "joint.toml").write_text(TINY_JOINT + parameter)
    status, _, error = call("band", tmp_path / "joint.toml", "--out", tmp_path / "out")
    assert (status, 'has no [[load_case]] of kind = "backbone"' in error) == (2, True)
