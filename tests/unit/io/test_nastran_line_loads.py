"""Loads along beams (PLOAD1) against beam theory."""

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.nastran import read_joint
from linear_solution import displacements_of

E, G, A, I1, I2, J, L = 2e5, 8e4, 400.0, 2e4, 1e4, 3e4, 1000.0
HEAD = f"PBAR,5,1,{A},{I1},{I2},{J}\nPBAR,6,1,{A},{I1},{I2},{J}\n,,,,,,,,\n,.8,.8\nMAT1,1,{E},{G}\n"
CANTILEVER = "GRID,1\nGRID,2,,1000.,0.,0.\nSPC1,1,123456,1\nCBAR,7,5,1,2,0.,1.,0.\n"
SHEARED = CANTILEVER.replace("CBAR,7,5", "CBAR,7,6")
EXACT = 1e-8
"""Beams are exact; K of stretching over that of bending loses 1e4 of 1e-16, moments more."""


def moved(tmp_path, text, load="9"):
    """Displacements (n_node, 6) under a load set, by node id."""
    path = tmp_path / "beam.bdf"
    path.write_text(f"{HEAD}{text}ENDDATA\n")
    assembly = read_joint(path).assembly
    u = displacements_of(assembly, assembly.loads[load])
    return dict(zip(assembly.mesh.node_ids.tolist(), u, strict=True))


CASES = {
    "FYE,FR,0.,2.,1.,2.": {1: 2 * L**4 / (8 * E * I1), 5: 2 * L**3 / (6 * E * I1)},
    "FZ,LE,0.,2.,1000.,2.": {2: 2 * L**4 / (8 * E * I2), 4: -2 * L**3 / (6 * E * I2)},
    # growing from nothing at the clamp: 11 q L⁴ / 120 E I
    "FY,FR,0.,0.,1.,2.": {1: 11 * 2 * L**4 / (120 * E * I1), 5: 2 * L**3 / (8 * E * I1)},
    "FY,FR,1.,2.,0.": {1: 11 * 2 * L**4 / (120 * E * I1), 5: 2 * L**3 / (8 * E * I1)},
    "FYE,LE,300.,50.": {1: 50 * 300**2 * (3 * L - 300) / (6 * E * I1), 5: 50 * 300**2 / 2 / E / I1},
    "FY,FR,.3,50.,.3,7.": {
        1: 50 * 300**2 * (3 * L - 300) / (6 * E * I1),
        5: 50 * 300**2 / 2 / E / I1,
    },
    "FXE,FR,0.,2.,.5,2.": {0: 2 * 500 * 250 / (E * A)},
    "MXE,FR,.5,30.": {3: 30 * 500 / (G * J)},
    "MZE,LE,400.,30.": {1: 30 * 400 * (L - 200) / (E * I1), 5: 30 * 400 / (E * I1)},
    "MY,LE,400.,30.": {2: -30 * 400 * (L - 200) / (E * I2), 4: 30 * 400 / (E * I2)},
    "MZ,FR,0.,3.,1.,3.": {1: 3 * L**3 / (3 * E * I1), 5: 3 * L**2 / (2 * E * I1)},
}


@pytest.mark.parametrize("load", CASES)
def test_the_end_of_a_cantilever(tmp_path, load):
    u = moved(tmp_path, f"{CANTILEVER}PLOAD1,9,7,{load}\n")[2]
    expected = np.zeros(6)
    expected[list(CASES[load])] = list(CASES[load].values())
    np.testing.assert_allclose(u, expected, rtol=EXACT, atol=EXACT * np.abs(expected).max())


def test_shear_deflects_too(tmp_path):
    u = moved(tmp_path, f"{SHEARED}PLOAD1,9,7,FY,FR,0.,2.,1.,2.\n")[2]
    bent, sheared = 2 * L**4 / (8 * E * I1), 2 * L**2 / (2 * 0.8 * G * A)
    np.testing.assert_allclose(u[1], bent + sheared, rtol=EXACT)


@pytest.mark.parametrize("kind", ["FX", "FY", "MY", "MZ", "FZE", "MXE"])
def test_a_divided_beam_moves_as_one(tmp_path, kind):
    """Askew, with shear, held at both ends; the load goes beyond the place of division."""
    ends = "GRID,1\nGRID,2,,300.,400.,500.\nSPC1,1,123456,1\nCELAS2,90,50.,2,1\nCELAS2,91,70.,2,2\n"
    long = float(np.hypot(500, 500))
    one = f"{ends}CBAR,7,6,1,2,1.,1.,0.\nPLOAD1,9,7,{kind},FR,.1,2.,.7,9.\n"
    # At .4 of the length the intensity is half way between.
    two = (
        f"{ends}GRID,3,,120.,160.,200.\nCBAR,7,6,1,3,1.,1.,0.\nCBAR,8,6,3,2,1.,1.,0.\n"
        f"PLOAD1,9,7,{kind},LE,{0.1 * long:.12g},2.,{0.4 * long:.12g},5.5\n"
        f"PLOAD1,9,8,{kind},FR,0.,5.5,.5,9.\n"
    )
    expected = moved(tmp_path, one)[2]
    np.testing.assert_allclose(
        moved(tmp_path, two)[2], expected, rtol=0, atol=EXACT * np.abs(expected).max()
    )


