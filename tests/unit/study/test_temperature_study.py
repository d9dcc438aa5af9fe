"""Temperatures in a study: from the file to the load and to messages."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.preload_ends import preload_ends
from faying.exceptions import FayingError
from faying.study.inputs.load_model import build
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import read_study
from lap_joints import tiny_lap

STUDY = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0 }

[material.steel]
alpha = 12e-6

[temperature.hot]
reference = 20.0
parts = { upper = 120.0, bolt = 70.0 }

[[bolt]]
name = "bolt"
preload = 8e3

[[load_case]]
name = "running"
kind = "static"
forces = [
  { boundary = "tip", component = "Fz", value = -100.0 },
  { temperature = "hot", value = 0.5 },
]
"""


@pytest.fixture
def study(tmp_path):
    def read(text=STUDY):
        (tmp_path / "joint.toml").write_text(text)
        return read_study(tmp_path / "joint.toml")

    return read


def test_a_study_takes_a_temperature_as_python_does(study):
    read = study()
    model, load = build(read), case_load(read.load_cases[0])
    assert dict(load.forces) == {"tip.Fz": -100.0, "hot": 0.5}
    steel = model.assembly.materials[1]
    assert steel.expansion == 12e-6
    again = fy.with_temperature(
        tiny_lap(material=steel),
        "hot",
        fy.Temperature(reference=20.0, parts={"upper": 120.0, "bolt": 70.0}),
    )
    np.testing.assert_array_equal(model.pattern_forces, again.pattern_forces)
    assert model.load_patterns["hot"].bolt_forces == again.load_patterns["hot"].bolt_forces


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'temperature = "hot", value',
            'temperature = "hat", value',
            r"line 22.*no \[temperature.hat",
        ),
        (", bolt = 70.0", ", nut = 70.0", "temperature 'hot'.*no body or element set 'nut'"),
        ("alpha = 12e-6", "rho = 7.8e-9", "'steel' has no coefficient of expansion"),
        ('{ temperature = "hot", value = 0.5 },', "", "no load uses it"),
        ("parts = { upper = 120.0, bolt = 70.0 }", "", "nothing has a temperature"),
        ('{ temperature = "hot"', '{ boundary = "tip", temperature = "hot"', "each give the load"),
    ],
)
def test_what_does_not_fit_is_said(study, old, new, message):
    assert old in STUDY
    with pytest.raises(FayingError, match=message):
        build(study(STUDY.replace(old, new)))


def test_scattered_temperatures_are_named_and_taken_beside_every_load(study):
    scatter = 'preload_scatter = { temperatures = ["hot"] }\n'
    read = study(scatter + STUDY)
    model = build(read)
    model = fy.preload(model, {"bolt": 5e3})
    load, hot = fy.Load({"tip.Fz": -100.0}), fy.Load({"hot": 1.0})
    rest, pulled = (
        CaseState(
            pressure=one.pressure[None], bolt_forces={"bolt": np.ravel(one.bolt_force("bolt"))}
        )
        for one in (fy.solve_static(model), fy.solve_static(model, load))
    )
    cases, temperatures = {"pull": pulled}, {"hot": hot}
    ends = preload_ends(model, rest, cases, {"pull": load}, {}, temperatures=temperatures)
    both = fy.solve_static(model, fy.Load({"tip.Fz": -100.0, "hot": 1.0})).pressure
    assert [end.name for end in ends] == ["", "hot"]
    for end, expected in zip(ends, (pulled.pressure[0], both), strict=True):
        # The same contact problem from another initial force, which is found within 1e-10
        found = end.cases["pull"].pressure[0]
        np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7)
    with pytest.raises(FayingError, match=r"no \[temperature.cold\]"):
        study(scatter.replace("hot", "cold") + STUDY)
