"""Numbers and names of a study file that nothing can be computed with, each refused with why."""

import re
from pathlib import Path

import pytest

import faying as fy
from faying.exceptions import ModelError, StudyError
from faying.interface.gap_field import with_gap_offset
from faying.linalg.memory import NotEnoughMemoryError
from faying.study.keys.schema import parse_study

STUDY = """
[model]
source = "lap-joint"
[model.lap_joint]
element_size = 5.0
[damping]
alpha = 160.0
[reduction]
normal_modes = 3
[reduction.training]
box = [{ boundary = "tip", component = "Fz", min = -500.0, max = 500.0 }]
levels = 3
periods = 1.0
steps_per_period = 50
[[load_case]]
name = "step"
kind = "step"
duration = 1e-4
step = 1e-5
forces = [{ boundary = "tip", component = "Fz", value = -500.0 }]
"""


@pytest.mark.parametrize(
    ("key", "value", "parts"),
    [
        ("alpha", "1e308", ["'alpha' in [damping]", "(line 7)", "1e-30 to 1e+30", "double prec"]),
        ("alpha", "1e-320", ["1e-320", "1e-30 to 1e+30"]),
        ("alpha", "1" + "0" * 400, ["'alpha'", "expected a number"]),
        ("element_size", "1e-320", ["'element_size' in [model.lap_joint]", "1e-30 to 1e+30"]),
        ("element_size", '[[1e308, "x"]]', ["'element_size'", "1e-30 to 1e+30"]),
        ("levels", "1000000000000", ["'levels'", "at most 1000000", "in memory"]),
        ("levels", "400000", ["[reduction.training]", "1.2e+06 loads, expected at most 1000000"]),
        ("normal_modes", "9" * 30, ["'normal_modes'", "at most 1000000"]),
        ("steps_per_period", "1" + "0" * 400, ["'steps_per_period'", "at most 1000000"]),
        ("periods", "1e9", ["[reduction.training]", "5e+10 time steps", "at most 100000000"]),
        ("duration", "1e25", ["[[load_case]] number 1", "1e+30 time steps"]),
        ("name", '"a\\u0000b"', ["'a\\x00b'", "U+0000", "unprintable"]),
        ("name", '"a\\u001b[31mb"', ["U+001B", "unprintable"]),
        ("name", '"a\\u202eb"', ["U+202E", "unprintable"]),
        ("name", f'"{"x" * 201}"', ["found 201 characters", "at most 200"]),
    ],
)
def test_range(key, value, parts):
    text = re.sub(rf"(?m)^{key} = .*$", lambda _: f"{key} = {value}", STUDY)
    with pytest.raises(StudyError) as caught:
        parse_study(text, Path("s.toml"))
    assert all(part in str(caught.value) for part in parts), str(caught.value)
    assert str(caught.value).isprintable()


def test_combinations_of_loads():
    """Each side alone is harmless."""
    side = '{ boundary = "tip", component = "Fz", min = -500.0, max = 500.0 }'
    sides = [side.replace("Fz", name) for name in ("Fx", "Fy", "Fz", "Mx", "My", "Mz")]
    text = STUDY.replace(side, ", ".join(sides)).replace("levels = 3", "levels = 10")
    with pytest.raises(StudyError, match=r"of 6 sides are 3e.06 loads, expected at most 1000000"):
        parse_study(text, Path("s.toml"))


@pytest.mark.parametrize("value", ["9" * 5000, "[" * 3000 + "]" * 3000])
def test_what_the_parser_of_toml_cannot_hold(value):
    with pytest.raises(StudyError, match=r"s.toml cannot be read \("):
        parse_study(STUDY + f"[output]\ntimes = {value}\n", Path("s.toml"))


@pytest.mark.parametrize(
    "measures", [{"width": 1e308}, {"element_size": 1e-320}, {"length": 1e5}, {"thickness": 1e12}]
)
def test_lap_joint_of_more_bricks_than_can_be_solved(measures):
    with pytest.raises(ModelError, match=r"into \S+ bricks, and 500000 are the most"):
        fy.lap_joint(**measures)


def test_histories_are_refused_before_there_is_memory_for_them(joint, monkeypatch):
    load = fy.Load({"tip.Fz": -100.0})
    with pytest.raises(ModelError, match=r"1e\+12 steps of 1e-05, and 1000000000 are the most"):
        fy.solve_transient(joint, load, step=1e-5, duration=1e7)
    monkeypatch.setenv("FAYING_MEMORY", "16e9")
    with pytest.raises(NotEnoughMemoryError, match=r"1000001 instants .* GB, and 16 GB of memory"):
        fy.solve_transient(joint, load, step=1e-6, duration=1.0)


def test_static_cases_are_refused_before_there_is_memory_for_them(joint, monkeypatch):
    loads = [fy.Load({"tip.Fz": -100.0})] * 100
    monkeypatch.setenv("FAYING_MEMORY", "1e6")
    with pytest.raises(NotEnoughMemoryError, match="solutions of 100 load cases take"):
        fy.solve_static_cases(joint, loads)


def test_bolt_that_begins_far_from_contact():
    """Across a gap of a thousand kilometres no point is active, and nothing is solved for one."""
    model = fy.lap_joint(element_size=5.0)
    gap = {"joint": with_gap_offset(model.interfaces["joint"], 1e9)}
    preloaded = fy.preload(model.with_interfaces(gap), {"bolt": 10e3})
    # The initial force is 3e14, whose last digit is 0.06.
    assert fy.solve_static(preloaded).bolt_force("bolt") == pytest.approx(10e3, abs=1.0)
