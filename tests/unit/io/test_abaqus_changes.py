"""What the first step removes, what holds nodes in place, and other small print of decks."""

import numpy as np
import pytest

from faying.exceptions import FormatError, ModelError
from faying.io.abaqus import read_joint
from small_abaqus_deck import DECK


@pytest.fixture
def read(tmp_path):
    def reader(text, **chosen):
        (tmp_path / "deck.inp").write_text(text)
        return read_joint(tmp_path / "deck.inp", **chosen)

    return reader


def edited(*changes):
    text = DECK
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


GONE = (
    "*END STEP\n",
    "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nLOWER\n"
    "*DLOAD\nBRICKS, GRAV, 10., 0., 0., -1.\n*END STEP\n",
)


def test_elements_that_the_first_step_removes_are_not_there(read):
    """Nor their weight, nor the contact of a surface that has none left."""
    text = edited(GONE)
    joint = read(text)
    assert list(joint.assembly.mesh.element_ids) == [2]
    assert list(joint.assembly.mesh.element_sets["BRICKS"]) == [2]
    assert joint.interfaces == ()
    weight = sum(load.forces[:, 2].sum() for load in joint.assembly.loads.values())
    # The upper brick of 2 by 3 by 1, and the force of the deck.
    np.testing.assert_allclose(weight, -7.0 - 6.0 * 7.85e-9 * 10.0, rtol=1e-14)
    notes = "\n".join(joint.assembly.ignored)
    assert "*MODEL CHANGE in step 1: 1 elements are removed" in notes
    assert "removes all elements of SLAVE" in notes
    slave = "*SURFACE, NAME=SLAVE, TYPE=ELEMENT\n"
    assert slave in text
    assert read(text.replace(f"{slave}LOWER, S2", f"{slave}1, S2")).interfaces == ()


def test_contact_pairs_that_the_first_step_removes_are_not_there(read):
    change = "*MODEL CHANGE, TYPE=CONTACT PAIR, {}\nSLAVE, MASTER\n*END STEP\n"
    clearance = ("*RIGID BODY", "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=0.1\n*RIGID BODY")
    gone = read(edited(("*END STEP\n", change.format("REMOVE")), clearance))
    assert gone.interfaces == ()
    assert any("the contact pair SLAVE, MASTER is removed" in n for n in gone.assembly.ignored)
    assert len(read(edited(("*END STEP\n", change.format("ADD")))).interfaces) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n77", r"there is no element 77"),
        ("*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n1, 2, 3, 4, 5", r"removes all elements"),
        ("*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nMASTER, SLAVE", r"no \*CONTACT PAIR has"),
    ],
)
def test_changes_of_what_is_not_there_are_refused(read, change, message):
    with pytest.raises(FormatError, match=message):
        read(edited(("*END STEP\n", f"{change}\n*END STEP\n")))


FIXED = "*STEP\n*STATIC\n*BOUNDARY, FIXED\n{}\n*END STEP\n"


def test_steps_that_hold_nodes_where_they_are_come_behind_the_one_that_is_read(read):
    """A bolt that is locked so is another matter, by whatever name its node goes."""
    held = read(DECK + FIXED.format("15, 1, 3"))
    assert any("*BOUNDARY, FIXED" in n and "step 1 is read" in n for n in held.assembly.ignored)
    for name in ("104", "LOCK"):
        text = DECK.replace("*MATERIAL", "*NSET, NSET=LOCK\n104\n*MATERIAL", 1)
        locked = read(text + FIXED.format(f"{name}, 1"))
        assert locked.selected_load == "step 2"


def test_coordinates_left_out_are_zero_and_said(read):
    joint = read(edited(("2, 2., 0., 0.", "2, 2., 0.")))
    np.testing.assert_array_equal(joint.assembly.mesh.nodes, read(DECK).assembly.mesh.nodes)
    (note,) = [note for note in joint.assembly.ignored if "coordinates" in note]
    assert note.startswith("1 nodes with fewer than three coordinates")
    assert ":6)" in note


def test_loads_of_harmonic_responses_and_delays(read):
    """The imaginary part is no load; a delayed amplitude is read where it then stands."""
    force = read(DECK).assembly.loads["step 1"].forces
    more = "*CLOAD, LOAD CASE=2\n100, 1, 9.\n*END STEP"
    both = read(edited(("*END STEP", more))).assembly
    np.testing.assert_array_equal(both.loads["step 1"].forces, force)
    assert any("imaginary part" in note for note in both.ignored)
    late = "*CLOAD, AMPLITUDE=A, TIME DELAY=0.75\n100, 1, 8.\n*END STEP"
    ramp = ("*STEP\n", "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*STEP\n")
    delayed = read(edited(ramp, ("*END STEP", late))).assembly.loads["step 1"]
    assert delayed.forces[0, 0] == 2.0


def test_coefficients_that_forbid_slip(read):
    joint = read(edited(("*CONTACT PAIR", "*FRICTION\n1.E20, 1.E5\n*CONTACT PAIR")))
    assert joint.interfaces[0].friction == 10.0
    assert any("a coefficient of 1e+20 forbids slip" in note for note in joint.assembly.ignored)
    with pytest.raises(FormatError, match="the coefficient of friction is 20"):
        read(edited(("*CONTACT PAIR", "*FRICTION\n20.\n*CONTACT PAIR")))


def test_supports_in_all_directions_need_no_axes(read):
    """A node on the axis of its cylindrical system has none."""
    axis = "*TRANSFORM, NSET=BOTTOM, TYPE=C\n0., 0., 0., 0., 0., 1.\n"
    held = edited(("*STEP\n", axis + "*BOUNDARY\nBOTTOM, 1, 3\n*STEP\n"))
    (support,) = [one for one in read(held).assembly.supports if one.components == (0, 1, 2)]
    assert support.axes is None
    assert len(support.nodes) == 4
    around = read(held.replace("BOTTOM, 1, 3", "BOTTOM, 2, 3")).assembly
    assert any("1 nodes on the axis of their *TRANSFORM" in note for note in around.ignored)
    (support,) = [one for one in around.supports if 0 in one.nodes]
    assert support.axes is None  # the x axis is CalculiX's radial direction there
    with pytest.raises(FormatError, match="the two points of the axis coincide"):
        read(held.replace("0., 0., 0., 0., 0., 1.", "0., 0., 0., 0., 0., 0."))


def test_what_something_else_holds_cannot_be_moved(read):
    """Node 1 belongs to a rigid body whose reference is held."""
    text = edited(("*STEP\n", "*STEP\n*BOUNDARY\n1, 2, 2, 0.1\n"))
    with pytest.raises(ModelError, match="node 1 is moved along component 2, which a support"):
        read(text)
