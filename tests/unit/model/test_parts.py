"""parts and without: some bodies of a deck, with what holds to them and nothing else."""

import numpy as np
import pytest

from faying.exceptions import ModelError, StudyError
from faying.io.abaqus import read_joint
from faying.joint.build import build_model
from faying.model.parts import part_of
from faying.study.inputs.load_model import load_model
from faying.study.keys.schema import read_study
from small_abaqus_deck import DECK

# Two more bricks beside those of the deck, bonded by a rigid coupling to nothing of them.
MORE = """\
*NODE, NSET=NALL
21, 10., 0., 0.
22, 12., 0., 0.
23, 12., 3., 0.
24, 10., 3., 0.
25, 10., 0., 1.
26, 12., 0., 1.
27, 12., 3., 1.
28, 10., 3., 1.
35, 10., 0., 2.
36, 12., 0., 2.
37, 12., 3., 2.
38, 10., 3., 2.
200, 11., 1., 4.
*ELEMENT, TYPE=C3D8, ELSET=FAR
21, 21, 22, 23, 24, 25, 26, 27, 28
*ELEMENT, TYPE=C3D8, ELSET=FARTHER
22, 25, 26, 27, 28, 35, 36, 37, 38
*ELEMENT, TYPE=SPRING2, ELSET=FARSTICK
23, 21, 22
*SPRING, ELSET=FARSTICK
1, 1
5.
*ELEMENT, TYPE=SPRING2, ELSET=BRIDGE
24, 17, 21
*SPRING, ELSET=BRIDGE
1, 1
5.
*ELSET, ELSET=ISLAND
FAR, FARTHER
*NSET, NSET=ISLANDS
35, 36, 37, 38
*SOLID SECTION, ELSET=ISLAND, MATERIAL=STEEL
*SURFACE, NAME=FARTOP
FARTHER, S2
*RIGID BODY, NSET=ISLANDS, REF NODE=200
*BOUNDARY
21, 1, 3
"""
WHOLE = DECK.replace("*STEP\n", MORE + "*STEP\n", 1).replace(
    "*CLOAD\n", "*CLOAD\n200, 3, 5.\n21, 3, 1.\n", 1
)
CUT = WHOLE.replace(
    "*ELEMENT, TYPE=SPRING2, ELSET=BRIDGE\n24, 17, 21\n*SPRING, ELSET=BRIDGE\n1, 1\n5.\n", ""
)


