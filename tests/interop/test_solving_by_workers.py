"""Many loads on one reduced model, shared among processes, next to this process alone."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.cli import app
from faying.exceptions import CampaignError, ConvergenceError, StudyError
from faying.execution import ProcessExecutor, SerialExecutor
from faying.execution.checkpoint import Checkpoint
from faying.study.inputs.load_set import read_loads
from faying.study.keys.schema import read_study
from faying.workflow import solve_cases
from faying.workflow.reduce import reduce_study
from faying.workflow.solve import solve_loads
from small_study import SMALL_JOINT

OTHER_PROCESS = 1e-12
"""Of values over the largest of their kind: libraries sum from other addresses in memory."""


@pytest.fixture(scope="module")
def model_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("model")
    (folder / "tiny.toml").write_text(SMALL_JOINT)
    reduce_study(read_study(folder / "tiny.toml"), folder / "tiny.faying", shapes=False)
    return folder / "tiny.faying"


@pytest.fixture(scope="module")
def rom(model_file):
    return fy.read_reduced_model(model_file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A table of cases that make several pieces, and two loads over time."""
    path = tmp_path_factory.mktemp("loads")
    values = np.random.default_rng(5).uniform(-1, 1, (50, 2)) * [300.0, 8e3]
    rows = [f"n{k},{z!r},{m!r}" for k, (z, m) in enumerate(values.tolist())]
    (path / "many.csv").write_text("\n".join(["case,tip.Fz,tip.Mx", *rows]))
    (path / "rides").mkdir()
    times = np.linspace(0, 4e-4, 41)
    for name, rate in (("slow", 5e3), ("static", 2e4)):
        rows = [f"{t!r},{-150 * float(np.sin(rate * t))!r}" for t in times.tolist()]
        (path / "rides" / f"{name}.csv").write_text("\n".join(["time,tip.Fz", *rows]))
    return path


@pytest.fixture(scope="module")
def loads(rom, folder):
    over_time = read_loads(folder / "rides", rom).transients
    return replace(read_loads(folder / "many.csv", rom), transients=over_time)


@pytest.fixture(autouse=True)
def short_pieces(monkeypatch):
    monkeypatch.setattr(solve_cases, "MOST", 20)


@pytest.fixture(scope="module")
def alone(rom, loads, tmp_path_factory):
    out = tmp_path_factory.mktemp("alone")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solve_cases, "MOST", 20)
        assert solve_loads(rom, loads, out)["converged"]
    return out


def tables(folder):
    found = {}
    for path in sorted(folder.glob("*.csv")):
        with path.open(newline="") as file:
            header, *rows = csv.reader(file)
        columns = zip(*rows, strict=True)
        found |= {
            (path.name, name): list(values) for name, values in zip(header, columns, strict=True)
        }
    return found


def same(found, expected):
    one, other = tables(found), tables(expected)
    assert one.keys() == other.keys()
    sizes = {
        key: np.abs(np.array(values, dtype=float)).max()
        for key, values in other.items()
        if key[1] != "case"
    }
    for key, values in other.items():
        if key[1] == "case":
            assert one[key] == values
            continue
        numbers = np.array([one[key], values], dtype=float)
        # Bounds of errors that are round-off themselves are nothing to compare; a component that
        # vanishes by symmetry is round-off of the others.
        vector = key[1].rpartition(".")[0] or key[1]
        like = [
            size
            for (file, name), size in sizes.items()
            if (file, name.rpartition(".")[0]) == (key[0], vector)
        ]
        scale = max(sizes[key], 1.0 if "error" in key[1] else 0.0, *like)
        assert np.abs(numbers[0] - numbers[1]).max() <= OTHER_PROCESS * scale, key


@pytest.mark.long
def test_processes_give_what_this_process_gives(rom, loads, alone, tmp_path):
    seen = []

    class Bar:
        def add_task(self, name, total=None):
            seen.append([name, total, 0])
            return len(seen) - 1

        def advance(self, task, advance=1):
            seen[task][2] += advance

        def remove_task(self, task):
            pass

    done = solve_loads(rom, loads, tmp_path, executor=ProcessExecutor(2), progress=Bar())
    assert done["converged"]
    assert not (tmp_path / "unfinished").exists()
    assert ["workers", 130, 130] in seen  # 50 cases and twice 40 steps
    same(tmp_path, alone)
    warnings = [json.loads((out / "summary.json").read_text()) for out in (tmp_path, alone)]
    assert warnings[0]["static"] == warnings[1]["static"]


def test_what_workers_have_finished_is_not_done_again(rom, loads, alone, tmp_path, monkeypatch):
    class Stopping(SerialExecutor):
        def map(self, prepare, tasks):
            results = super().map(prepare, tasks)
            yield next(results)
            yield next(results)
            yield next(results)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_loads(rom, loads, tmp_path, executor=Stopping())
    put, solved = Checkpoint.put, []
    monkeypatch.setattr(
        Checkpoint, "put", lambda self, key, arrays: (solved.append(key), put(self, key, arrays))
    )
    solve_loads(rom, loads, tmp_path, executor=SerialExecutor(), resume=True)
    assert solved == ["static 1", "static 2"]
    same(tmp_path, alone)


def test_a_load_over_time_may_be_called_like_the_cases(rom, loads, alone, tmp_path):
    assert ("history_static.csv", "time") in tables(alone)
    ride = next(one for one in loads.transients if one.load.name == "static")
    solve_loads(rom, replace(loads, names=(), transients=(ride,)), tmp_path)
    of_it = {key: values for key, values in tables(alone).items() if key[0].endswith("static.csv")}
    assert tables(tmp_path) == of_it


def test_a_case_without_solution_costs_no_other_of_a_worker(rom, loads, tmp_path, monkeypatch):
    solve, bad = solve_cases.solve_ramps, loads.inputs[4]

    def failing(system, inputs, rest, **increments):
        if (inputs == bad).all(axis=1).any():
            message = "did not settle"
            raise ConvergenceError(message)
        return solve(system, inputs, rest, **increments)

    monkeypatch.setattr(solve_cases, "solve_ramps", failing)
    static = replace(loads, transients=())
    done = solve_loads(rom, static, tmp_path, executor=SerialExecutor())
    assert done["not_converged"] == ["n4: did not settle"]


def test_workers_that_cannot_take_part_are_refused(rom, loads, tmp_path):
    out = tmp_path / "out"

    class Elsewhere(SerialExecutor):
        def map(self, prepare, tasks):
            (out / "unfinished").rename(out / "moved")
            return super().map(prepare, tasks)

    with pytest.raises(StudyError, match=r"a worker does not see .*unfinished"):
        solve_loads(rom, loads, out, executor=Elsewhere())


def test_two_tables_of_one_name_are_refused(rom, folder, tmp_path):
    text = (folder / "rides" / "slow.csv").read_text()
    for ending in (".csv", ".parquet"):
        (tmp_path / f"slow{ending}").write_text(text)
    with pytest.raises(StudyError, match="two tables named 'slow'"):
        read_loads(tmp_path, rom)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--workers", "0"], "give at least one"),
        (["--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], "exclude each other"),
    ],
)
def test_bad_options_are_one_message(model_file, folder, tmp_path, options, words):
    arguments = ["solve", str(model_file), str(folder / "many.csv"), "--out", str(tmp_path / "x")]
    result = CliRunner().invoke(app, [*arguments, *options])
    assert isinstance(result.exception, CampaignError)
    assert words in str(result.exception)
