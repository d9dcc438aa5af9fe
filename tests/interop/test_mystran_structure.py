"""Rods, bushes and shells of one deck, read by the open Nastran `mystran` and by faying."""

import numpy as np
import pytest
from programs import mystran, or_skip, run_mystran

from faying.io.nastran import read_deck
from faying.model.matrices import assemble_matrices

# Rounding of sums in another order, over the largest entry.
SAME = 1e-13


@pytest.fixture(scope="module")
def binary():
    return or_skip(mystran)


PLACES = [(0, 0, 0), (4, 0, 0), (4, 2, 0), (0, 2, 1), (1, 2, 3), (4, 0, 0)]
# Springs to a held node and masses, so that there are modes to ask for.
LINES = (
    "SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,1\nSPC1,1,123456,1\n"
    + "".join(f"GRID,{i},,{x}.,{y}.,{z}.\n" for i, (x, y, z) in enumerate(PLACES, 1))
    + "".join(f"CONM2,{900 + i},{i},0,1.\n" for i in range(2, 7))
    + "".join(
        f"CELAS2,{700 + 10 * i + c},1.,{i},{c},1,{c}\n" for i in range(2, 7) for c in range(1, 7)
    )
    + "MAT1,9,210000.,,.3,7.8-9\nCORD2R,7,,0.,0.,0.,1.,1.,0.\n,0.,0.,1.\n"
    + "PBUSH,20,K,1.,2.,3.,4.,5.,6.\nPBUSH,21,K,1.,,,4.\nPROD,10,9,3.,5.\n"
)


@pytest.mark.parametrize(
    "card",
    [
        "CROD,1,10,1,5",
        "CONROD,1,1,3,9,2.,1.",
        "CBUSH,1,20,2,6,,,,7",  # coincident nodes, axes of their own
        "CBUSH,1,20,1,5,,,,7",
        "CBUSH,1,20,1,5,,,,7\n,.25",  # acting at a quarter of the way
        "CBUSH,1,20,1,5,,,,7\n,,7,1.,2.,3.",  # acting at a place of its own
        "CBUSH,1,20,1,5,0.,0.,1.",
        "CBUSH,1,21,1,5",
    ],
)
def test_rods_and_bushes_are_those_of_mystran(binary, tmp_path, card):
    path = tmp_path / "lines.bdf"
    path.write_text(f"{LINES}{card}\nPARAM,AUTOSPC,N\nENDDATA\n")
    assert_equal(path, run_mystran(binary, path, "KGG"))


def assert_equal(path, theirs):
    assembly = read_deck(path)
    K = assemble_matrices(assembly).K.toarray()
    place = 6 * assembly.mesh.node_index(theirs.everything[:, 0]) + theirs.everything[:, 1] - 1
    difference = np.abs(K[np.ix_(place, place)] - theirs.matrices["KGG"]).max()
    assert difference < SAME * np.abs(K).max()


@pytest.mark.parametrize(
    ("kind", "sizes"),
    [
        ("I", "30.,20.,10.,2.,1.,.5"),
        ("I1", "10.,2.,20.,24."),
        ("H", "5.,3.,20.,.5"),
        ("CROSS", "8.,2.,20.,3."),
        ("T", "20.,30.,2.,3."),
        ("T1", "20.,20.,2.,4."),
        ("T2", "20.,30.,2.,3."),
        ("CHAN", "10.,30.,2.,6."),
    ],
)
def test_walled_sections_are_those_of_mystran(binary, tmp_path, kind, sizes):
    """Of a slender cantilever; shear is left to each program and counts 10⁻³ there."""
    path = tmp_path / "bar.bdf"
    path.write_text(
        "SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,1\nSPC1,1,123456,1\n"
        "GRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nGRID,3,,2000.,0.,0.\nMAT1,1,210000.,,.3,7.8-9\n"
        f"CBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,2,3,0.,1.,0.\nPBARL,1,1,,{kind}\n,{sizes}\nENDDATA\n"
    )
    theirs = run_mystran(binary, path, "KGG").matrices["KGG"][6:, 6:]
    ours = assemble_matrices(read_deck(path)).K.toarray()[6:, 6:]
    found, wanted = (np.diag(np.linalg.inv(one)) for one in (ours, theirs))
    np.testing.assert_allclose(found[[0, 4, 5]], wanted[[0, 4, 5]], rtol=1e-6)
    np.testing.assert_allclose(found[[1, 2]], wanted[[1, 2]], rtol=2e-2)
    # Where walls meet, torsion is estimated; 11 % between the estimates for walls of 6 by 10.
    np.testing.assert_allclose(found[3], wanted[3], rtol=0.13)


