"""Masses that a study adds: of sensors at nodes and sets, of heads and nuts of generated bolts."""

import pytest

from faying.exceptions import StudyError
from faying.model.matrices import mass_properties
from faying.study.inputs.load_model import build
from faying.study.keys.schema import parse_study
from small_study import TINY_JOINT, static

SECOND = """
[[bolt]]
name = "second"
axis = [[10.0, 0.0, -10.0], [10.0, 0.0, 10.0]]
diameter = 6.0
washer_radius = 11.0
preload = 1e3
MASS_OF_BOLT
"""
STUDY = TINY_JOINT + SECOND + static("pull", "Fx", 1.0)


def mass_of(tmp_path, more: str, bolt: str = "") -> float:
    text = STUDY.replace("MASS_OF_BOLT", bolt) + more
    model = build(parse_study(text, tmp_path / "study.toml"))
    return mass_properties(model.assembly).mass


def test_masses_of_nodes_and_sets_count_once(tmp_path):
    bare = mass_of(tmp_path, "")
    at_node = '[[mass]]\nname = "sensor"\nnode = 20\nmass = 2e-5\n'
    on_set = '[[mass]]\nset = "upper"\nmass = 1e-5\n'
    assert mass_of(tmp_path, at_node + on_set) - bare == pytest.approx(3e-5, rel=1e-9)


def test_heads_and_nuts_of_generated_bolts(tmp_path):
    bare = mass_of(tmp_path, "")
    heavier = mass_of(tmp_path, "", "end_masses = [5e-6, 7e-6]")
    assert heavier - bare == pytest.approx(12e-6, rel=1e-9)


@pytest.mark.parametrize(
    ("table", "match"),
    [
        ("[[mass]]\nmass = 1.0\n", "give exactly one of 'set', 'node'"),
        ("[[mass]]\nnode = 99999\nmass = 1.0\n", "mass.*99999"),
        ('[[mass]]\nset = "uper"\nmass = 1.0\n', "uper"),
        ("[[mass]]\nnode = 1\nmass = 0.0\n", "mass"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, table, match):
    with pytest.raises(StudyError, match=match):
        mass_of(tmp_path, table)


def test_only_generated_bolts_take_masses_of_their_ends(tmp_path):
    text = STUDY.replace('name = "bolt"\n', 'name = "bolt"\nend_masses = [1e-6, 1e-6]\n')
    with pytest.raises(StudyError, match=r"end_masses.*only a bolt given by its axis"):
        parse_study(text.replace("MASS_OF_BOLT", ""), tmp_path / "study.toml")
