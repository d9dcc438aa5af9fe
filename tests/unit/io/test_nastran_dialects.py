"""Ways of writing a Nastran deck that its programs take: folded lines, DMAP, rounded sections."""

import re

import numpy as np
import pytest

from refusals import refuses
from small_nastran_deck import blocks

BULK = blocks()


@pytest.fixture
def read(nastran):
    def call(*cards, head="", bulk=BULK):
        begin = "BEGIN BULK\n" if head else ""
        return nastran(head + begin + bulk, *cards, "ENDDATA")

    return call


def test_lines_that_end_with_a_comma_go_on_with_data(read):
    """Not a card called 2."""
    many = "".join(f"CHEXA,{100 + i},1,1,2,3,4,5,6\n,7,8\n" for i in range(17))
    folded = "BSURF, 7,1,100,101,102,103,104,\n105,106,107,108,109,110,111,112,\n113,114,115,116"
    mesh = read(folded, bulk=BULK + many).assembly.mesh
    assert mesh.element_sets["bsurf:7"].tolist() == [1, *range(100, 117)]
    # As ever: a line that ends with a comma and stands alone, and one with a mark.
    assert read("BSURF,7,1,2,").assembly.mesh.element_sets["bsurf:7"].tolist() == [1, 2]
    refuses(r"a\.bdf:24: 9: the card is not supported", read, "BSURF,7,1,2", "9,9")


def test_a_coordinate_system_in_one_line(read):
    long = "CORD2C,5,0,1.,2.,3.,1.,2.,4.,2.,2.,3."
    folded = "CORD2C,5,0,1.,2.,3.,1.,2.,4.\n,2.,2.,3."
    point = "GRID,99,5,2.,90.,1."
    places = [read(card, point).assembly.mesh.nodes for card in (long, folded)]
    np.testing.assert_array_equal(*places)
    np.testing.assert_allclose(places[0][-1], [1.0, 4.0, 4.0], atol=1e-12)
    refuses("more than 8 data fields", read, "GRID,99,,1.,0.,0.,,,,9,9")


def test_equations_of_an_optimization_are_no_fields(read):
    cards = ("DEQATN  5       F(A,B,C) = A - B +", "        2.0*C", "DEQATN  6       F(A)=A")
    joint = read(*cards, "GRID,99,,1.,0.,0.")
    assert any("DEQATN" in note for note in joint.assembly.ignored)
    assert 99 in joint.assembly.mesh.node_ids


def test_dmap_in_front_of_cend(read):
    head = (
        "ID A,B\nAPP DMAP\nBEGIN $\nPARAM //C,N,ADD/V,N,X/C,N,1/C,N,2 $\nEND $\nCEND\n"
        "TITLE = A\nPARAM,WTMASS,2.\n"
    )
    joint = read(head=head)
    (material,) = joint.assembly.materials.values()
    assert material.density == pytest.approx(2 * 7.8e-9)


BEAM = (
    "GRID,21,,0.,0.,5.\nGRID,22,,0.,0.,9.\nCBEAM,41,5,21,22,1.,0.,0.\n"
    "PBEAM,5,1,28.2743,63.6173,63.6173,,127.235\n"
)


@pytest.mark.parametrize(
    "end",
    [
        "YESA,1.,28.2743,63.6173,63.6173,,127.235",
        "NO,1.,28.27,63.62,63.62,0.,127.2",  # rounded otherwise
        "YESA,1.,,,,,",
    ],
)
def test_ends_of_a_beam_agree_within_their_digits(read, end):
    beam = read(BEAM + f",{end}").assembly.beams[0]
    assert beam.section.area == 28.2743


@pytest.mark.parametrize("end", ["NO,1.,28.0,63.6173,63.6173,,127.2", "NO,1.,28.2743,63.0"])
def test_tapered_beams_are_refused(read, end):
    refuses(re.escape("tapered beams are not supported"), read, BEAM + f",{end}")


def test_offsets_of_no_mass_move_nothing(read):
    ends = "\n,YESA,1.\n,1.,1.\n,.5,.5"
    cards = [*BEAM.splitlines()[:3], "PBEAM,5,1,28.,63.,63.,,127."]
    assert read(*cards[:-1], cards[-1] + ends).assembly.beams[0].section.area == 28.0
    refuses("an offset of mass", read, *cards[:-1], cards[-1] + ",2." + ends)
    refuses("an offset of the neutral axis", read, *cards[:-1], cards[-1] + ends + ",,,.5")


