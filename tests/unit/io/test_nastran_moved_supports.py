"""Supports that move (SPC, SPCD) against beams and a block stretched by hand."""

import numpy as np
import pytest

from faying.exceptions import FormatError, ModelError
from linear_solution import displacements_of

E, I1, L = 2e5, 2e4, 1000.0
BEAM = (
    "GRID,1\nGRID,2,,500.,0.,0.\nGRID,3,,1000.,0.,0.\n"
    f"CBAR,7,5,1,2,0.,1.,0.\nCBAR,8,5,2,3,0.,1.,0.\nPBAR,5,1,400.,{I1},1.+4,3.+4\n"
    f"MAT1,1,{E},,.3\n"
)
CONTROL = "SOL 101\nCEND\nSPC = 1\nLOAD = 9\nBEGIN BULK\n"
SPRINGS = 2e-6
"""Springs are a million times as stiff as what they move; twice that for both ends of a beam."""


@pytest.fixture
def read(nastran):
    return lambda text, control=CONTROL, model=BEAM: nastran(control + model, text, "ENDDATA")


def moved(joint, load=None):
    """Displacements (n_node, 6) under a load, by default the one the deck selects."""
    name = load or joint.selected_load
    return displacements_of(joint.assembly, joint.assembly.loads[name] if name else None)


def test_a_support_that_sinks(read):
    """Clamped, and moved at the end by w: the middle by 5/16 w."""
    text = "SPC1,1,123456,1\nSPC,1,3,2,3.\n"
    joint = read(text)
    assert joint.selected_load == "spc"
    u = moved(joint)
    np.testing.assert_allclose(u[1:, 1], [3 * 5 / 16, 3.0], rtol=SPRINGS)
    np.testing.assert_allclose(u[2, 5], 3 * 3 / (2 * L), rtol=SPRINGS)
    (note,) = [note for note in joint.assembly.ignored if "nonzero displacements" in note]
    assert note.startswith("1 nonzero displacements by SPC: springs")


def test_a_support_sinks_with_the_load_that_is_selected(read):
    text = "SPC1,1,123456,1\nSPC,1,3,2,3.\nFORCE,9,2,,100.,0.,1.,0.\nFORCE,8,2,,100.,0.,1.,0.\n"
    joint = read(text)
    assert list(joint.assembly.loads) == ["9", "8"]
    both, force = moved(joint), moved(joint, "8")
    np.testing.assert_allclose(force[1, 1], 7 * 100 * L**3 / (768 * E * I1), rtol=SPRINGS)
    np.testing.assert_allclose(both[1, 1], force[1, 1] + 3 * 5 / 16, rtol=SPRINGS)
    np.testing.assert_allclose(both[2, 1], 3.0, rtol=SPRINGS)
    np.testing.assert_allclose(force[2, 1], 0.0, atol=3 * SPRINGS)


def test_displacements_of_load_sets_move_what_is_held(read):
    """SPCD of several sets, added by LOAD, in place of SPC1; other components stay held."""
    text = (
        "SPC1,1,123456,1,3\nSPCD,2,3,26,.003\nSPCD,3,3,6,.01,3,2,1.\nFORCE,4,2,,100.,0.,1.,0.\n"
        "LOAD,9,1.,2.,2,1.,3,1.,4\n"
    )
    joint = read(text)
    assert list(joint.assembly.loads) == ["9", "2", "3", "4"]
    w, turn = 2 * 0.003 + 1.0, 2 * 0.003 + 0.01
    u = moved(joint)
    expected = w / 2 - turn * L / 8 + 100 * L**3 / (192 * E * I1)
    np.testing.assert_allclose(u[1, 1], expected, rtol=3 * SPRINGS)  # of parts that cancel
    np.testing.assert_allclose(u[2], [0, w, 0, 0, 0, turn], rtol=SPRINGS, atol=1e-12)
    still = moved(joint, "4")
    np.testing.assert_allclose(still[1, 1], 100 * L**3 / (192 * E * I1), rtol=SPRINGS)


def test_a_motion_along_the_axes_of_its_grid(read):
    """Along the second and about the third axis of a system turned by 30 degrees about x."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    system = f"CORD2R,4,,0.,0.,0.,0.,{-s:.12g},{c:.12g}\n,1.,0.,0.\n"
    joint = read(
        "SPC1,1,123456,1\nSPC1,1,123456,3\nSPC,1,3,2,3.\nSPCD,9,3,6,.02\n" + system,
        model=BEAM.replace("GRID,3,,1000.,0.,0.", "GRID,3,,1000.,0.,0.,4"),
    )
    u = moved(joint)[2]
    # Bush springs are along axes that have 12 digits here.
    np.testing.assert_allclose(u[:3], [0, 3 * c, 3 * s], atol=3 * SPRINGS)
    np.testing.assert_allclose(u[3:], [0, -0.02 * s, 0.02 * c], atol=0.02 * SPRINGS)


def test_sets_that_move_what_nothing_holds_are_left_out(read):
    joint = read("SPC1,1,123456,1\nSPCD,2,3,2,3.\nFORCE,4,2,,100.,0.,1.,0.\nSPC1,2,2,3\n")
    assert list(joint.assembly.loads) == ["4"]
    (note,) = [note for note in joint.assembly.ignored if note.startswith("load set 2")]
    assert "SPCD moves GRID 3 along component 2, where no selected SPC holds it" in note
    joint = read("SPC1,1,123456,1\nSPC,1,3,2,1.\nSPCD,2,3,2,3.\n")
    assert list(joint.assembly.loads) == ["spc"]
    assert any("along component 2, as SPC does" in note for note in joint.assembly.ignored)


@pytest.mark.parametrize(
    ("cards", "message"),
    [
        ("SPC,1,3,2,3.,3,2,4.", "GRID 3 is moved along component 2 by another SPC too"),
        ("SPC1,1,123456,1\nSPC,1,3,2,3.\nRBE2,20,1,123456,3", "node 3 is moved along component 2"),
        ("SPC,1,3,2,3.+300", "too large"),
        ("SPC1,1,1,1\nSPCD,1,4,2,3.", "GRID 4 is not in the deck"),
        ("SPC1,1,1,1\nSPCD,1,3,7,3.", "components are '7'"),
    ],
)
def test_motions_that_make_no_sense(read, cards, message):
    with pytest.raises((FormatError, ModelError), match=message):
        read(cards + "\n")


@pytest.mark.parametrize(
    "head",
    ["SOL 153\nCEND\n", "SOL 101\nCEND\nANALYSIS = HEAT\n", "CEND\nPARAM,HEATSTAT,YES\n"],
)
def test_temperatures_are_no_displacements(read, head):
    with pytest.raises(FormatError, match="SPC: a temperature, as the analysis is heat"):
        read("SPC,1,3,1,300.\n", f"{head}SPC = 1\nBEGIN BULK\n")
