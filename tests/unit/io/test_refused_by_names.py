"""Decks are refused by the names in them, before the data of what is supported are read."""

import pytest

from faying.exceptions import FormatError
from faying.io.abaqus import read_joint as read_abaqus
from faying.io.nastran import read_joint as read_nastran

# Data that no table could be made of.
NASTRAN = (
    "SOL 101\nCEND\nBEGIN BULK\n$ comment\nCGAP,1,2,3,4\n"
    "GRID,1,,0.,0.,0.\nGRID,2,,a,b,c\nPLSOLID,3,4\nENDDATA\n"
)
ABAQUS = (
    "*HEADING\n*PART, NAME=P\n*NODE\nnothing\n*ELEMENT, TYPE=C3D8\n1, x\n*NGEN\n1, 2\n*END PART\n"
    "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*INSTANCE, NAME=J, PART=P\n"
    "*END INSTANCE\n*END ASSEMBLY\n*SUBMODEL\n"
)
ENDS = ("\n", "\r\n", "\r")


@pytest.mark.parametrize("end", ENDS, ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize(
    ("read", "text", "parts"),
    [
        (read_nastran, NASTRAN, ("2 kinds of cards", "deck:5: CGAP (1)", "deck:8: PLSOLID (1)")),
        (
            read_abaqus,
            ABAQUS,
            ("2 kinds of keywords", "deck:7: *NGEN (2)", "deck:16: *SUBMODEL (1)"),
        ),
    ],
)
def test_decks(tmp_path, end, read, text, parts):
    path = tmp_path / "deck"
    path.write_bytes(text.replace("\n", end).encode())
    with pytest.raises(FormatError) as caught:
        read(path)
    for part in parts:
        assert part in str(caught.value)
