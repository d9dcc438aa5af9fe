"""Study files with extreme values, or with bytes changed, are read or refused in one message."""

import re
from pathlib import Path

import pytest
from damage import damaged
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FayingError
from faying.study.inputs.load_model import build_loaded, load_model
from faying.study.keys.schema import parse_study, read_study

STUDY = """title = "block"
units = "mm-t-s"
[model]
source = "lap-joint"
[model.lap_joint]
element_size = 10.0
length = 110.0
width = 20.0
thickness = 10.0
overlap = 40.0
curvature = 0.0
hole_radius = 4.2
bolt_positions = [[0.0, 0.0]]
bolt_diameter = 6.0
washer_radius = 10.0
[material.steel]
E = 210000.0
nu = 0.3
rho = 7.8e-9
[[interface]]
name = "joint"
minus = "lower"
plus = "upper"
penalty = 1e5
tolerance = 0.1
initial_gap = 0.0
[[bolt]]
name = "bolt"
preload = 10e3
[[boundary]]
name = "tip"
[sticking]
threshold = 0.5
stiffness = 1e5
[damping]
alpha = 160.0
beta = 5e-7
[reduction]
normal_modes = 3
joint_modes = [2, 4]
tolerance = 0.05
methods = ["compliance", "jim-b"]
[reduction.training]
box = [{ boundary = "tip", component = "Fz", min = -500.0, max = 500.0 }]
levels = 3
preload_factors = [0.5, 1.0]
periods = 0.2
steps_per_period = 50
subareas = 3
[[load_case]]
name = "step"
kind = "step"
duration = 1e-4
step = 1e-5
integrator = "generalized-alpha"
rho_infinity = 0.8
forces = [{ boundary = "tip", component = "Fz", value = -500.0 }]
[validation]
unseen_loads = 3
[output]
times = [5e-5]
"""
VALUE = re.compile(r'"[^"]*"|(?<=[=\[, ])-?\d[\d.e+-]*')
PLACES = [match.span() for match in VALUE.finditer(STUDY)]
VALUES = [
    *["1e308", "-1e308", "1e-320", "1e300", "0", "-1.0", "1e25", "nan", "inf", "9" * 20],
    *["1" + "0" * 400, "9" * 5000, "[" * 2000 + "]" * 2000, "[]", "{}", "true", "1979-05-27"],
    *['""', '"a\\u0000b"', '"\\u001b[2J"', '"/../../x"', '"[/bold]"', f'"{"x" * 400}"'],
]
HERE = Path("study.toml")


@settings(max_examples=150)
@given(place=st.sampled_from(PLACES), value=st.sampled_from(VALUES))
def test_extreme_values(place, value):
    """What is read makes a model, or does not, but neither ends in another error."""
    text = STUDY[: place[0]] + value + STUDY[place[1] :]
    said = said_of(lambda: build_loaded(load_model(parse_study(text, HERE))))
    assert "Traceback" not in said


@pytest.mark.long
@settings(max_examples=150)
@given(content=damaged(STUDY.encode(), text=True))
def test_damaged_bytes(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "damaged.toml"
    path.write_bytes(content)
    assert "Traceback" not in said_of(lambda: read_study(path))


def said_of(read):
    """The lines of what is said of a study, as one; none if it is read."""
    try:
        read()
    except FayingError as error:
        return " ".join(str(error).splitlines())
    return ""
