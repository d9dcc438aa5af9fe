"""Offsets and pins of CBAR and CBEAM against beam theory."""

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.nastran import read_deck
from faying.model.assembly import NodalLoads
from linear_solution import displacements_of

E, A, I1, I2, L, F = 2e5, 400.0, 2e4, 1e4, 1000.0, 100.0
HEAD = f"PBAR,5,1,{A},{I1},{I2},3.+4\nPBEAM,6,1,{A},{I1},{I2},,3.+4\n,,,,,,,,\nMAT1,1,2.+5,,.3\n"
HALVES = "GRID,1\nGRID,2,,500.,0.,0.\nGRID,3,,1000.,0.,0.\nSPC1,1,123456,1,3\n"


def moved(tmp_path, text, place, force):
    """Displacements (n_node, 6) under a force at one grid."""
    path = tmp_path / "beam.bdf"
    path.write_text(f"{HEAD}{text}ENDDATA\n")
    assembly = read_deck(path)
    load = NodalLoads(nodes=np.array([place]), forces=np.array([force]))
    return displacements_of(assembly, load)


@pytest.mark.parametrize(
    ("grid", "offset"),
    [("", "0.,50.,0."), (",2", "50.,0.,0.")],  # along y, which is the first axis of system 2
    ids=["basic", "turned"],
)
@pytest.mark.parametrize("kind", ["CBAR,7,5", "CBEAM,7,6"])
def test_a_pull_beside_the_axis_bends(tmp_path, kind, grid, offset):
    text = (
        "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"
        f"GRID,1,,0.,0.,0.{grid}\nGRID,2,,1000.,0.,0.{grid}\nSPC1,1,123456,1\n"
        f"{kind},1,2,0.,1.,0.,BGG\n,,,{offset},{offset}\n"
    )
    u = moved(tmp_path, text, 1, [F, 0, 0, 0, 0, 0])[1]
    e = 50.0
    turned = F * e * L / (E * I1)
    expected = [F * L / (E * A) + turned * e, turned * L / 2, 0, 0, 0, turned]
    np.testing.assert_allclose(u, expected, rtol=1e-9, atol=1e-15)  # beams are exact


def test_offsets_along_the_axes_of_the_element(tmp_path):
    """Of a beam between the grids: the same as their parts in the displacement system."""
    grids = "GRID,1\nGRID,2,,0.,800.,600.\nSPC1,1,123456,1\n"
    x, y = np.array([0, 0.8, 0.6]), np.array([1.0, 0, 0])
    z = np.cross(x, y)
    first, second = 20 * x + 30 * y - 10 * z, -5 * x + 40 * z
    last = ",".join(f"{value:.9g}" for value in second)
    every = ",".join(f"{value:.9g}" for value in first)
    force = [F, 2 * F, 3 * F, 0, 0, 0]
    of_element = f"{grids}CBAR,7,5,1,2,1.,.4,.3,GOO\n,,,20.,30.,-10.,-5.,0.,40.\n"
    basic = f"{grids}CBAR,7,5,1,2,1.,.4,.3\n,,,{every},{last}\n"
    mixed = f"{grids}CBAR,7,5,1,2,1.,.4,.3,BGO\n,,,{every},-5.,0.,40.\n"
    expected = moved(tmp_path, basic, 1, force)[1]
    for text in (of_element, mixed):
        # Nine digits of the offsets.
        np.testing.assert_allclose(moved(tmp_path, text, 1, force)[1], expected, rtol=1e-7)


def test_a_hinge_at_an_end_turned_about_the_beam(tmp_path):
    """Clamped and hinged in the plane of v, clamped twice in the other."""
    beams = "CBAR,7,5,1,2,0.,1.,1.\nCBAR,8,5,2,3,0.,1.,1.\n,,6\n"
    v, w = np.array([0, 1, 1]) / np.sqrt(2), np.array([0, -1, 1]) / np.sqrt(2)
    for direction, deflection in (
        (v, 7 * F * L**3 / (768 * E * I1)),
        (w, F * L**3 / (192 * E * I2)),
    ):
        u = moved(tmp_path, HALVES + beams, 1, [*(F * direction), 0, 0, 0])
        # Beams are exact; equations of unit vectors round at 1e-16 of 1e8.
        np.testing.assert_allclose(u[1, :3], deflection * direction, rtol=1e-7, atol=1e-12)


