"""One file of a reduced model, and many loads solved on it without the full one."""

import csv
import json
import os
import re
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.assessment.case_metrics import metrics_of
from faying.assessment.strength.preload_ends import BoltStrengths
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange, variation_of
from faying.cli import app
from faying.exceptions import ConvergenceError, FormatError, StudyError
from faying.execution.checkpoint import Checkpoint
from faying.files import contents
from faying.study.inputs.load_set import read_loads
from faying.study.inputs.load_table import read_load_table
from faying.study.keys.requirement_rules import requirements_of
from faying.study.keys.requirement_tables import MarginsSection
from faying.study.keys.schema import read_load_cases, read_study
from faying.study.results.store import read_results
from faying.workflow import deciding_cases, solve_cases
from faying.workflow.deciding_cases import Deciding
from faying.workflow.reduce import reduce_study
from faying.workflow.run import run
from faying.workflow.solve import solve_loads
from faying.workflow.solve_cases import SolveOptions
from small_study import BEND, JUMP, NO_REPORT, PULL, SMALL_JOINT, UNCHECKED, reduction

LOADS = BEND + PULL + JUMP
STUDY = (
    'title = "Tiny joint"\n'
    + SMALL_JOINT
    + reduction("jim-a", "compliance", joint_modes=[2])
    + UNCHECKED
    + NO_REPORT
    + LOADS
)

EQUAL = 1e-12
"""Of pressures over the largest: each is solved to round-off, from wherever it starts."""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "tiny.toml"
    path.write_text(STUDY)
    return read_study(path)


@pytest.fixture(scope="module")
def model_file(study, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("model") / "tiny.faying"
    reduce_study(study, path)
    return path


@pytest.fixture(scope="module")
def rom(model_file):
    return fy.read_reduced_model(model_file)


def table(path: Path) -> dict[str, list[str]]:
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return {name: [row[place] for row in rows[1:]] for place, name in enumerate(rows[0])}


def random_loads(path: Path, count: int, seed: int = 3) -> Path:
    values = np.random.default_rng(seed).uniform(-1, 1, (count, 2)) * [300.0, 8e3]
    rows = [f"n{k},{z!r},{m!r},{1 + k / 50!r}" for k, (z, m) in enumerate(values.tolist())]
    path.write_text("\n".join(["case,tip.Fz,tip.Mx,preload_factor", *rows]))
    return path


def largest_difference(found, expected) -> float:
    return float(np.abs(np.asarray(found) - expected).max() / np.abs(expected).max())


@pytest.mark.long
@pytest.mark.parametrize(("method", "size"), [("compliance", 0), ("jim-a", 2)])
def test_results_are_those_of_a_run(study, tmp_path, method, size):
    out = tmp_path / "run"
    assert run(study, out)["converged"]
    cases = read_results(out / "results.h5").cases
    reduce_study(study, tmp_path / "one.faying", method=method)
    (tmp_path / "loads.toml").write_text(LOADS)
    rom = fy.read_reduced_model(tmp_path / "one.faying")
    loads = read_loads(tmp_path / "loads.toml", rom)
    options = SolveOptions(named=("bend", "pull"))
    assert solve_loads(rom, loads, tmp_path / "solved", options)["converged"]
    with h5py.File(tmp_path / "solved" / "fields.h5") as file:
        names = file["static/names"].asstr()[()].tolist()
        for name in ("bend", "pull"):
            expected = cases[name].methods[method][size].response
            pressure = file["static/pressure"][names.index(name)]
            assert largest_difference(pressure, expected.pressure) < EQUAL
            assert largest_difference(file["static/gap"][names.index(name)], expected.gap) < EQUAL
        jump = cases["jump"].methods[method][size].response
        highest = file["transients/jump/envelope/max_pressure"][()]
        assert largest_difference(highest, jump.pressure.max(axis=0)) < EQUAL
    over_time = table(tmp_path / "solved" / "history_jump.csv")
    found = np.array(over_time["bolt_force.bolt"], dtype=float)
    assert largest_difference(found, jump.bolt_forces["bolt"]) < EQUAL


def test_metrics_and_envelopes_are_those_of_all_cases(rom, tmp_path, monkeypatch):
    monkeypatch.setattr(solve_cases, "MOST", 7)
    loads = read_loads(random_loads(tmp_path / "many.csv", 30), rom)
    solve_loads(rom, loads, tmp_path / "out", SolveOptions(worst=2))
    every = fy.solve_static_cases(
        rom,
        [
            fy.Load(
                {"tip.Fz": row[0], "tip.Mx": row[1]},
                bolt_forces={"bolt": row[2] * rom.bolts["bolt"].initial_force},
            )
            for row in zip(*read_load_table(tmp_path / "many.csv").columns.values(), strict=True)
        ],
    )
    found = table(tmp_path / "out" / "metrics.csv")
    assert found["case"] == [f"n{k}" for k in range(30)]
    expected = {
        "max_pressure.joint": every.max_pressure,
        "clamp_force.joint": every.contact_force("joint"),
        "bolt_force.bolt": every.bolt_force("bolt"),
        "open_area.joint": every.open_fraction() * rom.contact.weights.sum(),
        "displacement.tip.uz": every.displacement("tip")[:, 2],
    }
    for name, values in expected.items():
        assert largest_difference(np.array(found[name], dtype=float), values) < EQUAL, name
    low = np.array(found["clamp_force_low.joint"], dtype=float)
    high = np.array(found["clamp_force_high.joint"], dtype=float)
    assert ((low <= every.contact_force()) & (every.contact_force() <= high)).all()
    with h5py.File(tmp_path / "out" / "fields.h5") as file:
        envelope = file["static/envelope"]
        assert largest_difference(envelope["max_pressure"], every.pressure.max(axis=0)) < EQUAL
        assert largest_difference(envelope["min_pressure"], every.pressure.min(axis=0)) < EQUAL
        assert largest_difference(envelope["max_gap"], every.gap.max(axis=0)) < EQUAL
        highest = every.pressure.max(axis=0)
        at = envelope["max_pressure_case"][highest > 0]
        np.testing.assert_array_equal(at, every.pressure.argmax(axis=0)[highest > 0])
        names = file["static/names"].asstr()[()].tolist()
        worst = np.argsort(-every.max_pressure)[:2]
        assert {f"n{k}" for k in worst} <= set(names)
        pressure = file["static/pressure"][names.index(f"n{worst[0]}")]
        assert largest_difference(pressure, every.pressure[worst[0]]) < EQUAL
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    least = summary["static"]["worst"]["clamp_force.joint"][0]
    assert least["case"] == f"n{every.contact_force().argmin()}"
    assert summary["metrics"]["max_pressure.joint"]["unit"] == "MPa"


@pytest.mark.long
def test_interrupted_call_goes_on_where_it_was(rom, tmp_path, monkeypatch):
    monkeypatch.setattr(solve_cases, "MOST", 7)
    loads = read_loads(random_loads(tmp_path / "many.csv", 30), rom)
    solve_loads(rom, loads, tmp_path / "whole")
    put = Checkpoint.put

    def stopped(self, key, arrays):
        if key == "static 2":
            raise KeyboardInterrupt
        put(self, key, arrays)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "put", stopped)
        with pytest.raises(KeyboardInterrupt):
            solve_loads(rom, loads, tmp_path / "part")
    solved = []
    monkeypatch.setattr(
        Checkpoint, "put", lambda self, key, arrays: (solved.append(key), put(self, key, arrays))
    )
    solve_loads(rom, loads, tmp_path / "part", resume=True)
    assert solved == ["static 2", "static 3", "static 4"]
    texts = [(tmp_path / name / "metrics.csv").read_text() for name in ("part", "whole")]
    assert texts[0] == texts[1]
    assert not (tmp_path / "part" / "unfinished").exists()
    solved.clear()
    again = solve_loads(rom, loads, tmp_path / "part", resume=True)
    assert not solved
    assert "nothing was computed" in again["remarks"][-1]
    others = read_loads(random_loads(tmp_path / "many.csv", 30, seed=4), rom)
    (tmp_path / "part" / "unfinished").mkdir()
    (tmp_path / "part" / "unfinished" / "study.sha256").write_text("of something else")
    with pytest.raises(StudyError, match="--resume"):
        solve_loads(rom, others, tmp_path / "part", resume=True)


