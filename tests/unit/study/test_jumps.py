"""Loads that jump: found whatever they are written as, named, and left alone where they rise."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from faying.cli import app
from faying.exceptions import StudyError
from faying.study.inputs.jumps import load_jumps
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import parse_study
from faying.study.results.store import read_results
from small_study import NO_REPORT, SMALL_JOINT, UNCHECKED, reduction

PERIOD = 1.0
STUDY = SMALL_JOINT + reduction("compliance") + UNCHECKED + 'reference = "none"\n' + NO_REPORT


def case(folder, forces, keys):
    table = f"[[load_case]]\nname = 'one'\nforces = [{forces}]\n{keys}"
    (found,) = parse_study(STUDY + table, folder / "joint.toml").load_cases
    return found


def tip(value="", file=""):
    amount = f"file = '{file}'" if file else f"value = {value}"
    return f"{{ boundary = 'tip', component = 'Fz', {amount} }}"


def history(folder, rows):
    lines = (f"{time:.17g}, {value:.17g}" for time, value in rows)
    (folder / "load.csv").write_text("\n".join(lines))
    return case(folder, tip(file="load.csv"), "kind = 'history'\nstep = 0.002\nduration = 2.0")


STEP = "kind = 'step'\nstep = 0.002\nduration = 2.0"


def test_a_constant_load_jumps(tmp_path):
    (jump,) = load_jumps(case(tmp_path, tip(-500.0), STEP), step=0.002, period=PERIOD)
    assert (jump.load, jump.time, jump.change, jump.share) == ("tip.Fz", 0.0, -500.0, 1.0)
    assert jump.window == 0.0
    assert jump.rise == 0.25
    (jump,) = load_jumps(case(tmp_path, tip(-500.0), STEP))
    assert jump.rise is None


def test_static_loads_and_zero_do_not(tmp_path):
    assert load_jumps(case(tmp_path, tip(-500.0), "kind = 'static'"), step=1.0, period=1.0) == []
    assert load_jumps(case(tmp_path, tip(0.0), STEP), step=0.002, period=1.0) == []


@pytest.mark.parametrize(
    ("rows", "time", "change"),
    [
        ([(0.0, 3.0), (1.0, 3.0)], 0.0, 3.0),  # begins at once
        ([(0.5, 3.0), (1.0, 3.0)], 0.0, 3.0),  # constant before its first sample
        ([(0.0, 0.0), (0.4, 0.0), (0.401, 4.0), (2.0, 4.0)], 0.4, 4.0),
        ([(0.0, 0.0), (0.4, 4.0), (0.405, -4.0), (2.0, 0.0)], 0.4, -8.0),
        ([(0.0, 0.0), (0.4, 0.0), (0.4001, 4.0), (0.4002, 0.0), (2.0, 0.0)], 0.4, 4.0),  # a spike
    ],
)
def test_histories(tmp_path, rows, time, change):
    (jump,) = load_jumps(history(tmp_path, rows), step=0.002, period=PERIOD)
    assert jump.time == pytest.approx(time, abs=0.01)  # the window, a hundredth of the period
    # A part of the window may lie beside the jump, where these loads change by 0.3 % a window.
    assert abs(jump.change) == pytest.approx(abs(change), rel=0.01)


def test_a_large_step_makes_a_jump_of_a_rise(tmp_path):
    rising = history(tmp_path, [(0.0, 0.0), (0.1, 4.0), (2.0, 4.0)])
    assert load_jumps(rising, step=0.002, period=PERIOD) == []
    (jump,) = load_jumps(rising, step=0.1, period=PERIOD)
    assert jump.window == 0.1


def test_rise_time_is_half_a_cosine(tmp_path):
    rising = case(tmp_path, tip(-500.0), f"{STEP}\nrise_time = 0.25")
    assert load_jumps(rising, step=0.002, period=PERIOD) == []
    times = np.linspace(0.0, 0.5, 101)
    wanted = -250.0 * (1.0 - np.cos(np.pi * np.minimum(times / 0.25, 1.0)))
    value = case_load(rising).forces["tip.Fz"].at(times)
    # Linear between 200 samples: (π/200)²/8 of half the load.
    np.testing.assert_allclose(value, wanted, atol=500.0 * 2e-5)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("kind = 'static'\nrise_time = 0.1", 'only kind = "step" has it'),
        (f"{STEP}\nrise_time = 3.0", "longer than the duration 2"),
        (f"{STEP}\nrise_time = 0", "rise_time"),
    ],
)
def test_rise_times_that_fit_nothing(tmp_path, keys, said):
    with pytest.raises(StudyError, match=said):
        case(tmp_path, tip(-500.0), keys)


@pytest.mark.long
def test_check_and_run_name_jumps(tmp_path):
    times = "periods = 0.25\nsteps_per_period = 40"
    table = f"[[load_case]]\nname = 'NAME'\nkind = 'step'\nforces = [{tip(-150.0)}]\n{times}\n"
    text = STUDY + table.replace("NAME", "hit") + table.replace("NAME", "push")
    path = tmp_path / "joint.toml"
    path.write_text(f"{text}rise_time = 5e-4\n")
    said = " ".join(CliRunner().invoke(app, ["check", str(path)]).output.split())
    assert "Doubtful: hit: tip.Fz (by -150 at t = 0 s) jumps. Real loads rise" in said
    assert "push: tip.Fz (by" not in said
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["run", str(path), "--out", str(out)])
    assert result.exit_code == 0
    (jump,) = json.loads((out / "summary.json").read_text())["load_cases"]["hit"]["jumps"]
    said = " ".join(result.output.split())
    assert "Doubtful: hit: tip.Fz (by -150 at t = 0 s) jumps." in said
    assert f"longest period, {jump['rise']:.3g} s, with" in said
    assert f"with rise_time = {jump['rise']:.3g} in its [[load_case]]" in said
    kept = read_results(out / "results.h5").cases
    assert [one.load for one in kept["hit"].jumps] == ["tip.Fz"]
    assert kept["push"].jumps == ()
    assert "hit, errors estimated without a full solution: compliance" in said
