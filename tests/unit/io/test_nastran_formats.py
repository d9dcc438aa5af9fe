"""Small, large and free field, continuations, comments, includes, sections."""

from pathlib import Path

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.nastran import read_deck
from faying.io.nastran.case_control import LUMPED
from refusals import refuses

SMALL = """\
GRID    1               0.      0.      0.
GRID    2               1.      0.      0.
GRID    3               0.      1.      0.
GRID    4               0.      0.      1.5-3           456
CTETRA  7       3       1       2       3       4
PSOLID  3       9
MAT1    9       2.1+5           .3      7.82-9
"""
LARGE = """\
GRID*   1                               0.              0.
*       0.
GRID*   2                               1.0D0           0.
*       0.
GRID*   3                               0.              1.              *G3
*G3     0.
GRID*                  4                             0.              0.
$ a comment between
*                 1.5E-3                             456
CTETRA* 7               3               1               2
*       3               4
PSOLID* 3               9
MAT1*   9               210000.                         .3
*       7.82D-9
"""
FREE = """\
grid,1,,0.,0.,0.
GRID, 2, , 1. ,0,0.   $ trailing comment
GRID*,3,,0.,1.
*,0.
GRID,4,,0.,0.,.0015,,456
CTETRA*,7,3,1,2,*
*,3,4
PSOLID,3,9
MAT1,9,2.1E+5,,.3,7.82-9
"""


def deck(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


@pytest.mark.parametrize("text", [SMALL, LARGE, FREE], ids=["small", "large", "free"])
def test_three_formats_say_the_same(tmp_path: Path, text: str) -> None:
    assembly = read_deck(deck(tmp_path / "a.bdf", text))
    assert assembly.mesh.node_ids.tolist() == [1, 2, 3, 4]
    expected = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.0015]]
    assert np.array_equal(assembly.mesh.nodes, expected)
    (block,) = assembly.mesh.blocks
    assert (block.kind, block.ids.tolist(), block.nodes.tolist()) == ("tet4", [7], [[0, 1, 2, 3]])
    assert assembly.materials[3].youngs_modulus == 210000.0
    assert assembly.materials[3].density == 7.82e-9
    assert assembly.supports[0].nodes.tolist() == [3]
    assert assembly.supports[0].components == (3, 4, 5)


def test_tabs_and_carriage_returns(tmp_path: Path) -> None:
    text = SMALL.replace("GRID    1               0.", "GRID\t1\t\t0.").replace("\n", "\r\n")
    assert np.array_equal(read_deck(deck(tmp_path / "a.bdf", text)).mesh.nodes[0], [0, 0, 0])


def test_continuation_marks_and_mixed_fields(tmp_path: Path) -> None:
    nodes = "".join(f"GRID,{i},,{i}.,0.,0.\n" for i in range(1, 13))
    small = "RBE2    1       1       123     2       3       4       5       6       +A\n"
    text = nodes + small + "+A      7       8\n"
    assert len(read_deck(deck(tmp_path / "a.bdf", text)).rigid_couplings[0].nodes) == 7
    # One large line continued by a small one: the small line starts at the next row of eight.
    large = "CONM2*  1               1               0               5.\n        7.\n"
    turning = "CELAS2,9,7.,1,4\n"
    mass = read_deck(deck(tmp_path / "b.bdf", nodes + turning + large)).masses[0]
    assert (mass.mass, mass.inertia[0][0]) == (5.0, 7.0)
    with pytest.raises(FormatError, match=r"c\.bdf:14: .*does not belong"):
        read_deck(deck(tmp_path / "c.bdf", nodes + small + "+B      7       8\n"))


def test_sections_are_skipped_and_enddata_ends(tmp_path: Path) -> None:
    head = "NASTRAN X\nSOL 101\nCEND\nTITLE = GRID\nDISP = ALL\nBEGIN BULK\n"
    assembly = read_deck(deck(tmp_path / "a.bdf", head + SMALL + "ENDDATA\nNONSENSE,1\n"))
    assert len(assembly.mesh.nodes) == 4
    assert assembly.ignored == ("case control requests DISP", LUMPED)
    refuses("no BEGIN BULK", read_deck, deck(tmp_path / "b.bdf", "SOL 101\nCEND\n" + SMALL))
    with pytest.raises(FormatError, match=r"c\.bdf:2: .*superelement"):
        read_deck(deck(tmp_path / "c.bdf", "BEGIN BULK\nBEGIN SUPER=1\n" + SMALL))


def test_include_is_relative_to_the_including_file(tmp_path: Path) -> None:
    (tmp_path / "Parts").mkdir()
    lines = SMALL.splitlines(keepends=True)
    deck(tmp_path / "Parts" / "Mesh.dat", "".join(lines[:5]) + "include more.dat\n")
    deck(tmp_path / "Parts" / "more.dat", "".join(lines[5:6]))
    main = "BEGIN BULK\nINCLUDE 'Parts/\n  Mesh.dat'\n" + lines[6] + "ENDDATA\n"
    assert read_deck(deck(tmp_path / "a.bdf", main)).mesh.n_elements == 1
    deck(tmp_path / "Parts" / "more.dat", "PSOLID,3,x\n")
    refuses(r"more\.dat:1: PSOLID: field 3 \(MID\) holds 'X'", read_deck, tmp_path / "a.bdf")
    deck(tmp_path / "Parts" / "more.dat", "INCLUDE 'Mesh.dat'\n")
    refuses("circular", read_deck, tmp_path / "a.bdf")
    (tmp_path / "Parts" / "more.dat").unlink()
    refuses(r"Mesh\.dat:6: INCLUDE: .*more\.dat' does not exist", read_deck, tmp_path / "a.bdf")