def test_intensity_of_a_projected_length(tmp_path):
    """Snow on a roof of 3 to 4: it lies on 4/5 of the length; along the beam nothing changes."""
    roof = CANTILEVER.replace("1000.,0.,0.", "800.,600.,0.")
    for kind, share in (("FY", 0.8), ("FX", 0.6), ("FZ", 1.0), ("FYE", 1.0)):
        for scale, whole in (("FR", "1."), ("LE", "1000.")):
            seen = moved(tmp_path, f"{roof}PLOAD1,9,7,{kind},{scale}PR,0.,2.,{whole},2.\n")[2]
            plain = moved(tmp_path, f"{roof}PLOAD1,9,7,{kind},{scale},0.,2.,{whole},2.\n")[2]
            np.testing.assert_allclose(seen, share * plain, rtol=1e-12)
    # A single force has no length to project.
    one, other = (
        moved(tmp_path, f"{roof}PLOAD1,9,7,FY,FR{word},.5,2.\n")[2] for word in ("", "PR")
    )
    np.testing.assert_array_equal(one, other)


def test_a_hinged_end_carries_its_reaction(tmp_path):
    """Clamped, and hinged at a spring: 3/8 of the load where that is rigid."""
    k = 0.5
    text = CANTILEVER + f",,56\nSPC1,1,3456,2\nCELAS2,90,{k},2,2\nPLOAD1,9,7,FY,FR,0.,2.,1.,2.\n"
    u = moved(tmp_path, text)[2][1]
    free = 2 * L**4 / (8 * E * I1)
    np.testing.assert_allclose(u, free / (1 + k * L**3 / (3 * E * I1)), rtol=EXACT)


def test_lengths_of_a_beam_with_offsets_begin_at_its_end(tmp_path):
    text = "GRID,1\nGRID,2,,1000.,0.,0.\nSPC1,1,123456,1\nCBAR,7,5,1,2,0.,1.,0.\n,,,100.,0.,0.\n"
    u = moved(tmp_path, f"{text}PLOAD1,9,7,FY,LE,300.,50.\n")[2]
    np.testing.assert_allclose(u[1], 50 * 300**2 * (3 * 900 - 300) / (6 * E * I1), rtol=EXACT)


def test_what_programs_do_not_define_is_left_out(tmp_path):
    path = tmp_path / "beam.bdf"
    path.write_text(f"{HEAD}{CANTILEVER}PLOAD1,9,7,MY,FRPR,0.,1.,1.,1.\nFORCE,8,2,,1.,1.,0.,0.\n")
    assembly = read_joint(path).assembly
    assert list(assembly.loads) == ["8"]
    assert any("load set 9" in note and "projected" in note for note in assembly.ignored)


REFUSED = [
    ("PLOAD1,9,8,FY,FR,0.,1.,1.,1.", "element 8 is not a CBAR or CBEAM"),
    ("PLOAD1,9,7,FW,FR,0.,1.,1.,1.", "TYPE = 'FW'; it is FX"),
    ("PLOAD1,9,7,FY,F,0.,1.,1.,1.", "SCALE = 'F'; it is LE, FR"),
    ("PLOAD1,9,7,FY,FR,0.,1.,1.2,1.", "lie beyond the ends of the beam, which is 1000 long"),
    ("PLOAD1,9,7,FY,LE,-1.,1.,1.2,1.", "lie beyond the ends"),
    ("PLOAD1,9,7,FY,FR,0.,1.+308,1.,1.+308", "too large"),
]


@pytest.mark.parametrize(("card", "message"), REFUSED)
def test_loads_that_make_no_sense(tmp_path, card, message):
    with pytest.raises(FormatError, match=f"PLOAD1: .*{message}"):
        moved(tmp_path, f"{CANTILEVER}{card}\n")


def test_loads_along_axes_that_no_beam_keeps_are_left_out(tmp_path):
    """Sections with I12 are turned to their principal axes; basic directions stay what they are."""
    path = tmp_path / "beam.bdf"
    turned = HEAD + CANTILEVER.replace("CBAR,7,5", "CBAR,7,8")
    turned += f"PBAR,8,1,{A},{I1},{I2},{J}\n,,,,,,,,\n,,,8000.\n"
    path.write_text(f"{turned}PLOAD1,9,7,FYE,FR,0.,1.,1.,1.\nPLOAD1,8,7,FY,FR,0.,1.,1.,1.\n")
    assembly = read_joint(path).assembly
    assert list(assembly.loads) == ["8"]
    assert any("load set 9" in note and "I12" in note for note in assembly.ignored)
    u = moved(tmp_path, f"{turned.removeprefix(HEAD)}PLOAD1,8,7,FY,FR,0.,1.,1.,1.\n", "8")[2]
    bent = np.linalg.solve([[I1, 8000.0], [8000.0, I2]], [L**4 / (8 * E), 0.0])
    np.testing.assert_allclose(u[1:3], bent, rtol=EXACT)
