"""Bolts of solids in Nastran decks: of grids, of elements, and MSC's of a control grid."""

import numpy as np
import pytest

import faying as fy
from clamped_plates import abaqus_deck, nastran_deck
from faying.exceptions import FormatError
from faying.io.abaqus import read_joint as read_abaqus
from faying.io.nastran import read_joint as read_nastran


def tightened(described, name):
    """Contact forces and largest motion down, of the joint tightened and loaded."""
    interfaces = [
        fy.InterfaceSpec(name=one.name, minus=one.minus, plus=one.plus, penalty=1e6)
        for one in described.interfaces
    ]
    model = fy.build_model(described.assembly, interfaces=interfaces, bolts=described.bolts)
    held = fy.with_weak_springs(model.with_deck_loads(name), 6.0)
    joint = fy.preload(held, described.preloads)
    found = []
    for factor in (0.0, 1.0):
        solution = fy.solve_static(joint, fy.Load({name: factor}))
        found += [solution.contact_force(one.name) for one in interfaces]
        moved = joint.dofs.nodal(solution.full_displacement())
        found.append(float(np.abs(moved[:, 2]).max()))
    return found


@pytest.fixture(scope="module")
def as_abaqus(tmp_path_factory):
    """The same joint as a deck of pretension sections, which others compare with CalculiX."""
    path = tmp_path_factory.mktemp("deck") / "plates.inp"
    path.write_text(abaqus_deck())
    return tightened(read_abaqus(path), "step 2")


@pytest.mark.parametrize("bolt", ["etype 2", "etype 3", "split"])
def test_bolts_of_solids_are_pretension_sections(tmp_path, as_abaqus, bolt):
    path = tmp_path / "plates.bdf"
    path.write_text(nastran_deck(bolt))
    described = read_nastran(path)
    assert described.preloads == {"bolt-1": 5000.0}
    assert list(described.assembly.loads) == ["7"]  # the force on a control grid is none
    found = tightened(described, "7")
    # The same numbers in another order: springs of 1e10 N/mm in K leave ten digits; the closing
    # spring of a split bolt is another one, 1e-4 of a layer of the shank.
    np.testing.assert_allclose(found, as_abaqus, rtol=1e-4 if bolt == "split" else 1e-8)


REFUSED = [
    ("BOLT,1,2,0,3,300,301,304", "no faces between solids of the shank lie in this cross-section"),
    ("BOLT,1,2,5,3,300,301,304", "coordinate system 5 is not in the deck"),
    ("BOLT,1,2,0,4,300,301,304", "IDIR = 4; expected 1, 2 or 3"),
    ("BOLT,1,3,,,,,,\n,310,311", "the axis is blank; give CSID and IDIR"),
    ("BOLT,1,3,0,3,,,,\n,310,399", "element 399 is not a solid of the deck"),
    ("BOLT,1,4,0,3", r"ETYPE = 4; it is 1 \(beams\), 2 or 3 \(solids\)"),
    ("BOLT,1,998\n,TOP,300,301\n,BOTTOM,302", "2 grids on TOP and 1 on BOTTOM"),
    (
        "BOLT,1,300\n,TOP,301\n,BOTTOM,302",
        "control grid 300 has no force or displacement along one line",
    ),
]


@pytest.mark.parametrize(("card", "message"), REFUSED)
def test_bolts_that_are_no_sections_are_refused(tmp_path, card, message):
    path = tmp_path / "plates.bdf"
    path.write_text(nastran_deck(halves=f"{card}\nBOLTFOR,8,5000.,1"))
    with pytest.raises(FormatError, match=rf"plates\.bdf:\d+: BOLT: {message}"):
        read_nastran(path)


def test_contact_that_begins_in_a_later_step(tmp_path):
    path = tmp_path / "plates.bdf"
    text = nastran_deck("split").replace(
        "BCSET = 9\nLOAD = 7\n",
        "SUBCASE 1\nSTEP 1\nBCONTACT = 0\nLOAD = 6\nSTEP 2\nBCONTACT = 4\nLOAD = 7\n",
    )
    table = "BCTABL1,4,3\nBCONECT,3,,,7,8\nBCBODY1,7,,3D,DEFORM,11\nBCBODY1,8,,3D,DEFORM,12\n"
    bodies = "BSURF,11,100,THRU,107\nBSURF,12,200,THRU,207\n"
    text = text.replace("BCTSET,9,1,2,0.,,1.\n,,3,4,0.,,1.\n,,5,6,0.,,1.\n", table + bodies)
    path.write_text(text)
    described = read_nastran(path)
    assert [one.name for one in described.interfaces] == ["contact-7-8"]
    assert any("BCONTACT = 4 comes from a later STEP" in one for one in described.assembly.ignored)


def test_a_control_grid_that_is_moved_shortens_its_shank(tmp_path):
    """The sides of the cut overlap by as much, whatever gives way to it."""
    path = tmp_path / "plates.bdf"
    text = nastran_deck("split").replace("FORCE,6,999,,5000.,0.,0.,-1.", "SPCD,7,999,3,-.01")
    path.write_text(text.replace("SPC1,1,12,999", "SPC1,1,123,999"))
    described = read_nastran(path)
    assert not described.preloads
    assert list(described.assembly.loads) == ["7"]
    interfaces = [
        fy.InterfaceSpec(name=one.name, minus=one.minus, plus=one.plus, penalty=1e6)
        for one in described.interfaces
    ]
    model = fy.build_model(described.assembly, interfaces=interfaces, bolts=described.bolts)
    held = fy.with_weak_springs(model, 6.0).with_bolt_forces(described.initial_forces)
    solution = fy.solve_static(held, fy.Load({}))
    moved = held.dofs.nodal(solution.full_displacement())[:, 2]
    card = next(line for line in text.splitlines() if line.startswith(",TOP"))
    top = [int(word) for word in card.split(",")[2:]]
    card = next(line for line in text.splitlines() if line.startswith(",BOTTOM"))
    bottom = [int(word) for word in card.split(",")[2:]]
    index = model.assembly.mesh.node_index
    overlap = moved[index(np.array(bottom))] - moved[index(np.array(top))]
    # The closing spring is 1e-4 of a layer of the shank, where that is all that gives way.
    np.testing.assert_allclose(overlap, 0.01, rtol=1e-3)
    assert solution.contact_force(interfaces[0].name) > 100.0
