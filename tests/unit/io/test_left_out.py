"""What readers of decks leave out, on their own or when asked to, and how they refuse the rest."""

import pytest

import faying as fy
from faying.exceptions import FayingError, FormatError
from faying.io.abaqus import read_joint
from faying.io.left_out import IGNORABLE
from faying.io.nastran import read_joint as read_nastran_joint
from faying.study.keys.schema import parse_study
from small_abaqus_deck import DECK

PLASTIC = DECK.replace("*DENSITY\n", "*PLASTIC\n300., 0.\n*DENSITY\n", 1)
MEMBRANES = "*ELEMENT, TYPE=M3D4\n9, 1, 2, 3, 4\n*ELEMENT, TYPE=M3D4\n10, 5, 6, 7, 8\n"


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "deck.inp"

    def write(text):
        path.write_text(text)
        return path

    return write


def test_everything_refused_is_told_at_once_under_what_to_do(deck):
    text = PLASTIC.replace(
        "*MATERIAL",
        MEMBRANES + "*MEMBRANE SECTION, ELSET=X, MATERIAL=M\n1.\n*NGEN\n1, 2\n*MATERIAL",
        1,
    )
    with pytest.raises(FormatError) as caught:
        read_joint(deck(text))
    heading, *lines = str(caught.value).splitlines()
    assert heading.endswith(
        "deck.inp: 4 kinds of keywords are not supported and may change the structure:"
    )
    membranes = lines.index("  give S3, S4, S6 or S8 with *SHELL SECTION of one layer, or solids:")
    # Both under one remedy, with their number and the line of the first.
    assert lines[membranes + 1].endswith("deck.inp:44: *ELEMENT, TYPE=M3D4 (2)")
    assert lines[membranes + 2].endswith("deck.inp:48: *MEMBRANE SECTION (1)")
    assert any("*NGEN (1)" in line for line in lines)
    asked = next(line for line in lines if "ignore = " in line)
    assert 'ignore = ["plastic"]: materials stay linear elastic' in asked


def test_what_changes_the_structure_is_left_out_when_asked_to(deck):
    path = deck(PLASTIC)
    with pytest.raises(FormatError, match=r"deck\.inp:47: \*PLASTIC: .*ignore = "):
        read_joint(path)
    found = read_joint(path, ignore=["plastic"]).assembly
    assert f"1 *PLASTIC: {IGNORABLE['plastic']} (ignore = plastic)" in found.ignored
    (material,) = set(found.materials.values())
    assert (material.youngs_modulus, material.density) == (210000.0, 7.85e-9)
    model = fy.read_abaqus(path, ignore=["plastic"])
    assert "Joint" in model.interfaces
    with pytest.raises(FormatError, match="PLASTIC"):
        fy.read_abaqus(path, ignore=["friction"])


def test_friction_is_left_out_when_asked_to(deck):
    text = DECK.replace("*CONTACT PAIR", "*FRICTION\n0.2, 1.E5\n*CONTACT PAIR", 1)
    joint = read_joint(deck(text), ignore=["friction"])
    assert any(note.startswith("*FRICTION: surfaces that touch") for note in joint.assembly.ignored)


def test_damping_is_left_out_with_what_that_means(deck):
    text = DECK.replace(
        "*MATERIAL",
        "*ELEMENT, TYPE=DASHPOTA, ELSET=D\n70, 1, 2\n*DASHPOT, ELSET=D\n\n5.\n*MATERIAL",
        1,
    ).replace("*DENSITY\n", "*DAMPING, ALPHA=5.\n*DENSITY\n", 1)
    found = read_joint(deck(text)).assembly
    plain = read_joint(deck(DECK)).assembly
    assert any(note.startswith("1 *DASHPOT, 1 *DAMPING: damping: ") for note in found.ignored)
    assert (found.springs, found.masses) == (plain.springs, plain.masses)


def test_words_that_mean_nothing_are_refused(deck):
    for read in (read_joint, read_nastran_joint):
        with pytest.raises(
            FormatError, match="ignore: 'plasti' is unknown; expected some of plastic"
        ):
            read(deck(DECK), ignore=["plasti"])


def test_cards_of_nastran_are_refused_at_once_too(tmp_path):
    path = tmp_path / "deck.bdf"
    path.write_text("GRID,1\nCDUM3,5\nMATS1,1,,PLASTIC,0.,1,1,200.\nPSOLID,2,1\nMAT1,1,1.,,.3\n")
    with pytest.raises(FormatError) as caught:
        read_nastran_joint(path)
    text = str(caught.value)
    assert "2 kinds of cards are not supported" in text
    assert f"{path}:2: CDUM3 (1)" in text
    assert f"{path}:3: MATS1 (1)" in text


STUDY = """\
[model]
source = "abaqus"
file = "deck.inp"
ignore = ["plastic"]
"""


def test_the_key_of_studies(deck):
    path = deck(PLASTIC).with_name("study.toml")
    assert parse_study(STUDY, path).model.ignore == ("plastic",)
    with pytest.raises(FayingError, match=r"'plastik'.*plastic"):
        parse_study(STUDY.replace("plastic", "plastik"), path)
    mesh = STUDY.replace('"abaqus"', '"mesh"')
    with pytest.raises(FayingError, match="source 'mesh' is not a deck"):
        parse_study(mesh, path)


def test_what_a_substructure_is_made_of_changes_no_structure(deck):
    """Decks that write matrices of a joint for reduction (Brake-Reuß by Abaqus) have these."""
    names = ("SELECT EIGENMODES", "DAMPING CONTROLS", "SUBSTRUCTURE LOAD CASE")
    plain = read_joint(deck(DECK)).assembly
    lines = "*SELECT EIGENMODES, GENERATE\n1, 20, 1\n*DAMPING CONTROLS\n"
    lines += "*SUBSTRUCTURE LOAD CASE, NAME=A\n"
    told = read_joint(deck(DECK.replace("*END STEP", lines + "*END STEP", 1))).assembly
    assert all(any(f"1 *{name}" in note for note in told.ignored) for name in names)
    assert set(told.loads) == set(plain.loads)
    assert [block.nodes.tolist() for block in told.mesh.blocks] == [
        block.nodes.tolist() for block in plain.mesh.blocks
    ]
