"""Bodies that contact alone holds: soft springs, and the study that begins with them."""

import tomllib

import numpy as np
import pytest

import faying as fy
from clamped_plates import abaqus_deck
from faying.draft.first_study import first_study
from faying.exceptions import ModelError
from faying.io.abaqus import read_joint
from faying.model.matrices import assemble_matrices
from faying.model.supports import nodes_of_set, with_soft_springs
from faying.study.load_model import build, load_model
from faying.study.schema import parse_study


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "plates.inp"
    path.write_text(abaqus_deck())
    return path


def test_springs_have_the_stiffness_in_all_and_hold_every_motion(deck):
    assembly = read_joint(deck).assembly
    nodes = nodes_of_set(assembly, "body 1")
    soft = with_soft_springs(assembly, nodes, (0, 1, 2), 10.0)
    added = assemble_matrices(soft).K - assemble_matrices(assembly).K
    n_node = len(assembly.mesh.nodes)
    shift = np.zeros((n_node, 6))
    shift[nodes, 2] = 1.0
    # Forces of the whole K are 1e6, of which sixteen digits are kept.
    assert shift.ravel() @ added @ shift.ravel() == pytest.approx(10.0, rel=1e-9)
    places = [spring.ends[0][0] for spring in soft.springs[len(assembly.springs) :]]
    assert len(places) == 3 * 8
    centred = assembly.mesh.nodes[places] - assembly.mesh.nodes[places].mean(axis=0)
    assert np.linalg.matrix_rank(centred) == 3
    with pytest.raises(ModelError, match=r"no node set 'body 9', nor another set or body"):
        nodes_of_set(assembly, "body 9")


def test_a_floating_bolt_clamps_as_if_it_were_held(deck):
    """Its springs take as good as nothing of the preload, and of a load less if they are softer."""
    study = first_study(deck, deck.with_suffix(".toml"))
    assert study.problem == ""
    tables = tomllib.loads(study.text)
    assert [table["set"] for table in tables["support"]] == ["body 0", "body 1"]
    # A millionth of 210 GPa times the 36 mm (rounded) that head and shank are wide or high.
    # A millionth of 210 GPa times the 30 mm that head and nut are wide, of one digit.
    assert tables["support"][0]["stiffness"] == 6.0
    assert tables["load_case"][0]["forces"] == [{"deck_load": "step 2", "value": 1.0}]
    forces = []
    for text in (study.text, study.text.replace("stiffness = 6.0", "stiffness = 0.006")):
        parsed = parse_study(text, deck.with_suffix(".toml"))
        model = fy.preload(build(parsed), load_model(parsed).preloads)
        tightened = fy.solve_static(model, fy.Load({"step 2": 0.0}))
        bent = fy.solve_static(model, fy.Load({"step 2": 1.0}))
        forces.append([one.contact_force(name) for one in (tightened, bent) for name in NAMES])
        # Under head and nut; springs of 6 N/mm move by 1e-3 mm at most while 5000 N clamp.
        np.testing.assert_allclose(forces[-1][1:3], 5000.0, rtol=1e-6)
    # What 1000 times softer springs change: their share of the load, some 1e-4 of 200 N.
    np.testing.assert_allclose(*forces, rtol=1e-5)


NAMES = [f"IntProp-1 {pair}" for pair in ("Under Over", "Seat Head", "Bottom Nut")]


def test_sets_of_one_node_are_no_faces_to_load(deck):
    """The pretension node is called a load, and no face follows it."""
    text = abaqus_deck().split("*Step, name=Step-2")[0]
    deck.write_text(text)
    study = first_study(deck, deck.with_suffix(".toml"))
    assert study.problem == ""
    assert "_Bolt load" not in str(tomllib.loads(study.text).get("boundary"))