def test_sections_by_dimensions_agree_within_their_digits(read):
    beam = BEAM.splitlines()[:3]
    card = "PBEAML,5,1,,TUBE\n,3.,1.99,,YES,1.,3.001,1.99"
    assert read(*beam, card).assembly.beams[0].section.area == pytest.approx(np.pi * (9 - 1.99**2))
    refuses("changes along the beam", read, *beam, card.replace("3.001", "3.01"))


def test_materials_that_no_property_names_are_left_out(read):
    """Libraries come with decks; what is in them need not be isotropic, or complete."""
    library = (
        "MAT9,50,1.,2.,3.,4.,5.,6.,7.\n,8.,9.,10.,11.,12.,13.,14.,15.",
        "MAT1,51,1.",
        "MATS1,51,,PLASTIC,0.,1,1,200.",
        "MAT8,52,1.,2.,.3",
    )
    notes = read(*library).assembly.ignored
    for name in ("MAT9", "MATS1", "MAT8"):
        assert f"1 {name} that no property uses" in notes
    refuses("MATS1: the card is not supported", read, "MATS1,1,,PLASTIC,0.,1,1,200.")
    refuses(r"MAT9: material 50: .* stable material", read, *library, "PSOLID,9,50")
    refuses("material 51 has 0 of E, G, NU", read, "MAT1,51", "PSOLID,9,51")


def test_cards_are_made_of_the_card_above(read):
    """Repeated fields, fields that count on, and lines that repeat this."""
    made = read("GRID,101,,.5,1.,0.,,456", "=,*2,=,*.25,*1,==", "=3", "GRID,201,,7.", "=,*1,==")
    ids, nodes = made.assembly.mesh.node_ids, made.assembly.mesh.nodes
    here = np.isin(ids, np.arange(101, 110, 2))
    np.testing.assert_array_equal(nodes[here, 0], [0.5, 0.75, 1.0, 1.25, 1.5])
    np.testing.assert_array_equal(nodes[here, 1], [1.0, 2.0, 3.0, 4.0, 5.0])
    assert 202 in ids
    (held,) = [one for one in made.assembly.supports if one.components == (3, 4, 5)]
    assert len(held.nodes) == 5
    fixed = "GRID         101              .5      1.      0.             456"
    line = "=       *2      =       *.25    *(1)    =="
    other = read(fixed, line, "=(3)").assembly.mesh
    np.testing.assert_array_equal(other.nodes[-5:], nodes[here])


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (("GRID,101,,1.", "=,*X,=="), "'X' is not a number to add to"),
        (("GRID,101,,1.", "=2"), "there is none above"),
        (("GRID,101,,1.", "=,*1,==", "=9999999"), "it may up to 1000000 times"),
        (
            ("GRID         101              1.", "=       *1      ==", "=(999999999)"),
            "1000000 times",
        ),
        (("GRID,101,,1.", "=,*(1,=="), "'*(1' cannot be added"),
        (("GRID         101              1.", "=       *(1000000)=="), "cannot be added"),
        (("GRID,101,,1.", "=X"), "'=X' is not a card name"),
        (("GRID,101,,1.", "=,*1,==", ",7"), "a repeated card with a second line"),
        (("CHEXA,7,1,1,2,3,4,5,6\n,7,8", "=,*1,=="), "the card above has several lines"),
        (("SET1,7,1,2", "=,*1,=,*X"), "not a number to add to"),
    ],
)
def test_repetitions_that_are_refused(read, lines, message):
    refuses(re.escape(message), read, *lines)


def test_a_line_of_repetition_needs_a_card(read):
    refuses(r"a\.bdf:1: a line of '=' without a card above it", read, bulk="=,*1,==\n" + BULK)


def test_blanks_separate_the_name_from_its_id(read):
    assert 99 in read("GRID      99,,1.,2.,3.").assembly.mesh.node_ids
    refuses("write points for decimal commas", read, "GRID          99       1,5     2.")


def test_marks_of_continuations_begin_behind_their_first_column(read):
    first = "CONM2   7       1       0       5.                                      PART"
    turning = "CELAS2,9,7.,1,4"
    assert read(turning, first, "+ART    2.").assembly.masses[0].inertia[0][0] == 2.0
    refuses("does not belong to the line above", read, first, "+ARM    2.")


def test_rotors_do_not_turn_and_are_named(read):
    notes = read("ROTORG,5,1,THRU,4", "RSPINR,5,1,2").assembly.ignored
    assert "1 ROTORG, 1 RSPINR: rotors do not rotate: no gyroscopic terms" in notes
    refuses("CBEAR", read, "CBEAR,9,1,1,2")