@pytest.fixture
def read(tmp_path):
    def reader(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_joint(tmp_path / "deck.inp")

    return reader


def note(joint):
    (found,) = [text for text in joint.assembly.ignored if text.startswith("left out by parts")]
    return found


@pytest.mark.parametrize(
    ("parts", "without"),
    [
        (["BRICKS"], []),
        (["LOWER", "UPPER"], []),
        ([], ["ISLAND"]),
        ([], ["FAR", "FARTHER"]),
        ([], [2]),  # the second section
        ([1], []),
        (["BRICKS", "FAR"], ["FAR", "FARTHER"]),
    ],
)
def test_what_remains_is_the_deck_without_the_rest(read, parts, without):
    small, joint = read(DECK), part_of(read(CUT), parts, without)
    assembly = joint.assembly
    assert assembly.mesh.element_ids.tolist() == small.assembly.mesh.element_ids.tolist()
    for name in ("springs", "masses", "beams", "equations", "average_couplings"):
        assert len(getattr(assembly, name)) == len(getattr(small.assembly, name)), name
    assert len(assembly.rigid_couplings) == len(small.assembly.rigid_couplings)
    assert joint.interfaces == small.interfaces
    assert joint.bolts == small.bolts
    assert joint.preloads == small.preloads
    built = [
        build_model(d.assembly, interfaces=d.interfaces, bolts=d.bolts) for d in (small, joint)
    ]
    # The same sums in the same order, but for rows of nodes that nothing touches.
    np.testing.assert_allclose(built[1].K.toarray(), built[0].K.toarray(), rtol=1e-14)
    ours, theirs = assembly.loads["step 1"], small.assembly.loads["step 1"]
    np.testing.assert_array_equal(
        assembly.mesh.node_ids[ours.nodes], small.assembly.mesh.node_ids[theirs.nodes]
    )
    np.testing.assert_array_equal(ours.forces, theirs.forces)
    said = note(joint)
    for text in ("2 of 4 solids", "1 x spring", "1 x rigid coupling", "load 'step 1' on"):
        assert text in said
    assert "ISLANDS" not in assembly.mesh.node_sets
    assert "FARTOP" not in assembly.face_sets


def test_contact_and_bolts_go_with_their_bodies(read):
    joint = part_of(read(CUT), [], ["LOWER", "UPPER", "BOLT", "STICK"])
    assert joint.interfaces == ()
    assert joint.bolts == ()
    assert joint.preloads == {}
    said = note(joint)
    (interface,), (bolt,) = read(CUT).interfaces, read(CUT).bolts
    for text in ("2 of 4 solids", f"interface '{interface.name}'", f"bolt '{bolt.name}'"):
        assert text in said


def test_bodies_without_a_set_have_the_names_of_check(read):
    text = CUT.replace("ELSET=ISLAND\nFAR, FARTHER", "ELSET=ISLAND\nFAR")
    text = text.replace(
        "*SOLID SECTION, ELSET=ISLAND, MATERIAL=STEEL",
        "*SOLID SECTION, ELSET=FAR, MATERIAL=STEEL\n*SOLID SECTION, ELSET=FARTHER, MATERIAL=STEEL",
    )
    joint = part_of(read(text), [], ["body 2"])
    assert joint.assembly.mesh.element_ids.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("parts", "without", "message"),
    [
        (
            ["NOWHERE"],
            [],
            r"no body or element set 'NOWHERE' to choose; known are 'LOWER', 'UPPER'",
        ),
        ([], [77], "no element has property 77"),
        ([], ["BRICKS", "ISLAND"], "no solid remains"),
        (["BRICKS"], [], r"spring 24: these hold together what remains and what parts and without"),
        ([], ["LOWER"], "hold together"),
    ],
)
def test_what_cannot_be_cut(read, parts, without, message):
    with pytest.raises(ModelError, match=message):
        part_of(read(WHOLE), parts, without)


def test_the_whole_stays_as_it_is(read):
    joint = read(CUT)
    assert part_of(joint, [], []) is joint


def test_a_link_that_is_left_out_too_is_no_tie(read):
    joint = part_of(read(WHOLE), [], ["ISLAND", "BRIDGE"])
    assert [spring.id for spring in joint.assembly.springs] == [4]


def test_part_of_a_body_is_cut_at_its_nodes(read):
    joint = part_of(read(CUT), [], ["FARTHER"])
    assert joint.assembly.mesh.element_ids.tolist() == [1, 2, 21]
    left = joint.assembly.mesh.node_ids[joint.assembly.mesh.element_nodes(np.array([21]))]
    assert left.tolist() == [*range(21, 29)]
    assert "cut through solids at 4 nodes" in note(joint)


STUDY = """\
[model]
source = "abaqus"
file = "deck.inp"
{}
"""


def test_studies_choose_parts(read, tmp_path):
    read(CUT)
    path = tmp_path / "a.toml"
    path.write_text(STUDY.format('parts = ["LOWER", "UPPER"]'))
    assert load_model(read_study(path)).assembly.mesh.n_elements == 2
    path.write_text(STUDY.format("without = [2]"))
    assert load_model(read_study(path)).assembly.mesh.n_elements == 2
    path.write_text(STUDY.format('without = ["NONE"]'))
    with pytest.raises(ModelError, match="no body or element set 'NONE'"):
        load_model(read_study(path))
    path.write_text('[model]\nsource = "lap-joint"\nparts = ["plate"]\n')
    with pytest.raises(StudyError, match="'lap-joint' has no parts to choose from"):
        load_model(read_study(path))