def test_opening_is_judged_where_the_search_for_the_first_that_opens_fails(
    rom, tmp_path, monkeypatch
):
    """A warning was all that was left of it, and the verdict spoke of the rest."""
    loads = read_loads(random_loads(tmp_path / "many.csv", 9), rom)

    def fail(*_):
        raise ConvergenceError("no equilibrium on the way")

    monkeypatch.setattr(Deciding, "openings", fail)
    summary = solve_loads(rom, loads, tmp_path / "out")
    assert any("no equilibrium on the way" in text for text in summary["warnings"])
    for part in summary["verdict"]["parts"]:
        if part["kind"] == "interface":
            assert any(check["quantity"] == "opening" for check in part["checks"])


def test_case_that_does_not_converge_is_named_and_costs_no_other(rom, tmp_path, monkeypatch):
    loads = read_loads(random_loads(tmp_path / "many.csv", 9), rom)
    solve, bad = solve_cases.solve_ramps, loads.inputs[4]

    def failing(system, inputs, rest, **options):
        if (inputs == bad).all(axis=1).any():
            message = "did not settle"
            raise ConvergenceError(message)
        return solve(system, inputs, rest, **options)

    monkeypatch.setattr(solve_cases, "solve_ramps", failing)
    done = solve_loads(rom, loads, tmp_path / "out")
    assert not done["converged"]
    assert done["not_converged"] == ["n4: did not settle"]
    peaks = np.array(table(tmp_path / "out" / "metrics.csv")["max_pressure.joint"], dtype=float)
    assert np.flatnonzero(np.isnan(peaks)).tolist() == [4]