def test_pins_and_offsets_of_one_end(tmp_path):
    """A truss bar: hinged at both ends, free to turn about itself; it carries its axis alone."""
    text = (
        "GRID,1\nGRID,2,,1000.,0.,0.\nGRID,3,,1000.,0.,300.\nSPC1,1,123456,1,3\n"
        "CBAR,7,5,1,2,0.,1.,0.\nCBAR,8,5,2,3,0.,1.,0.\n,456,456,100.,0.,0.,100.,0.,0.\n"
    )
    u = moved(tmp_path, text, 1, [0, 0, F, 0, 0, 0])[1]
    # Deflection and slope of the end; the bar of 300 stands 100 beyond it, joined rigidly.
    cantilever = E * I2 * np.array([[12 / L**3, -6 / L**2], [-6 / L**2, 4 / L]])
    reach = np.array([1.0, 100.0])
    stiffness = cantilever + E * A / 300 * np.outer(reach, reach)
    # Beams are exact; the bar is a thousand times stiffer than the cantilever.
    np.testing.assert_allclose([u[2], -u[4]], np.linalg.solve(stiffness, [F, 0]), rtol=1e-7)


REFUSED = [
    ("CBAR,7,5,1,2,0.,1.,0.\n,7", "pin flag: components are '7'"),
    ("CBAR,7,5,1,2,0.,1.,0.,GXG\n,,,1.", "OFFT = 'GXG' is not supported"),
    ("CBAR,7,5,1,2,1.,0.,0.,GOG\n,,,0.,1.", "the orientation vector is zero or parallel"),
    ("CBAR,7,5,1,2,0.,1.,0.\n,,,,,,-500.", "the element has no length"),
]


@pytest.mark.parametrize(("card", "message"), REFUSED)
def test_ends_that_are_refused(tmp_path, card, message):
    with pytest.raises(FormatError, match=rf"CBAR: {message}"):
        moved(tmp_path, f"{HALVES}{card}\n", 1, np.zeros(6))


@pytest.mark.parametrize(
    ("kind", "card"),
    [
        ("CBAR", f"PBAR,8,1,{A},{I1},{I2},3.+4\n,,,,,,,,\n,,,8000."),
        ("CBEAM", f"PBEAM,8,1,{A},{I1},{I2},8000.,3.+4\n,,,,,,,,\n,0.,0."),
    ],
)
def test_a_section_that_is_not_given_along_its_principal_axes(tmp_path, kind, card):
    """Bending by the matrix of I1, I12 and I2; a pin acts along the axes of the element."""
    clamp = f"{card}\nGRID,1\nGRID,2,,1000.,0.,0.\nSPC1,1,123456,1\n{kind},7,8,1,2,0.,1.,0.\n"
    inertia = np.array([[I1, 8000.0], [8000.0, I2]])
    for force in ([F, 0], [0, F], [F, -2 * F]):
        u = moved(tmp_path, clamp, 1, [0, *force, 0, 0, 0])[1]
        bent = np.linalg.solve(inertia, force) * L**3 / (3 * E)
        np.testing.assert_allclose(u[1:3], bent, rtol=1e-9)  # beams are exact
        np.testing.assert_allclose(u[[5, 4]] * [1, -1], 1.5 * bent / L, rtol=1e-9)
    # Released about z at its second end, which keeps slopes: no moment about z acts there.
    pinned = f"{clamp},,6\nSPC1,1,456,2\n"
    u = moved(tmp_path, pinned, 1, [0, 0, F, 0, 0, 0])[1]
    # Unknown deflections v, w and slope of v; that of w is held: K of (v, w, v').
    k = E / L**3 * np.array([[12, 6 * L], [6 * L, 4 * L**2]])  # (deflection, slope) at the end
    k = k * np.array([[1, -1], [-1, 1]])
    full = np.zeros((3, 3))
    full[np.ix_([0, 2], [0, 2])] += I1 * k
    full[1, 1] = I2 * k[0, 0]
    full[0, 1] = full[1, 0] = inertia[0, 1] * k[0, 0]
    full[1, 2] = full[2, 1] = inertia[0, 1] * k[0, 1]
    np.testing.assert_allclose(u[1:3], np.linalg.solve(full, [0, F, 0])[:2], rtol=1e-7)


def test_sections_whose_principal_axes_make_no_sense(tmp_path):
    beam = HALVES + "CBAR,7,8,1,2,0.,1.,0.\n"
    with pytest.raises(FormatError, match=r"PBAR: I12 = 20000 with .*I12² must be below I1 I2"):
        moved(tmp_path, f"PBAR,8,1,{A},{I1},{I2},3.+4\n,,,,,,,,\n,,,2.+4\n{beam}", 1, np.zeros(6))
    with pytest.raises(FormatError, match="different shear factors"):
        moved(tmp_path, f"PBAR,8,1,{A},{I1},{I2},3.+4\n,,,,,,,,\n,.8,.7,1.+3\n{beam}", 1, [0] * 6)
