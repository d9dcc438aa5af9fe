"""A study of an input deck repeats neither its contact pairs nor its bolts."""

import pytest

from faying.exceptions import FormatError
from faying.study.inputs.load_model import build, load_model
from faying.study.keys.schema import read_study
from small_abaqus_deck import DECK

STUDY = """\
title = "deck"
units = "mm-t-s"

[model]
source = "abaqus"
file = "deck.inp"
STEP

[[boundary]]
name = "tip"
node = 100
MORE

[reduction]
normal_modes = 2
methods = ["compliance"]

[[load_case]]
name = "push"
kind = "static"
forces = [{ boundary = "tip", component = "Fz", value = -7.0 }]
"""


@pytest.fixture
def study(tmp_path):
    def reader(more="", step=""):
        (tmp_path / "deck.inp").write_text(DECK)
        path = tmp_path / "study.toml"
        path.write_text(STUDY.replace("MORE", more).replace("STEP", step))
        return read_study(path)

    return reader


def test_interfaces_and_bolts_come_from_the_deck(study):
    loaded = load_model(study())
    assert [(i.name, i.minus, i.plus, i.penalty) for i in loaded.interfaces] == [
        ("Joint", "SLAVE", "MASTER", 1e6)
    ]
    assert loaded.preloads == {"bolt 3": 400.0}
    assert build(study()).interfaces["Joint"].penalty == 1e6


def test_the_study_overrides_by_name(study):
    more = '[[interface]]\nname = "Joint"\npenalty = 2e5\n[[bolt]]\nname = "bolt 3"\npreload = 90.0'
    loaded = load_model(study(more))
    (interface,) = loaded.interfaces
    assert (interface.minus, interface.penalty) == ("SLAVE", 2e5)
    assert loaded.preloads == {"bolt 3": 90.0}
    stiffness = build(study(more)).bolts["bolt 3"].stiffness
    # The study's force locks the bolt, which the deck's does not.
    assert build(study()).bolts["bolt 3"].stiffness == pytest.approx(1e-6 * stiffness)


def test_an_unknown_step_is_refused(study):
    assert load_model(study(step="subcase = 1")).preloads == {"bolt 3": 400.0}
    with pytest.raises(FormatError, match="there is no step 2"):
        load_model(study(step="subcase = 2"))