def test_table_over_time_is_a_history(rom, tmp_path):
    times = np.linspace(0.0, 1e-3, 11)
    values = -150 * np.sin(3e3 * times)
    rows = [f"{t!r},{z!r}" for t, z in zip(times.tolist(), values.tolist(), strict=True)]
    folder = tmp_path / "histories"
    folder.mkdir()
    for name in ("one", "two"):
        (folder / f"{name}.csv").write_text("\n".join(["time,tip.Fz", *rows]))
    loads = read_loads(folder, rom, step=5e-5)
    solve_loads(rom, loads, tmp_path / "out")
    load = fy.Load({"tip.Fz": fy.History(times, values)})
    expected = fy.solve_transient(rom, load, step=5e-5, duration=1e-3)
    found = table(tmp_path / "out" / "history_two.csv")
    assert np.array(found["time"], dtype=float) == pytest.approx(expected.times, rel=1e-11)
    peaks = np.array(found["max_pressure.joint"], dtype=float)
    assert largest_difference(peaks, expected.max_pressure) < EQUAL
    assert read_loads(folder / "one.csv", rom).transients[0].step == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("times", "step"),
    [
        (np.linspace(0, 1, 100_001)[1:], 1e-5),  # begins after the first interval
        (np.round(np.arange(0, 501) * (1 / 30), 6), 1 / 30),  # of few digits
        (np.array([0.0, 1.0, 2.5, 4.0]), 1.0),
        (np.array([0.0, 1.0, 2.5]), 2.5 / 3),  # whole steps end with the table
    ],
)
def test_steps_are_the_intervals_of_a_table(rom, tmp_path, times, step):
    rows = [f"{time!r},{time!r}" for time in times.tolist()]
    (tmp_path / "ride.csv").write_text("\n".join(["time,tip.Fz", *rows]))
    one = read_loads(tmp_path / "ride.csv", rom).transients[0]
    assert one.step == pytest.approx(step, rel=1e-6)  # six digits are written
    assert one.duration / one.step == pytest.approx(round(one.duration / one.step), rel=1e-12)


@pytest.mark.parametrize("stopped", ["transient jump 2", "transient jump stand", "fields"])
def test_interrupted_transient_goes_on_in_its_middle(rom, tmp_path, monkeypatch, stopped):
    """Stopped before a piece is kept, between it and where the motion stands, and at the end."""
    monkeypatch.setattr(solve_cases, "MOST", 3)
    (tmp_path / "jump.toml").write_text(LOADS)
    every = read_loads(tmp_path / "jump.toml", rom)
    loads = replace(every, names=(), inputs=every.inputs[:0])
    solve_loads(rom, loads, tmp_path / "whole")
    put, seen, kept = Checkpoint.put, [], []

    def stopping(self, key, arrays):
        seen.append(key)
        if stopped == key and seen.count(key) == (2 if key.endswith("stand") else 1):
            raise KeyboardInterrupt
        put(self, key, arrays)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "put", stopping)
        if stopped == "fields":
            patch.setattr("faying.workflow.solve.write_solved", interrupted)
        with pytest.raises(KeyboardInterrupt):
            solve_loads(rom, loads, tmp_path / "part")
    monkeypatch.setattr(
        Checkpoint, "put", lambda self, key, arrays: (kept.append(key), put(self, key, arrays))
    )
    solve_loads(rom, loads, tmp_path / "part", resume=True)
    again = [key for key in kept if not key.endswith(("stand", "end"))]
    first = {"transient jump 2": 2, "transient jump stand": 1, "fields": 4}[stopped]
    assert again == [f"transient jump {number}" for number in range(first, 4)]
    texts = [(tmp_path / name / "history_jump.csv").read_text() for name in ("part", "whole")]
    assert texts[0] == texts[1]  # to the bit


def interrupted(*_):
    raise KeyboardInterrupt


def test_long_transients_are_solved_in_pieces(rom, tmp_path, monkeypatch):
    (tmp_path / "jump.toml").write_text(LOADS)
    loads = replace(read_loads(tmp_path / "jump.toml", rom), names=())
    solve_loads(rom, loads, tmp_path / "one")
    monkeypatch.setattr(solve_cases, "MOST", 3)
    solve_loads(rom, loads, tmp_path / "several")
    whole, several = (table(tmp_path / name / "history_jump.csv") for name in ("one", "several"))
    assert list(whole) == list(several)
    one, other = (
        {name: np.array(values, dtype=float) for name, values in columns.items()}
        for columns in (whole, several)
    )
    for name, values in one.items():
        # Twelve digits are written, and how NumPy sums a row depends on how many there are. What
        # symmetry keeps at zero along one axis is measured by what moves along the others.
        alike = [np.abs(one[column]).max() for column in one if column[:-1] == name[:-1]]
        assert np.abs(values - other[name]).max() <= 1e-10 * max(alike), name