N_X, N_Y = 12, 6


def plate(element, section):
    """A cantilever plate of 120 by 60, held at x = 0."""
    corner = [1 + i + (N_X + 1) * j for j in range(N_Y) for i in range(N_X)]
    cells = [(a, a + 1, a + N_X + 2, a + N_X + 1) for a in corner]
    if element == "CTRIA3":
        cells = [part for a, b, c, d in cells for part in ((a, b, c), (a, c, d))]
    places = [(10 * i, 10 * j) for j in range(N_Y + 1) for i in range(N_X + 1)]
    # The same direction in every shell: THETA is measured from the first side.
    angles = [30.0, -15.0] if element == "CTRIA3" else [30.0]
    return (
        "SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK\nEIGRL,1,,,2\n"
        + "".join(f"SPC1,1,123456,{1 + (N_X + 1) * j}\n" for j in range(N_Y + 1))
        + "".join(f"GRID,{n},,{x}.,{y}.,0.\n" for n, (x, y) in enumerate(places, 1))
        + "".join(
            f"{element},{n},1,{','.join(map(str, cell))},{angles[(n - 1) % len(angles)]}\n"
            for n, cell in enumerate(cells, 1)
        )
        + f"{section}\nMAT1,9,210000.,,.3,7.8-9\nMAT8,8,140000.,9000.,.3,5000.,4000.,3000.,1.6-9\n"
        + "ENDDATA\n"
    )


THIN, THICK = "PSHELL,1,9,2.,9,,9", "PSHELL,1,9,12.,9,,9"
MIRRORED = "PCOMP,1,,,,,,,SYM\n,8,.5,0.,,8,.5,45."
COUPLED = "PCOMP,1\n,8,.5,0.,,8,.5,45.\n,8,.5,-45.,,8,.5,90."


@pytest.mark.parametrize(
    ("element", "section"),
    [
        *(("CQUAD4", section) for section in (THIN, THICK, MIRRORED, COUPLED)),
        # mystran's triangles leave the coupling of membrane and bending out.
        *(("CTRIA3", section) for section in (THIN, THICK, MIRRORED)),
    ],
)
def test_plates_bend_and_stretch_like_those_of_mystran(binary, tmp_path, element, section):
    """Tip motions under tip forces along x, y, z; other elements on the same coarse mesh."""
    path = tmp_path / "plate.bdf"
    path.write_text(plate(element, section))
    theirs = run_mystran(binary, path, "KGG")
    assembly = read_deck(path)
    place = 6 * assembly.mesh.node_index(theirs.everything[:, 0]) + theirs.everything[:, 1] - 1
    ours = assemble_matrices(assembly).K.toarray()[np.ix_(place, place)]
    nodes = assembly.mesh.nodes[place // 6]
    free = nodes[:, 0] > 0
    tip = nodes[free, 0] == 120
    for component in range(3):
        force = (tip & (place[free] % 6 == component)).astype(float)
        moved = [
            # Theirs has no drilling stiffness.
            force @ np.linalg.lstsq(K[np.ix_(free, free)], force, rcond=1e-12)[0]
            for K in (ours, theirs.matrices["KGG"])
        ]
        assert moved[0] == pytest.approx(moved[1], rel=0.05)
