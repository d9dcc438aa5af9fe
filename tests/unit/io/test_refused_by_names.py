"""Large decks are refused by the names in them, before the data of what is supported are read."""

from itertools import product

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.abaqus import read_joint as read_abaqus
from faying.io.nastran import read_joint as read_nastran
from faying.io.nastran.telling_lines import TellingLines

# Data that no table could be made of.
NASTRAN = (
    "SOL 101\nCEND\nBEGIN BULK\n$ comment\nCGAP,1,2,3,4\n"
    "GRID,1,,0.,0.,0.\nGRID,2,,a,b,c,d,e,f,g,h,i,j,k\nPLSOLID,3,4\nENDDATA\n"
)
ABAQUS = (
    "*HEADING\n*PART, NAME=P\n*NODE\nnothing\n*ELEMENT, TYPE=C3D8\n1, x\n*NGEN\n1, 2\n*END PART\n"
    "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*INSTANCE, NAME=J, PART=P\n"
    "*END INSTANCE\n*END ASSEMBLY\n*SUBMODEL\n"
)
ENDS = ("\n", "\r\n", "\r")


@pytest.mark.parametrize("end", ENDS, ids=["LF", "CRLF", "CR"])
def test_nastran_decks(tmp_path, end):
    path = tmp_path / "deck.bdf"
    path.write_bytes(NASTRAN.replace("\n", end).encode())
    with pytest.raises(FormatError) as caught:
        read_nastran(path)
    assert "2 kinds of cards" in str(caught.value)
    assert "deck.bdf:5: CGAP (1)" in str(caught.value)
    assert "deck.bdf:8: PLSOLID (1)" in str(caught.value)


@pytest.mark.parametrize("end", ENDS, ids=["LF", "CRLF", "CR"])
def test_abaqus_decks(tmp_path, end):
    path = tmp_path / "deck.inp"
    path.write_bytes(ABAQUS.replace("\n", end).encode())
    with pytest.raises(FormatError) as caught:
        read_abaqus(path)
    assert "2 kinds of keywords" in str(caught.value)
    assert "deck.inp:7: *NGEN (2)" in str(caught.value)
    assert "deck.inp:16: *SUBMODEL (1)" in str(caught.value)


KEPT = [
    (1, "GRID,1,,0.,0.,0."),
    (4, "CHEXA   1       1       1       2       3       4       5       6       +A"),
    (5, "+A      7       8"),
    (10, "GRIDB,7"),
    (11, "  GRID  7"),
    (12, "SPC,1,2,3"),
    (13, "SPC = 1"),
    (14, "PSOLID,1"),
    (15, ",2"),
    (17, "CGAP    1"),
]
LEFT_OUT = [
    (2, "$ comment"),
    (3, "  $ another"),
    (6, "grid*   2"),
    (7, "*       3"),
    (8, "CHEXA,2,1,1,2,3,4,5,6,\n7,8"),
    (9, "\t7\t8"),
    (16, "GRID\t3"),
]


@pytest.mark.parametrize(("end", "chunk"), list(product(ENDS, (1, 2**24))))
def test_what_is_left_out_is_beyond_doubt(monkeypatch, end, chunk):
    monkeypatch.setattr("faying.io.line_texts._CHUNK", chunk)
    lines = [line for _, text in sorted(KEPT + LEFT_OUT) for line in text.split("\n")]
    found, numbers = TellingLines(passed_over=("GRID", "CHEXA", "SPC"))(
        (end.join(lines) + end).encode()
    )
    expected = [text for _, text in KEPT]
    assert [line.decode() for line in found] == expected
    np.testing.assert_array_equal(numbers, [1 + lines.index(text) for text in expected])


def test_nothing_is_left_out_where_cards_repeat_others():
    text = b"GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,0.\n=,*1,=,*1.,==\n"
    found, numbers = TellingLines(passed_over=("GRID",))(text)
    assert list(found) == text.splitlines()
    np.testing.assert_array_equal(numbers, [1, 2, 3])
    nothing, numbers = TellingLines(passed_over=("GRID",))(b"")
    assert len(nothing) == len(numbers) == 0
