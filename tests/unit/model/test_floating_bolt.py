"""Bolts of solids that contact alone holds: the study that begins with weak springs."""

import tomllib

import numpy as np
import pytest

import faying as fy
from clamped_plates import abaqus_deck
from faying.draft.first_study import first_study
from faying.exceptions import ModelError
from faying.io.abaqus import read_joint
from faying.model.supports import nodes_of_set
from faying.study.inputs.load_model import build, load_model
from faying.study.keys.schema import parse_study


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "plates.inp"
    path.write_text(abaqus_deck())
    return path


def test_supports_take_names_of_bodies(deck):
    assembly = read_joint(deck).assembly
    labels = assembly.mesh.bodies
    np.testing.assert_array_equal(nodes_of_set(assembly, "body 1"), np.flatnonzero(labels == 1))
    with pytest.raises(ModelError, match=r"no node set 'body 9', nor another set or body"):
        nodes_of_set(assembly, "body 9")


@pytest.mark.long
def test_a_floating_bolt_clamps_as_if_it_were_held(deck):
    """Its springs take as good as nothing of the preload, and of a load less if they are softer."""
    study = first_study(deck, deck.with_suffix(".toml"))
    assert study.problem == ""
    tables = tomllib.loads(study.text)
    assert tables["model"]["weak_springs"] == "auto"
    assert tables["load_case"][0]["forces"] == [{"deck_load": "step 2", "value": 1.0}]
    forces = []
    for stiffness in ('"auto"', "0.006"):
        text = study.text.replace('weak_springs = "auto"', f"weak_springs = {stiffness}")
        parsed = parse_study(text, deck.with_suffix(".toml"))
        model = fy.preload(build(parsed), load_model(parsed).preloads)
        assert len(model.weak_supports) == 2  # under head and nut
        tightened = fy.solve_static(model, fy.Load({"step 2": 0.0}))
        bent = fy.solve_static(model, fy.Load({"step 2": 1.0}))
        forces.append([one.contact_force(name) for one in (tightened, bent) for name in NAMES])
        # Under head and nut; the springs, of 50 N/mm, stretch by 1e-5 mm.
        np.testing.assert_allclose(forces[-1][1:3], 5000.0, rtol=1e-6)
    np.testing.assert_allclose(*forces, rtol=1e-6)


NAMES = [f"IntProp-1 {pair}" for pair in ("Under Over", "Seat Head", "Bottom Nut")]


def test_sets_of_one_node_are_no_faces_to_load(deck):
    """The pretension node is called a load, and no face follows it."""
    text = abaqus_deck().split("*Step, name=Step-2")[0]
    deck.write_text(text)
    study = first_study(deck, deck.with_suffix(".toml"))
    assert study.problem == ""
    assert "_Bolt load" not in str(tomllib.loads(study.text).get("boundary"))