def test_includes_beside_the_deck_where_none_is_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    lines = SMALL.splitlines(keepends=True)
    deck(tmp_path / "parts" / "mesh.dat", "".join(lines[:5]) + "INCLUDE 'parts/more.dat'\n")
    deck(tmp_path / "parts" / "more.dat", lines[5])
    main = deck(tmp_path / "a.bdf", "BEGIN BULK\nINCLUDE 'parts/mesh.dat'\n" + lines[6])
    assert read_deck(main).mesh.n_elements == 1
    (tmp_path / "parts" / "parts").mkdir()
    deck(tmp_path / "parts" / "parts" / "more.dat", "PSOLID,3,x\n")
    refuses(r"field 3 \(MID\) holds 'X'", read_deck, main)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "GRID,5,,1..2,0.,0.",
            r"a\.bdf:8: GRID: field 4 \(X1\) holds '1\.\.2', expected a real number",
        ),
        ("GRID,5,,1.,0.,1E999", r"8: GRID: field 6 \(X3\) holds '1E999'"),
        ("GRID,x,,1.,0.,0.", r"8: GRID: field 2 \(ID\) holds 'X', expected an integer"),
        ("GRID,,,1.,0.,0.", r"8: GRID: field 2 \(ID\) holds nothing"),
        ("GRID,2,,1.,0.,0.", r"8: GRID: id 2 is already used at .*a\.bdf:2"),
        ("GRID,5,77,1.,0.,0.", r"8: GRID: coordinate system 77 is not in the deck"),
        ("CTETRA,7,3,1,2,3,4", r"8: CTETRA: element 7 is already used at .*a\.bdf:5"),
        ("CTETRA,8,3,1,2,3,44", r"8: CTETRA: GRID 44 is not in the deck"),
        ("CTETRA,8,33,1,2,3,4", r"8: CTETRA: property 33 is not in the deck.*PSOLID"),
        ("CTETRA,8,3,1,2,3", r"8: CTETRA: 3 nodes; supported are 4 or 10"),
        ("CTETRA,8,3,1,2,3,3", r"8: CTETRA: element 8 has the same node twice"),
        ("MAT1,9,1.,,.3", r"8: MAT1: material 9 is already defined at .*a\.bdf:7"),
        ("PSOLID,3,9", r"8: PSOLID: property 3 is already defined at .*a\.bdf:6"),
        ("CQUADX,9,1,1,2,3,4", r"8: CQUADX: the card is not supported"),
        ("GRID,5,,1.,0.,0.,,,,9,9", r"8: a free-field line with more than 8"),
        ("CONM2,3,99,0,1.", r"8: CONM2: GRID 99 is not"),
        ("PBUSH,4,K,1.\nPBUSH,4,K,2.", r"9: PBUSH: property 4 is already defined at .*a\.bdf:8"),
        ("PROD,4,9,1.\nPROD,4,9,2.", r"9: PROD: property 4 is already defined at .*a\.bdf:8"),
        ("PSHELL,4,9,1.\nPSHELL,4,9,2.", r"9: PSHELL: property 4 is already defined at .*bdf:8"),
        ("CBUSH,8,4,1,2,,,,0", r"8: CBUSH: property 4 is not in the deck.*PBUSH"),
        ("CROD,8,4,1,2", r"8: CROD: property 4 is not in the deck.*PROD"),
        ("CBAR,8,4,1,2,0.,0.,1.", r"8: CBAR: property 4 is not in the deck.*PBAR or PBARL"),
        ("CELAS1,8,4,1,1,2,1", r"8: CELAS1: property 4 is not in the deck.*PELAS"),
        ("CONM2,8,1,6,1.,,,,,\n,1.", r"8: CONM2: coordinate system 6 is not in the deck"),
        ("PBUSH,4,K,1.\nCBUSH,8,4,1,2,,,,6", r"9: CBUSH: coordinate system 6 is not in the deck"),
        ("GRAV,8,6,9.81,0.,0.,1.", r"8: GRAV: coordinate system 6 is not in the deck"),
    ],
)
def test_errors_name_file_line_and_text(tmp_path: Path, line: str, message: str) -> None:
    refuses(message, read_deck, deck(tmp_path / "a.bdf", SMALL + line + "\n"))


def test_other_faults(tmp_path: Path) -> None:
    refuses(r"missing\.bdf' does not exist", read_deck, tmp_path / "missing.bdf")
    refuses("no GRID", read_deck, deck(tmp_path / "a.bdf", "$ nothing\n"))
    with pytest.raises(FormatError, match=r"a\.bdf:1: a continuation line without a card"):
        read_deck(deck(tmp_path / "a.bdf", "+       1\n"))
    with pytest.raises(FormatError, match=r"material 8 is not in the deck.*MAT1"):
        read_deck(deck(tmp_path / "a.bdf", SMALL.replace("3       9\n", "3       8\n")))