BAD_TABLES = {
    "tip.Fz,tip.Mq\n1,2": r"no column 'tip.Mq'; did you mean 'tip.M",
    "preload_factor.nut\n1": r"no column 'preload_factor.nut'; did you mean 'preload_factor'",
    "preload_factor\n1\n10000": r"row 2: column 'preload_factor' has 10000, expected a factor",
    "tip.Fz,preload_factor.bolt\n1,-1": r"row 1: column 'preload_factor.bolt' has -1, expected a",
    "tip.Fz,preload\n1,1": r"no column 'preload'; did you mean 'preload_factor'",
    "tip.Fz,tip.Mx\n1,2\n1,x\ninf,3": r"(?s)line 3: found 'x' in column 'tip.Mx'.*line 4.*'inf'",
    "tip.Fz,tip.Mx\n1,2\n1": r"line 3: found 1 cells, expected 2",
    "1,2\n3,4": "line 1: found numbers",
    "tip.Fz,tip.Fz\n3,4": "'tip.Fz' occurs twice",
    "case,tip.Fz\na,1\na,2": "two rows have the name 'a'",
    "tip.Fz": "found 0 rows",
    "case\na": "expected a header with columns of loads",
    "": "is empty",
    "time,tip.Fz\n0,1\n0,2": "increase",
    "time,preload_factor\n0,1\n1,2": "cannot change over time",
    "tip.Fz\n1\n1_0": "line 3: found '1_0' in column 'tip.Fz'",
    "tip.Fz,tip.Fx\n1,1\n1e308,1": "row 2: column 'tip.Fz' has 1e.308, expected .* up to 1e.30",
    "time,tip.Fz\n0,1\n1e308,1": "row 2: column 'time' has 1e\\+308",
    "time,tip.Fz\n0,1\n1e-320,1": "the time step is 9.99989e-321 .* expected both from 1e-30",
    "case,tip.Fz\na\0b,1": r"row 1: the name 'a\\x00b' has 3 characters, .* printable ones",
    f"case,tip.Fz\nb,1\n{'a' * 300},1": "row 2: the name 'a{40}' has 300 characters, .* most 200",
    f'case,tip.Fz\n"{"a" * 200_000},1': "line 2: field larger than field limit",
    f'"{"a" * 200_000},1\n2,3': "line 1: field larger than field limit",
}


@pytest.mark.parametrize("text", BAD_TABLES, ids=range(len(BAD_TABLES)))
def test_bad_tables_are_refused_with_their_place(rom, tmp_path, text):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises((StudyError, FormatError), match=BAD_TABLES[text]):
        read_loads(path, rom)


def test_comments_names_with_commas_and_empty_lines_are_read(tmp_path):
    path = tmp_path / "loads.csv"
    path.write_text('# by hand\ncase, tip.Fz\n\n"gust, #4", 1.5\nplain,2\n')
    found = read_load_table(path)
    assert found.names == ("gust, #4", "plain")
    assert found.columns["tip.Fz"].tolist() == [1.5, 2.0]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[[bolt]]\nname = 'b'", "unknown key 'bolt' at the top of loads.toml"),
        ("title = 'none'", "no .*load_case"),
        (LOADS.replace('"Fz"', '"Fq"'), "(?s)'component' in .*load_case.* number 1.*line 4"),
        (LOADS + "step = 1e-6", "each give the time step"),
        (LOADS + "forces = [{ value = 1.0,", "loads.toml is not valid TOML: "),
    ],
)
def test_bad_load_cases_are_refused_with_their_place(tmp_path, text, expected):
    path = tmp_path / "loads.toml"
    path.write_text(text)
    with pytest.raises(StudyError, match=expected):
        read_load_cases(path)


def test_paths_are_left_to_studies(rom, tmp_path):
    (tmp_path / "loads.toml").write_text(LOADS.replace('"static"', '"cycle"'))
    with pytest.raises(StudyError, match="'bend' is a cycle, which only a run"):
        read_loads(tmp_path / "loads.toml", rom)


def test_time_in_periods_needs_the_period_of_the_full_model(rom, tmp_path):
    (tmp_path / "loads.toml").write_text(LOADS)
    with pytest.raises(StudyError, match="'jump' measures time in the longest period"):
        read_loads(tmp_path / "loads.toml", replace(rom, period=None))


def test_file_keeps_what_made_it(model_file, rom, study):
    with h5py.File(model_file) as file:
        assert file["provenance/study"].asstr()[()] == study.text
        assert file["period"].attrs["unit"] == "s"
    assert rom.period == pytest.approx(0.00284, rel=0.01)  # 1 / 352 Hz of the same joint
    ends = rom.bolts["bolt"].ends
    assert ends[:, 2].tolist() == [-10.0, 10.0] or np.ptp(ends[:, 2]) == pytest.approx(20.0)


@pytest.mark.parametrize(
    ("method", "expected"),
    [("nmf", "expected one of"), ("complaince", "did you mean"), ("jim-b", "training")],
)
def test_methods_that_cannot_be_kept_are_refused(study, tmp_path, method, expected):
    with pytest.raises(StudyError, match=expected):
        reduce_study(study, tmp_path / "x.faying", method=method)
    assert not list(tmp_path.iterdir())


def write_parquet(path: Path, columns) -> Path:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    import pyarrow

    parquet.write_table(pyarrow.table(columns), path)
    return path


