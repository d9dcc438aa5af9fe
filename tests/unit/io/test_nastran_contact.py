"""Contact definitions and bolts of decks in both dialects."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError
from faying.io.nastran import read_joint
from faying.model.description import JointDescription
from refusals import refuses

# Two unit cubes on top of each other, nodes 1-8 and 11-18; a beam 91-92 beside them.
CUBES = "".join(
    f"GRID,{first + i},,{x},{y},{z + level}\n"
    for first, level in ((1, 0.0), (11, 1.0))
    for i, (x, y, z) in enumerate(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    )
)
MODEL = (
    CUBES
    + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,2,11,12,13,14,15,16\n,17,18\n"
    + "PSOLID,1,9\nPSOLID,2,9\nMAT1,9,210000.,,.3,7.8-9\n"
    + "GRID,91,,3.,0.,0.\nGRID,92,,3.,0.,1.\nGRID,93,,3.,0.,2.\n"
    + "CBAR,71,50,91,92,1.,0.,0.\nCBAR,72,50,92,93,1.,0.,0.\nPBAR,50,9,1.,1.,1.,1.\n"
)
FACES = "BSURFS,5,,,,1,5,6,7\nBSURFS,6,,,,2,11,13,12\n"
SIMCENTER = FACES + "BCTSET,4,5,6,0.,,2.\n"
BODIES = "BCPROP,31,1\nBSURF,32,2\nBCBODY1,7,,3D,DEFORM,31\nBCBODY,8,3D,DEFORM,32\n"
MSC = BODIES + "BCTABL1,9,3\nBCONECT,3,,,7,8\n"
BOLT = "BOLT,1,1,71,72\nBOLTFOR,3,5000.,1\n"
Read = Callable[..., JointDescription]


@pytest.fixture
def read(nastran) -> Read:
    def run(*cards: str, control: str | None = None, subcase: int | None = None):
        head = "" if control is None else f"SOL 101\nCEND\n{control}\nBEGIN BULK\n"
        return nastran(head + MODEL, *cards, subcase=subcase)

    return run


def sides(joint: JointDescription):
    return [(spec.name, spec.minus, spec.plus) for spec in joint.interfaces]


def test_simcenter_pair_of_faces(read: Read) -> None:
    joint = read(SIMCENTER, "BCTPARM,4,PENN,10.,PENT,1.,CTOL,.01,\n,MAXF,20")
    assert sides(joint) == [("contact-5-6", "bsurfs:5", "bsurfs:6")]
    # Counter-clockwise seen from outside: the top of the lower, the bottom of the upper cube.
    assert joint.assembly.face_sets["bsurfs:5"][:, :4].tolist() == [[4, 5, 6, 7]]
    assert joint.assembly.face_sets["bsurfs:6"][:, :4].tolist() == [[8, 11, 10, 9]]
    notes = joint.assembly.ignored
    assert "BCTPARM PENN, PENT, CTOL, MAXF (the study's penalty and tolerance count)" in notes
    assert [spec.gap for spec in joint.interfaces] == [None]
    # MAXD is the search distance; without it any gap is searched.
    assert joint.interfaces[0].search_distance == 2.0
    assert read(FACES, "BCTSET,4,5,6").interfaces[0].search_distance == np.inf


def test_simcenter_selection_follows_case_control(read: Read) -> None:
    cards = (SIMCENTER, "BCTSET,44,31,6", "BCPROP,31,1", "BCTADD,8,4")
    assert len(read(*cards).interfaces) == 2
    assert sides(read(*cards, control="BCSET = 44")) == [("contact-31-6", "bcprop:31", "bsurfs:6")]
    assert [name for name, *_ in sides(read(*cards, control="BCSET = 8"))] == ["contact-5-6"]
    nothing = read(*cards, control="")
    assert nothing.interfaces == ()
    assert "contact sets 4, 44, 8 (case control selects none by BCSET)" in nothing.assembly.ignored
    subcases = "BCSET = 4\nSUBCASE 1\nSUBCASE 2\n BCSET = 44"
    assert [name for name, *_ in sides(read(*cards, control=subcases))] == ["contact-5-6"]
    second = read(*cards, control=subcases, subcase=2)
    assert [name for name, *_ in sides(second)] == ["contact-31-6"]
    with pytest.raises(FormatError, match="selects BCSET = 5, but the contact sets are 4, 44, 8"):
        read(*cards, control="BCSET = 5")
    refuses("no subcase 3; subcases are 1, 2", read, *cards, control=subcases, subcase=3)


def test_rows_of_one_set_are_pairs(read: Read) -> None:
    more = "BSURFS,51,,,,1,1,2,6\nBSURFS,61,,,,2,11,12,16\n"
    joint = read(FACES, more, "BCTSET,4,5,6,0.\n,,51,61,0.")
    assert [name for name, *_ in sides(joint)] == ["contact-5-6", "contact-51-61"]


def test_msc_tables(read: Read) -> None:
    expected = [("contact-7-8", "bcprop:31", "bsurf:32")]
    assert sides(read(MSC)) == expected
    assert sides(read(MSC, control="BCONTACT = 9")) == expected
    assert sides(read(BODIES, "BCONECT,3,,,7,8", control="BCONTACT = 3")) == expected
    lists = "BCONECT,3\n,SECNDRY,7\n,PRIMARY,8"
    assert sides(read(BODIES, lists, control="BCONTACT = 3")) == expected
    short = "BCTABLE,0,7,8,0\nBCTABLE,2,7,8"
    joint = read(BODIES, short, control="BCONTACT = 2")
    assert sides(joint) == expected
    assert any("BCTABLE 0" in note for note in joint.assembly.ignored)
    long = (
        "BCTABLE,2,,,2\n,SLAVE,7,.01,,0.,0.,0\n,,0,0,0\n,,FBSH,1.+20,.9\n,MASTERS,8\n"
        ",SECNDRY,8\n,PRIMARY,7"
    )
    joint = read(BODIES, long, control="BCONTACT = 2")
    assert sides(joint) == expected
    assert any("both orders" in note for note in joint.assembly.ignored)
    for nothing in ("NONE", "0"):
        assert read(MSC, control=f"BCONTACT = {nothing}").interfaces == ()
    unused = read(MSC, control="LOAD = 1")
    assert unused.interfaces == ()
    assert any("selects none by BCONTACT" in note for note in unused.assembly.ignored)


def test_sides_of_bricks_as_contact_bodies(read: Read) -> None:
    """MSC's BCSURF; glued by it a deck of ten bodies of MSC's moves 2 % less than in its op2."""
    surfaces = "BCSURF,7,,3D,,FACE\n,1,S2,ELEM\nBCSURF,8,,3D,,FACE\n,2,S1,ELEM\n"
    pairs = "BCTABL1,9,3\nBCONECT,3,,,7,8\n"
    joint = read(surfaces + pairs)
    assert sides(joint) == [("contact-7-8", "bcsurf:7", "bcsurf:8")]
    assert set(joint.assembly.face_sets["bcsurf:7"][:, :4].ravel()) == {4, 5, 6, 7}
    assert set(joint.assembly.face_sets["bcsurf:8"][:, :4].ravel()) == {8, 9, 10, 11}
    for change, message in (
        (("1,S2", "1,S7"), "'1, S7, ELEM'; supported are rows of a CHEXA"),
        (("1,S2", "99,S2"), "element 99 is not a CHEXA"),
        (("FACE", "NODE"), "after FACE"),
    ):
        refuses(message, read, surfaces.replace(*change) + pairs)


def friction(joint: JointDescription) -> float:
    (spec,) = joint.interfaces
    noted = any(note.startswith("stick stiffness of friction") for note in joint.assembly.ignored)
    assert noted == (spec.friction > 0)
    assert spec.tangential_penalty == "auto"
    return spec.friction


def test_friction_is_left_out_when_asked_to(read: Read, tmp_path: Path) -> None:
    assert friction(read(FACES, "BCTSET,4,5,6,.15")) == 0.15
    joint = read_joint(tmp_path / "a.bdf", ignore=["friction"])
    assert [spec.friction for spec in joint.interfaces] == [0.0]
    assert any(note.startswith("coefficients of friction: ") for note in joint.assembly.ignored)


def test_coefficients_of_friction_become_those_of_the_interfaces(read: Read) -> None:
    assert friction(read(FACES, "BCTSET,4,5,6,.15")) == 0.15
    table = "BCTABLE,2,,,1\n,SLAVE,7,,,.2\n,MASTERS,8"
    assert friction(read(BODIES, table, control="BCONTACT = 2")) == 0.2
    pair = (BODIES, "BCONECT,3,,5,7,8", "BCONPRP,5,,FRIC,.3")
    assert friction(read(*pair, control="BCONTACT = 3")) == 0.3
    assert friction(read(*pair, "BCPARA,0,FTYPE,6", control="BCONTACT = 3")) == 0.3
    off = read(*pair, "BCPARA,0,FTYPE,0", control="BCONTACT = 3")
    assert friction(off) == 0.0
    assert any("FTYPE = 0 on BCPARA" in note for note in off.assembly.ignored)
    both = MSC.replace("BCBODY1,7,,", "BCBODY1,7,5,").replace("DEFORM,32", "DEFORM,32,,.25")
    assert friction(read(both, "BCBDPRP,5,FRIC,.25")) == 0.25
    everything = both.replace("BCTABL1,9,3\nBCONECT,3,,,7,8\n", "BCBDPRP,5,FRIC,.25")
    assert friction(read(everything, control="BCONTACT = ALLBODY")) == 0.25


FRICTION = "faying reads one Coulomb coefficient a pair"
REFUSED = [
    ((FACES, "BCTSET,4,5,6,3"), f"FRIC = 3 is the id of a table; {FRICTION}"),
    ((FACES, "BCTSET,4,5,6,-.1"), "FRIC = -.1 is not a coefficient from 0 to 10"),
    ((FACES, "BCTSET,4,5,6,,.1"), "MIND"),
    ((FACES, "BCTSET,4,5,7"), "contact region 7 is not in the deck"),
    ((FACES, "BCTSET,4,5,5"), "in contact with itself"),
    ((FACES, "BCTSET,4,5,6", "BCTSET,7,6,5"), "already defined at .* count twice"),
    ((FACES, "BCTSET,4,5,6,,,,7"), "follows MAXD"),
    ((FACES, "BCTSET,4,5,6\n,51,61"), "leave that field blank"),
    ((SIMCENTER, "BCTPARM,4,FRICMOD,2"), FRICTION),
    ((SIMCENTER, "BCTPARM,4,OFFSET,.1"), "OFFSET = .1 is not supported; give"),
    ((SIMCENTER, "BCTPARM,4,10.,PENN"), "is not a parameter and its value"),
    ((SIMCENTER, "BCTPARA,4,TIED,7"), "TIED = 7 is not supported; give one of 0, 1, 2, 3, 4"),
    ((SIMCENTER, "BCRPARA,5,TOP,.2"), "OFFSET of a contact region"),
    ((SIMCENTER, "BCRPARA,6,TOP,,RIGID"), "TYPE = 'RIGID'"),
    ((SIMCENTER, "BGSET,1,5,6"), "already defined at .* count twice"),
    ((FACES, "BGSET,1,5,9"), "contact region 9 is not in the deck"),
    ((FACES, "BGSET,1,5,6\n,51,61"), "leave that field blank"),
    ((FACES, "BGSET,1,5,6", "BGADD,2,3"), "glue set 3 is not in the deck.*BGSET"),
    ((FACES, "BSURF,5,1"), "contact region 5 is already defined"),
    ((FACES, "BCPROP,7,55", "BCTSET,4,7,6"), "no solid of the deck belongs"),
    (("BSURFS,5,,,,1,5,6,3",), "are not three corners of one face of element 1"),
    (("BSURFS,5,,,,1,5,6",), "not an element id with three grid ids"),
    (("BSURFS,5,,,,3,5,6,7",), "element 3 is not a solid"),
    (("BSURFS,5,,,,1,5,6,99",), "GRID 99 is not in the deck"),
    (("BCONP,5,1,2",), "BCONP: the card is not supported"),
    ((BODIES, "BCONECT,3,,5,7,8", "BCONPRP,5,,FRIC,30."), "FRIC = 30. is not a coefficient"),
    (
        (BODIES, "BCONECT,3,,5,7,8", "BCONPRP,5,,FRIC,.3", "BCPARA,0,FTYPE,7"),
        f"FTYPE = 7: {FRICTION}",
    ),
    ((BODIES, "BCONECT,3,5,,7,8", "BCONPRG,5,,IGLUE,9"), "BCONPRG: IGLUE = 9"),
    ((BODIES, "BCONECT,3,5,,7,8", "BCONPRG,5,,JGLUE,1"), "glue that breaks"),
    ((BODIES, "BCONECT,3,5,,7,8", "BCONPRG,5,,CINTERF,.1"), "give 'initial_gap' in the study"),
    ((BODIES, "BCONECT,3,5,,7,8"), "BCONPRG 5 is not in the deck"),
    ((BODIES, "BCONECT,3,,,7,9"), "contact body 9 is not in the deck.*BCBODY"),
    ((BODIES, "BCONECT,3,,,7"), "no primary"),
    ((BODIES, "BCTABL1,9,3"), "BCONECT 3 is not in the deck"),
    ((BODIES, "BCTABLE,2,,,1\n,SLAVE,7,,,77.\n,MASTERS,8"), "FRIC = 77. is not a coefficient"),
    ((BODIES, "BCTABLE,2,,,1\n,SLAVE,7,,,,,1\n,,,,1\n,MASTERS,8"), "glue that breaks"),
    ((BODIES, "BCTABLE,2,,,2\n,SLAVE,7\n,MASTERS,8"), "NGROUP = 2, but it has 1"),
    ((BODIES, "BCTABLE,2,,,1\n,SLAVE,7\n,NONSENSE,8"), "occurs where SECNDRY"),
    ((MSC.replace("DEFORM,31", "RIGID,31"),), "BEHAV = 'RIGID'"),
    ((MSC.replace("DEFORM,32", "DEFORM,32,,.3"),), "bodies 7 and 8 have coefficients of friction"),
    ((MSC.replace("3D", "2D"),), "DIM = '2D'"),
    ((MSC.replace("BCTABL1,9,3", "BCTABL1,9,3,4"), "BCONECT,4,,,7,8"), "count twice"),
    (("BOLT,1,2,0,3,5,6",), "no faces between solids of the shank"),
    (("BOLT,1,3,0,3,5",), "no elements; list the solids of the shank"),
    (("BOLT,1,1\n,TOP,5,6\n,BOTTOM,15,16",), "control grid 1 has no force"),
    (("BOLT,1,1,71,99",), "element 99 is not a CBAR"),
    (("BOLT,1,1",), "no elements"),
    ((BOLT, "BOLTFOR,3,1.,2"), "bolt 2 is not in the deck.*BOLT"),
    ((BOLT, "BOLTFOR,3,1.,1"), "two forces in set 3"),
    ((BOLT, "BOLTFRC,3,STRAIN,.001,1"), "BOLTFRC: it is not supported"),
    ((BOLT, "BOLTSEQ,3"), "BOLTSEQ"),
    ((BOLT, "BOLTLD,7,1.,1.,4"), "set 4 is not in the deck.*BOLTFOR"),
]


@pytest.mark.parametrize(("cards", "message"), REFUSED, ids=lambda value: str(value)[-40:])
def test_what_changes_the_physics_is_refused_by_name(read: Read, cards, message) -> None:
    with pytest.raises(FormatError, match=message) as caught:
        read(*cards)
    assert "a.bdf:" in str(caught.value)


def test_glue_and_tables_that_are_not_selected_do_no_harm(read: Read) -> None:
    joint = read(SIMCENTER, "BGSET,1,5,6", control="BCSET = 4")
    assert any("BGSET" in note for note in joint.assembly.ignored)
    refuses("count twice", read, SIMCENTER, "BGSET,1,5,6", control="BCSET = 4\nBGSET = 1")
    with pytest.raises(FormatError, match="selects BGSET = 3, but the glue sets are 1, 2"):
        read(FACES, "BGSET,1,5,6", "BGADD,2,1", control="BGSET = 3")
    refuses("BCONTACT = AUTO", read, MSC, control="BCONTACT = AUTO,PGLUE")
    refuses("selects BCONTACT = 4", read, MSC, control="BCONTACT = 4")


def test_contact_of_all_bodies_finds_what_touches(read: Read) -> None:
    (spec,) = read(BODIES, control="BCONTACT = ALLBODY").interfaces
    assert (spec.name, spec.minus, spec.plus) == ("contact", "auto", "auto")
    with pytest.raises(FormatError, match="element 2 belongs to no contact body"):
        read("BCPROP,31,1\nBCBODY1,7,,3D,DEFORM,31", control="BCONTACT = ALLBODY")
    with pytest.raises(FormatError, match="BEHAV = 'SYMM'"):
        read(BODIES.replace("DEFORM,31", "SYMM,31"), control="BCONTACT = ALLBODY")


LIFTED = MODEL.replace("GRID,11,,0,0,1.0", "GRID,11,,0,0,1.001")


@pytest.mark.parametrize(
    ("cards", "lowest"),
    [
        ((SIMCENTER,), 0.001),
        ((SIMCENTER, "BCTPARM,4,INIPENE,1"), 0.001),
        ((SIMCENTER, "BCTPARM,4,INIPENE,2"), 0.001),
        ((SIMCENTER, "BCTPARM,4,INIPENE,3"), 0.0),
        ((BODIES, "BCTABL1,9,3\nBCONECT,3,1,,7,8\nBCONPRG,1,,ICOORD,1"), 0.0),
        ((BODIES, "BCTABL1,9,3\nBCONECT,3,1,,7,8\nBCONPRG,1,,ICOORD,1,ERROR,1.-4"), 0.001),
        ((BODIES, "BCTABL1,9,3\nBCONECT,3,1,,7,8\nBCONPRG,1,,ICOORD,2"), 0.001),
        ((BODIES, "BCPARA,0,ERROR,1.-4\nBCTABLE,2,,,1\n,SLAVE,7,,,0.\n,,0,1,0\n,MASTERS,8"), 0.001),
        ((BODIES, "BCTABLE,2,,,1\n,SLAVE,7,.01,,0.\n,,0,1,0\n,MASTERS,8"), 0.0),
    ],
)
def test_gaps_are_closed_as_the_deck_says(tmp_path: Path, cards, lowest) -> None:
    """One node of four stands 0.001 off; INIPENE resets gaps, ICOORD those within ERROR."""
    assert LIFTED != MODEL
    path = tmp_path / "apart.bdf"
    path.write_text(LIFTED + "\n".join(cards))
    (interface,) = fy.read_nastran(path).interfaces.values()
    assert interface.area == pytest.approx(1.0, rel=1e-6)  # the tilt of one corner
    at_corner = interface.point_shape[:, interface.pairs[:, 0] == 4].toarray()[:, 0]
    np.testing.assert_allclose(interface.initial_gap, lowest * at_corner, atol=1e-9)


def test_penetrations_are_reset(tmp_path: Path) -> None:
    sunk = MODEL.replace("GRID,11,,0,0,1.0", "GRID,11,,0,0,0.999")
    path = tmp_path / "sunk.bdf"
    for value, lowest in ((1, -0.001), (2, 0.0)):
        path.write_text(sunk + SIMCENTER + f"BCTPARM,4,INIPENE,{value}\n")
        (interface,) = fy.read_nastran(path).interfaces.values()
        at_corner = interface.point_shape[:, interface.pairs[:, 0] == 4].toarray()[:, 0]
        np.testing.assert_allclose(interface.initial_gap, lowest * at_corner, atol=1e-9)
    path.write_text(sunk + SIMCENTER + "BCTPARM,4,INIPENE,7\n")
    refuses("INIPENE = 7 is not supported; give one of 0, 1, 2, 3", read_joint, path)


def test_triangles_and_quadrilaterals_in_one_region(tmp_path: Path) -> None:
    """A brick beside a wedge, both below a brick and a wedge: the region has faces of two kinds."""
    lower = "GRID,9,,2.,0.,0.\nGRID,10,,2.,0.,1.\nCPENTA,3,1,2,9,3,6,10,7\n"
    text = MODEL + lower + "BSURFS,5,,,,1,5,6,7\n,3,6,10,7\nBCTSET,4,5,6\nBSURFS,6,,,,2,11,12,13\n"
    path = tmp_path / "a.bdf"
    path.write_text(text)
    joint = read_joint(path)
    assert sides(joint) == [("contact-5-6", "bsurfs:5", "bsurfs:6")]
    faces = joint.assembly.face_sets["bsurfs:5"]
    assert [set(joint.assembly.mesh.node_ids[row[row >= 0]].tolist()) for row in faces] == [
        {5, 6, 7, 8},
        {6, 7, 10},
    ]
    # Not in contact, it is a set to be named in a study.
    path.write_text(text.replace("BCTSET,4,5,6\n", ""))
    np.testing.assert_array_equal(read_joint(path).assembly.face_sets["bsurfs:5"], faces)
    # The side between them has no nodes but those of the region, which is not the side.
    path.write_text(text.replace("BSURFS,5,,,,1,5,6,7", "BSURFS,5,,,,1,5,6,7\n,1,2,3,1"))
    assert len(read_joint(path).assembly.face_sets["bsurfs:5"]) == 3
    path.write_text(text.replace("BSURFS,5,,,,1,5,6,7", "BSURFS,5,,,,1,2,3,7"))
    refuses("inside a body", read_joint, path)


def test_bolts_and_their_forces(read: Read) -> None:
    joint = read(BOLT)
    assert [(b.name, b.elements) for b in joint.bolts] == [("bolt-1", (71, 72))]
    assert joint.preloads == {"bolt-1": 5000.0}
    sets = ("BOLT,1,1,71,THRU,72", "BOLTFOR,3,5000.,1", "BOLTFOR,4,70.,1", "BOLTLD,9,2.,1.,3,.5,4")
    assert read(*sets, control="BOLTLD = 4").preloads == {"bolt-1": 70.0}
    assert read(*sets, control="BOLTLD = 9").preloads == {"bolt-1": 2 * (5000 + 0.5 * 70)}
    unloaded = read(*sets, control="")
    assert len(unloaded.bolts) == 1
    assert unloaded.preloads == {}
    assert any("selects none by BOLTLD" in note for note in unloaded.assembly.ignored)
    assert read(*sets).preloads == {}
    refuses("selects BOLTLD = 5, but the sets", read, *sets, control="BOLTLD = 5")


PRESSURES = (
    "".join(
        f"GRID,{i},,{x},{y},{z}\n"
        for i, x, y, z in [
            *((1, 0.0, 0.0, 0.0), (2, 2.0, 0.0, 0.0), (3, 2.0, 1.0, 0.0), (4, 0.0, 1.0, 0.0)),
            *((5, 0.0, 0.0, 3.0), (6, 2.0, 0.0, 3.0), (7, 2.0, 1.0, 3.0), (8, 0.0, 1.0, 3.0)),
        ]
    )
    + "MAT1,9,210000.,,.3,7.8-9\nPSOLID,1,9\n"
)
HEXA = "CHEXA,1,1,1,2,3,4,5,6\n,7,8\n"
PENTA = "CPENTA,1,1,1,2,3,5,6,7\n"
ALONG_X = "CORD2R,3,,0.,0.,0.,1.,0.,0.\n,0.,1.,0."
TETRA = "CTETRA,1,1,1,2,3,5\n"


@pytest.mark.parametrize(
    ("element", "load", "force"),
    [
        # Inward on the top (area 2), on the side y = 0 (area 6), on triangles (area 1 and 3).
        (HEXA, "PLOAD4,1,1,5.,,,,5,7", (0, 0, -10)),
        (HEXA, "PLOAD4,1,1,5.,,,,6,8", (0, 0, -10)),
        (HEXA, "PLOAD4,1,1,5.,,,,1,6", (0, 30, 0)),
        (PENTA, "PLOAD4,1,1,5.,,,,7", (0, 0, -5)),
        (PENTA, "PLOAD4,1,1,5.,,,,1,6", (0, 30, 0)),
        (TETRA, "PLOAD4,1,1,5.,,,,1,5", (0, 0, 5)),
        (TETRA, "PLOAD4,1,1,5.,,,,1,3", (0, 15, 0)),
        # A traction along (0, 3, 4) / 5, and one along the axis of a turned system.
        (HEXA, "PLOAD4,1,1,5.,,,,5,7\n,,0.,3.,4.", (0, 6, 8)),
        (HEXA, f"{ALONG_X}\nPLOAD4,1,1,5.,,,,5,7\n,3,0.,0.,2.", (10, 0, 0)),
        # Mean of four corner values on a rectangle.
        (HEXA, "PLOAD4,1,1,1.,2.,3.,6.,5,7", (0, 0, -6)),
    ],
)  # fmt: skip
def test_pressures_push_with_the_right_force(tmp_path: Path, element, load, force) -> None:
    path = tmp_path / "a.bdf"
    path.write_text(PRESSURES + element + load + "\n")
    loads = read_joint(path).assembly.loads["1"]
    np.testing.assert_allclose(loads.forces[:, :3].sum(axis=0), force, atol=1e-14)


def test_corner_intensities_follow_the_right_hand_rule_from_g1(tmp_path: Path) -> None:
    """All load at one corner: ∫ N_a N_b dA of a rectangle is A/9, A/18, A/36."""
    path = tmp_path / "a.bdf"
    for first, opposite, second in ((5, 7, 6), (6, 8, 7), (7, 5, 8)):
        path.write_text(PRESSURES + HEXA + f"PLOAD4,1,1,0.,1.,0.,0.,{first},{opposite}\n")
        loads = read_joint(path).assembly.loads["1"]
        heaviest = loads.nodes[np.abs(loads.forces[:, 2]).argmax()] + 1
        assert heaviest == second
        shares = np.sort(-loads.forces[:, 2])
        np.testing.assert_allclose(shares, [2 / 36, 2 / 18, 2 / 18, 2 / 9], rtol=1e-14)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ("PLOAD4,1,2,5.,,,,5,7", "element 2 is not a solid"),
        ("PLOAD4,1,1,5.,,,,5,6", "name no face of element 1"),
        ("PLOAD4,1,1,5.,,,,5", "name no face of element 1"),
        ("PLOAD4,1,1,5.,,,,THRU,3", "no shell that takes a pressure is among elements 1 to 3"),
        ("PLOAD4,1,1,5.,,,,5,7\n,4,1.", "coordinate system 4 is not"),
        ("PLOAD4,1,1,5.,,,,5,7\n,0", "has no length"),
        ("PLOAD4,1,1,,,,,5,7", r"field 4 \(P1\) holds nothing"),
    ],
)
def test_pressures_that_make_no_sense(tmp_path: Path, load, message) -> None:
    path = tmp_path / "a.bdf"
    path.write_text(PRESSURES + HEXA + load + "\n")
    refuses(message, read_joint, path)


def test_ranges_with_steps(read: Read) -> None:
    joint = read("BSURF,5,1,THRU,7,BY,2")
    assert joint.assembly.mesh.element_sets["bsurf:5"].tolist() == [1]
    refuses("BY 0", read, "BSURF,5,1,THRU,7,BY,0")


def test_combinations_of_subcases(read: Read) -> None:
    control = "SUBCASE 1\n BOLTLD = 3\nSUBCOM 2\n SUBSEQ = 1.,1.\n"
    joint = read(BOLT, control=control)
    assert joint.preloads == {"bolt-1": 5000.0}
    assert any("SUBCOM 2" in note for note in joint.assembly.ignored)
    with pytest.raises(FormatError, match="subcase 2 is a SUBCOM"):
        read(BOLT, control="SUBCASE 1\n BOLTLD = 3\nSUBCOM 2", subcase=2)
    steps = "SUBC 1\n STEP 1\n  BOLTLD = 3\n STEP 2\n  BOLTLD = 4"
    joint = read(BOLT, control=steps)
    assert joint.preloads == {"bolt-1": 5000.0}
    assert "case control requests STEP after the first" in joint.assembly.ignored
    refuses("SUBCASE = 'ONE'; expected an id", read, BOLT, control="SUBCASE ONE")
    refuses("BOLTLD = 'X'; expected the number of a set", read, BOLT, control="BOLTLD = X")
    refuses("SUBCASE 1 is already at", read, BOLT, control="SUBCASE 1\nSUBCASE 1")