def test_parquet_in_and_out(rom, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    random_loads(tmp_path / "many.csv", 5)
    known = read_load_table(tmp_path / "many.csv")
    columns = {"case": list(known.names), **known.columns}
    loads = read_loads(write_parquet(tmp_path / "many.parquet", columns), rom)
    np.testing.assert_array_equal(loads.inputs, read_loads(tmp_path / "many.csv", rom).inputs)
    solve_loads(rom, loads, tmp_path / "out", SolveOptions(table="parquet"))
    solve_loads(rom, loads, tmp_path / "text")
    found = parquet.read_table(tmp_path / "out" / "metrics.parquet")
    names = [one.name for one in metrics_of(rom, rom.interfaces, certified=True)]
    assert found.column_names == ["case", *names]
    assert found.schema.field("clamp_force.joint").metadata[b"unit"] == b"N"
    texts = table(tmp_path / "text" / "metrics.csv")
    assert found.column("case").to_pylist() == texts["case"]
    for name in names:  # sixteen digits are written to csv
        expected = pytest.approx(np.array(texts[name], dtype=float), rel=1e-15, abs=0.0)
        assert found.column(name).to_numpy() == expected, name


def test_parquet_over_time_in_and_out(rom, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    columns = {"time": np.linspace(0.0, 1e-3, 11), "tip.Fz": np.linspace(0.0, -150.0, 11)}
    loads = read_loads(write_parquet(tmp_path / "ride.parquet", columns), rom)
    solve_loads(rom, loads, tmp_path / "out", SolveOptions(table="parquet"))
    solve_loads(rom, loads, tmp_path / "text")
    found = parquet.read_table(tmp_path / "out" / "history_ride.parquet")
    texts = table(tmp_path / "text" / "history_ride.csv")
    assert found.column_names == list(texts)
    assert found.num_rows == 11
    peaks = pytest.approx(np.array(texts["max_pressure.joint"], dtype=float), rel=1e-15)
    assert found.column("max_pressure.joint").to_numpy() == peaks


BAD_PARQUET = {
    "text": ({"tip.Fz": ["a"], "tip.Mx": [True]}, "(?s)'tip.Fz' holds string.*'tip.Mx' holds bool"),
    "empty": ({"tip.Fz": [1.0, None]}, "row 2: column 'tip.Fz' is empty or not finite"),
    "no name": ({"case": ["a", None], "tip.Fz": [1, 2]}, "row 2: column 'case' is empty"),
    "names": ({"case": ["a", "a"], "tip.Fz": [1, 2]}, "two rows have the name 'a'"),
    "loads": ({"case": ["a", "b"]}, "expected a header with columns of loads"),
    "column": ({"tip.Fq": [1, 2]}, "no column 'tip.Fq'; did you mean 'tip.F"),
    "large": (
        {"tip.Fz": [1.0, -1e31]},
        "row 2: column 'tip.Fz' has -1e\\+31, expected a magnitude",
    ),
    "shown": ({"case": ["a", "\x1b[2J"], "tip.Fz": [1, 2]}, r"row 2: the name '\\x1b\[2J'"),
}


@pytest.mark.parametrize("kind", BAD_PARQUET)
def test_bad_parquet_is_refused_with_its_place(rom, tmp_path, kind):
    columns, expected = BAD_PARQUET[kind]
    with pytest.raises(StudyError, match=expected):
        read_loads(write_parquet(tmp_path / "bad.parquet", columns), rom)


def test_whole_numbers_beyond_double_precision_are_rounded(tmp_path):
    path = write_parquet(tmp_path / "large.parquet", {"tip.Fz": [2**62 + 1, 3]})
    table = read_load_table(path)
    assert table.columns["tip.Fz"].tolist() == [2.0**62, 3.0]
    assert (list(table.names), table.names[:1]) == (["1", "2"], ["1"])


def test_parquet_larger_than_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch):
    """A column of zeros takes next to nothing in the file."""
    path = write_parquet(tmp_path / "zeros.parquet", {"tip.Fz": np.zeros(200_000)})
    assert path.stat().st_size < 10_000
    monkeypatch.setattr(contents, "free_memory", lambda: 1_000_000)
    with pytest.raises(
        StudyError, match=r"zeros\.parquet: .*it holds 0\.0064 GB, and 0\.001 GB of"
    ):
        read_load_table(path)


def test_pipes_are_not_waited_for(tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    os.mkfifo(tmp_path / "pipe.parquet")
    with pytest.raises(StudyError, match=r"pipe\.parquet: .*device or pipe, not a file"):
        read_load_table(tmp_path / "pipe.parquet")


def test_parquet_whose_names_are_no_text_is_refused(tmp_path):
    path = write_parquet(tmp_path / "names.parquet", {"tip.Fz": [1.0, 2.0]})
    path.write_bytes(path.read_bytes().replace(b"tip.Fz", b"tip.\xff\xfe"))
    with pytest.raises(StudyError, match=r"cannot read the loads .*names\.parquet"):
        read_load_table(path)


def test_file_that_is_no_parquet_is_refused(rom, tmp_path):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    (tmp_path / "bad.parquet").write_text("tip.Fz\n1")
    with pytest.raises(StudyError, match=r"cannot read the loads .*bad.parquet: .*as csv"):
        read_loads(tmp_path / "bad.parquet", rom)
    with pytest.raises(StudyError, match=r"cannot read the loads .*none.parquet"):
        read_loads(tmp_path / "none.parquet", rom)


def test_parquet_without_pyarrow_is_refused_before_anything_is_solved(rom, tmp_path, monkeypatch):
    loads = read_loads(random_loads(tmp_path / "many.csv", 5), rom)
    (tmp_path / "many.parquet").write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    remedy = r"needs pyarrow, which is not installed; pip install 'faying\[parquet\]', or "
    with pytest.raises(StudyError, match=rf"many.parquet {remedy}save the table as csv"):
        read_loads(tmp_path / "many.parquet", rom)
    with pytest.raises(StudyError, match=rf"--table parquet {remedy}use csv"):
        solve_loads(rom, loads, tmp_path / "out", SolveOptions(table="parquet"))
    assert not (tmp_path / "out").exists()


def test_commands(study, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    made = runner.invoke(app, ["reduce", str(study.path), "--no-shapes"])
    assert made.exit_code == 0, made.output
    assert "Wrote tiny.faying" in made.output
    random_loads(tmp_path / "many.csv", 5)
    solved = runner.invoke(app, ["solve", "tiny.faying", "many.csv", "--keep", "n3"])
    assert solved.exit_code == 0, solved.output
    assert "Worst of 5 static cases" in solved.output
    assert {path.name for path in (tmp_path / "many-solved").iterdir()} == {
        "metrics.csv",
        "fields.h5",
        "summary.json",
    }
    wrong = runner.invoke(app, ["solve", "tiny.faying", "many.csv", "--keep", "n33"])
    assert isinstance(wrong.exception, StudyError)
    other = runner.invoke(app, ["solve", str(study.path), "many.csv"])
    assert isinstance(other.exception, FormatError)


REQUIRED = """
[requirement]
min_clamp_force = LIMIT
max_pressure = 1e3
max_nodal_pressure = 1e3
no_opening_within = 8.0
min_opening_factor = 1.0
closed_ring = [{ around = [0.0, 0.0, 0.0] }]
"""

SLIP = "slip_friction = 0.15\nmin_slip_safety = 1.0\n"


def test_requirements_are_those_that_an_assessment_judges(rom, tmp_path):
    path = tmp_path / "loads.toml"
    path.write_text(
        LOADS.partition('[[load_case]]\nname = "jump"')[0]
        + REQUIRED.replace("LIMIT", f"1.0\n{SLIP}")
    )
    loads = read_loads(path, rom)
    wanted = requirements_of(loads.requirement)
    options = SolveOptions(requirements=wanted)
    summary = solve_loads(rom, loads, tmp_path / "out", options)
    found = summary["assessment"]["verdicts"]
    # Each requirement is a check of the table, which says of it what the verdict does.
    checks = [check for part in summary["verdict"]["parts"] for check in part["checks"]]
    demanded = {(one["quantity"], one["outcome"], one["case"]) for one in checks if one["required"]}
    marks = {True: "met", False: "not met"}
    names = {
        "min_clamp_force": "clamp force",
        "max_pressure": "pressure",
        "max_nodal_pressure": "pressure, nodal average",
        "no_opening_within": f"pressed within {wanted.no_opening_within:g} mm",
        "closed_ring": "pressure on the ring",
        "min_opening_factor": "opening",
        "min_slip_safety": "slip",
    }
    assert demanded == {
        (names[one["requirement"]], marks[one["met"]], one["case"] if one["value"] else "")
        for one in found
    }
    assert summary["verdict"]["holds"] == all(one["met"] for one in found)
    each = [fy.Load({"tip.Fz": -150.0}, name="bend"), fy.Load({"tip.Fx": 900.0}, name="pull")]
    expected = {one.requirement: one for one in fy.assess(rom, each, wanted).verdicts}
    assert [one["requirement"] for one in found] == [
        "min_clamp_force",
        "max_pressure",
        "max_nodal_pressure",
        "no_opening_within",
        "min_opening_factor",
        "min_slip_safety",
        "closed_ring",
    ]
    for one in found:
        other = expected[one["requirement"]]
        assert (one["met"], one["place"], one["case"]) == (other.met, other.place, other.case)
        # Solved together and one by one, to round-off of the largest pressure.
        value = np.inf if one["value"] is None else one["value"]
        assert value == pytest.approx(other.value, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("limit", "status"), [("1.0", 0), ("9e9", 3)])
def test_requirements_of_the_study_in_the_file_decide_the_status(tmp_path, limit, status):
    study = tmp_path / "tiny.toml"
    study.write_text(STUDY + f"[requirement]\nmin_clamp_force = {limit}\n")
    runner = CliRunner()
    model = str(tmp_path / "tiny.faying")
    assert runner.invoke(app, ["reduce", str(study), "--out", model]).exit_code == 0
    loads = tmp_path / "loads.csv"
    loads.write_text("case,tip.Fz\na,-10\nb,-150\n")
    done = runner.invoke(app, ["solve", model, str(loads), "--out", str(tmp_path / "out")])
    assert done.exit_code == status, done.output
    assert "clamp force" in " ".join(done.output.split())
    assert ("does not hold" in done.output) == (status == 3)


def test_strength_is_judged_over_all_cases(rom, tmp_path):
    """Whether demanded or not, at the case where it is used most."""
    path = tmp_path / "loads.csv"
    path.write_text("case,tip.Fz\na,-10\nb,-150\nc,-50\n")
    loads = read_loads(path, rom)
    thread = Thread(diameter=3.0, pitch=0.5, grade="4.6", friction=0.12)
    options = SolveOptions(strengths=BoltStrengths(threads={"bolt": thread}))
    summary = solve_loads(rom, loads, tmp_path / "out", options)
    each = [fy.Load({"tip.Fz": force}, name=name) for name, force in (("a", -10.0), ("b", -150.0))]
    expected = fy.assess(rom, each, threads={"bolt": thread}, paths=False).checks
    bolt = summary["verdict"]["parts"][0]
    found = {one["quantity"]: one for one in bolt["checks"]}
    (stress,) = (one for one in expected if one.quantity == "yield")
    assert (found["yield"]["case"], found["yield"]["outcome"]) == (stress.case, "not met")
    assert found["yield"]["value"] == pytest.approx(stress.value, rel=1e-9)
    assert bolt["outcome"] == "not met"
    assert not summary["verdict"]["holds"]
    assert all(one["instant"] is None for one in bolt["checks"])
    assert found["tightening"]["case"] == ""  # before any load


def test_fatigue_and_the_ends_of_preloads_are_judged_over_all_cases(rom, tmp_path):
    """As ``fy.assess`` judges them, where the cases that decide are those solved anew."""
    forces = {"a": -10.0, "b": -150.0, "c": -50.0, "d": 120.0}
    path = tmp_path / "loads.csv"
    rows = "".join(f"{name},{force}\n" for name, force in forces.items())
    path.write_text(f"case,tip.Fz\n{rows}")
    thread = Thread(diameter=6.0, pitch=1.0, grade="8.8", friction=0.12)
    spread = PreloadRange(variation=variation_of(1.6))
    strengths = BoltStrengths(
        threads={"bolt": thread},
        ranges={"bolt": spread},
    )
    margins = MarginsSection(standard="nasa-std-5020b", FS_u=1.4)
    options = SolveOptions(strengths=strengths, margins=margins)
    summary = solve_loads(rom, read_loads(path, rom), tmp_path / "out", options)
    each = [fy.Load({"tip.Fz": force}, name=name) for name, force in forces.items()]
    scatter = fy.PreloadScatter(tightening_factor=1.6, samples=1)
    threads = {"bolt": thread}
    expected = fy.assess(rom, each, threads=threads, paths=False, scatter=scatter).checks
    checks = [check for part in summary["verdict"]["parts"] for check in part["checks"]]
    found = {(check["part"], check["quantity"]): check for check in checks}
    assert any(bolt.bending is not None for bolt in rom.bolts.values())
    for check in expected:
        solved = found[check.part, check.quantity]
        assert (solved["scatter"], solved["outcome"]) == (check.scatter, check.outcome)
        assert solved["value"] == pytest.approx(check.value, rel=1e-8)  # of the initial forces
    assert {"MS_u", "MS_sep"} <= {quantity for _, quantity in found}


def test_histories_are_counted_where_load_cases_say_how_often_they_come(rom, tmp_path):
    path = tmp_path / "loads.toml"
    case = '[[load_case]]\nname = "NAME"\nkind = "static"\nrepetitions = 1e5\n'
    forces = 'forces = [{ boundary = "tip", component = "Fx", value = 90.0 }]\n'
    path.write_text((case + forces).replace("NAME", "often") + LOADS)
    thread = Thread(diameter=2.0, pitch=0.4, grade="8.8")
    options = SolveOptions(strengths=BoltStrengths(threads={"bolt": thread}))
    summary = solve_loads(rom, read_loads(path, rom), tmp_path / "out", options)
    found = {check["quantity"]: check for check in summary["verdict"]["parts"][0]["checks"]}
    counted = found["fatigue, Miner's sum"]
    assert counted["case"] == "often"
    assert counted["value"] > 0
    load = fy.Load({"tip.Fx": 90.0}, name="often")
    amplitude = fy.assess(rom, [load], threads={"bolt": thread}, paths=False)
    (once,) = (check for check in amplitude.checks if check.quantity == "fatigue")
    # One cycle each time, N = N_D (σ_ASV/σ_a)³
    assert counted["value"] == pytest.approx(1e5 / 2e6 * (once.value / once.limit) ** 3, rel=1e-8)


def test_a_requirement_that_cannot_be_judged_is_not_met(model_file, tmp_path):
    loads = tmp_path / "loads.toml"
    loads.write_text(LOADS + "[requirement]\nmin_slip_safety = 1.5\n")
    done = CliRunner().invoke(
        app, ["solve", str(model_file), str(loads), "--out", str(tmp_path / "out")]
    )
    assert done.exit_code == 3
    assert "the coefficient to the interface or as slip_friction" in " ".join(done.output.split())


def test_an_open_interface_needs_infinite_friction(model_file, tmp_path):
    """The tip lifted and turned so that nothing touches, and a pull across."""
    loads = tmp_path / "loads.toml"
    forces = {"Fz": 200e3, "My": 11e6, "Fx": 5.0}
    entries = ", ".join(
        f'{{ boundary = "tip", component = "{name}", value = {value} }}'
        for name, value in forces.items()
    )
    case = f'[[load_case]]\nname = "open"\nkind = "static"\nforces = [{entries}]\n'
    loads.write_text(f"{case}[requirement]\n{SLIP}")
    out = str(tmp_path / "out")
    done = CliRunner().invoke(app, ["solve", str(model_file), str(loads), "--out", out])
    assert done.exit_code == 3, done.output
    assert re.search(r"needed_friction.joint +infinite +open", done.output)


def test_histories_are_judged_too(model_file, tmp_path):
    loads = tmp_path / "loads.toml"
    jump = LOADS.partition('[[load_case]]\nname = "jump"')
    loads.write_text(
        jump[1]
        + jump[2]
        + REQUIRED.replace("LIMIT", "1.0").replace("min_opening_factor = 1.0\n", "")
    )
    rom = fy.read_reduced_model(model_file)
    read = read_loads(loads, rom)
    options = SolveOptions(requirements=requirements_of(read.requirement))
    summary = solve_loads(rom, read, tmp_path / "out", options)
    clamp = summary["assessment"]["verdicts"][0]
    worst = summary["transients"]["jump"]["worst"]["clamp_force.joint"][0]
    # One sum over pressures, the other over forces: round-off.
    assert clamp["value"] == pytest.approx(worst["value"], rel=1e-12)
    assert clamp["case"] == f"jump at {worst['case']}"


BOLTS = "".join(
    f"""
[[bolt]]
name = "bolt-{number}"
preload = 3e3
size = "M5"
grade = "8.8"
thread_friction = 0.12
tightening_factor = 1.4
"""
    for number in (1, 2)
)

TWO_BOLTS = f"""
title = "Two bolts"
preload_scatter = {{ samples = 1, temperatures = ["hot"] }}

[model]
source = "lap-joint"
lap_joint = {{ element_size = 5.0, hole_radius = 0.0, bolt_positions = [[-10, 0], [10, 0]] }}

[material.steel]
alpha = 1.2e-5

[temperature.hot]
reference = 20.0
parts = {{ lower = 60.0 }}
{BOLTS}
[requirement]
min_clamp_force = 2e3
slip_friction = 0.15

[reduction]
methods = ["compliance"]

[output]
report = false

[[load_case]]
name = "bend"
kind = "static"
forces = [{{ boundary = "tip", component = "Fz", value = -150.0 }}]

[[load_case]]
name = "pull"
kind = "static"
repetitions = 1e6
forces = [{{ boundary = "tip", component = "Fx", value = 400.0 }}]

[[load_case]]
name = "turn"
kind = "static"
forces = [
    {{ boundary = "tip", component = "Mx", value = 5e3 }},
    {{ boundary = "tip", component = "Fy", value = 30.0 }},
]
"""


@pytest.mark.long
def test_many_loads_have_the_verdict_of_a_run(tmp_path):
    """At both ends of the scatter, at a temperature and counted, from TOML and from a table."""
    study, model = tmp_path / "two.toml", str(tmp_path / "two.faying")
    study.write_text(TWO_BOLTS)
    expected = run(read_study(study), tmp_path / "run")["verdict"]
    runner = CliRunner()
    done = runner.invoke(app, ["reduce", str(study), "--out", model])
    assert done.exit_code == 0, done.output
    table = tmp_path / "loads.csv"
    table.write_text(
        "case,tip.Fz,tip.Fx,tip.Mx,tip.Fy,repetitions\n"
        "bend,-150,0,0,0,0\npull,0,400,0,0,1e6\nturn,0,0,5e3,30,0\n"
    )
    for loads in (study, table):
        out = tmp_path / loads.stem
        runner.invoke(app, ["solve", model, str(loads), "--out", str(out)])
        found = json.loads((out / "summary.json").read_text())["verdict"]
        assert found["table"] == expected["table"]
        assert found["open_questions"] == expected["open_questions"]
    checks = [check for part in expected["parts"] for check in part["checks"]]
    assert {"P_p,min", "P_p,max"} <= {check["scatter"].split(", ")[0] for check in checks}
    assert any("hot" in check["scatter"] for check in checks)


@pytest.mark.long
def test_cases_that_decide_have_the_verdict_of_all(tmp_path, monkeypatch):
    """Many loads of any direction, at both ends of the scatter, with openings and margins."""
    study, model = tmp_path / "two.toml", tmp_path / "two.faying"
    margins = '[requirement.margins]\nstandard = "nasa-std-5020b"\nFS_u = 1.4\nFS_sep = 1.2\n'
    demanded = f"min_opening_factor = 1.2\n\n{margins}\n[reduction]"
    study.write_text(TWO_BOLTS.replace("[reduction]", demanded))
    runner = CliRunner()
    assert runner.invoke(app, ["reduce", str(study), "--out", str(model)]).exit_code == 0
    rows = np.random.default_rng(5).normal(size=(24, 4)) * (80.0, 300.0, 4e3, 60.0)
    lines = (f"c{number}," + ",".join(map(repr, row)) for number, row in enumerate(rows.tolist()))
    loads = tmp_path / "loads.csv"
    loads.write_text("case,tip.Fz,tip.Fx,tip.Mx,tip.Fy\n" + "\n".join(lines))

    def solved(*options: str):
        out = tmp_path / f"out{len(options)}"
        runner.invoke(app, ["solve", str(model), str(loads), "--out", str(out), *options])
        return json.loads((out / "summary.json").read_text())["verdict"]

    found = solved()
    followed = []
    monkeypatch.setattr(
        deciding_cases,
        "least_factor",
        lambda factors, exact, *_: followed.append(
            [exact(row) for row in np.flatnonzero(~np.isnan(factors)).tolist()]
        ),
    )
    every = solved("--worst", str(len(rows)))
    # Without friction no case slides.
    assert {len(factors) for factors in followed} == {0, len(rows)}
    assert found["table"] == every["table"]
    assert found["open_questions"] == every["open_questions"]
    checks = [check for part in every["parts"] for check in part["checks"]]
    assert {"opening", "MS_u", "MS_sep"} <= {check["quantity"].split(" at ")[0] for check in checks}
    assert len({check["case"] for check in checks}) > 5
