"""Contact that decks declare across gaps: CalculiX against what faying makes of the same deck."""

import re

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix

import faying as fy
from stacked_cantilevers import Stack

pytestmark = needs_calculix

MATCHING = Stack(counts=((24, 2, 2),) * 3, penalty=1e3)
OTHER = Stack(counts=((24, 2, 2), (18, 3, 2), (26, 2, 2)), penalty=1e3)
NEAR = Stack(counts=((24, 2, 2),) * 3, penalty=1e3, gaps=(0.01, 0.01))
FORCE = 0.01
"""CalculiX has 28 contact points where faying has four: 0.5 % here, 0.1 % on finer meshes."""
OPENING = 0.02


def theirs(folder, text):
    """Contact forces of both pairs, compression positive, and displacements by node id."""
    (motion,) = displacements(folder, text)
    printed = (folder / "job.dat").read_text()
    forces = re.findall(r"normal force \(\+ = tension\).*\n\n +\S+ +(\S+)", printed)
    return -np.array(forces, dtype=float), motion


def compare(stack, folder, gaps, **options):
    """Check contact forces and the opening along both gaps; return the model."""
    forces, motion = theirs(folder, stack.abaqus(**options))
    model = fy.read_abaqus(folder / "job.inp").with_deck_loads("step 1")
    ours = fy.solve_static(model, fy.Load({"step 1": 1.0}))
    found = np.array([ours.contact_force(name) for name in ("J0", "J1")])
    np.testing.assert_allclose(found, forces, rtol=FORCE)
    moved = model.dofs.nodal(ours.full_displacement())[:, :3]
    ids = model.assembly.mesh.node_ids
    for number, gap in enumerate(gaps):
        opening = [
            gap
            + mean_height(stack, number + 1, False, motion)
            - mean_height(stack, number, True, motion),
            gap
            + mean_height(stack, number + 1, False, dict(zip(ids.tolist(), moved, strict=True)))
            - mean_height(stack, number, True, dict(zip(ids.tolist(), moved, strict=True))),
        ]
        # Where the beams stay apart, half way to the clamp.
        assert opening[1] == pytest.approx(opening[0], rel=OPENING)
    return model


def mean_height(stack, number, upper, motion):
    """Mean displacement upwards of the nodes of a side, half way along the beam."""
    _, nodes, *_ = list(stack.parts)[number]
    level = nodes[:, 2].max() if upper else nodes[:, 2].min()
    chosen = stack.node_ids(
        number, lambda x: (np.abs(x[:, 2] - level) < 1e-9) & (np.abs(x[:, 0] - 30.0) < 1e-9)
    )
    assert len(chosen)
    return float(np.mean([motion[node][2] for node in chosen.tolist()]))


@pytest.mark.long
@pytest.mark.parametrize("stack", [MATCHING, OTHER], ids=["matching", "other"])
def test_gaps_close_under_load(stack, tmp_path):
    model = compare(stack, tmp_path, stack.gaps)
    matching = stack is MATCHING
    for interface in model.interfaces.values():
        assert (interface.coupling is None) == matching
        assert interface.area == pytest.approx(600.0, rel=1e-12)
        np.testing.assert_allclose(interface.initial_gap, 0.1, atol=1e-12)


def test_one_gap_and_one_overlap(tmp_path):
    compare(Stack(counts=((24, 2, 2),) * 3, penalty=1e3, gaps=(0.1, -0.01)), tmp_path, (0.1, -0.01))


@pytest.mark.long
def test_adjust_closes_gaps(tmp_path):
    """CalculiX moves the slave nodes, which makes the beams 0.01 higher and 0.7 % stiffer there.

    Left as they are, gaps of 0.01 take 5 % of the lower contact force.
    """
    model = compare(NEAR, tmp_path, (0.0, 0.0), pair=", ADJUST=0.02")
    for interface in model.interfaces.values():
        np.testing.assert_allclose(interface.initial_gap, 0.0, atol=1e-12)
    model = compare(NEAR, tmp_path, NEAR.gaps, pair=", ADJUST=0.005")
    for interface in model.interfaces.values():
        np.testing.assert_allclose(interface.initial_gap, 0.01, atol=1e-12)


def test_adjust_of_a_node_set(tmp_path):
    nodes = NEAR.node_ids(2, lambda x: x[:, 2] < 8.02 + 1e-9)
    named = "*NSET, NSET=CLOSED\n" + "\n".join(map(str, nodes.tolist()))
    model = compare(NEAR, tmp_path, (0.01, 0.0), pair=", ADJUST=CLOSED", more=named)
    lower, upper = model.interfaces.values()
    np.testing.assert_allclose(lower.initial_gap, 0.01, atol=1e-12)
    np.testing.assert_allclose(upper.initial_gap, 0.0, atol=1e-12)


def test_clearance_replaces_the_gap(tmp_path):
    more = "*CLEARANCE, MASTER=OVER0, SLAVE=UNDER0, VALUE=0.05"
    model = compare(MATCHING, tmp_path, (0.05, 0.1), more=more)
    np.testing.assert_array_equal(model.interfaces["J0"].initial_gap, 0.05)


SIMCENTER = "BCTSET,5,2,1,0.,,1.\n,,4,3,0.,,1."
MSC = "".join(f"BCBODY1,{10 * i},,3D,DEFORM,{i}\n" for i in range(1, 5)) + (
    "BCTABL1,9,3,4\nBCONECT,3,,,20,10\nBCONECT,4,,,40,30"
)


@pytest.mark.long
@pytest.mark.parametrize(
    ("contact", "cards"), [("BCSET = 5", SIMCENTER), ("BCONTACT = 9", MSC)], ids=["NX", "MSC"]
)
@pytest.mark.parametrize("stack", [MATCHING, OTHER], ids=["matching", "other"])
def test_nastran_pairs_across_the_same_gaps(stack, contact, cards, tmp_path):
    """The same beams as a Nastran deck, the upper side of each gap being the source."""
    forces, _ = theirs(tmp_path, stack.abaqus())
    path = tmp_path / "job.bdf"
    path.write_text(stack.nastran(contact=[contact], more=cards))
    model = fy.read_nastran(path).with_penalty(stack.penalty).with_deck_loads("1")
    solution = fy.solve_static(model, fy.Load({"1": 1.0}))
    found = [solution.contact_force(name) for name in model.interfaces]
    np.testing.assert_allclose(found, forces, rtol=FORCE)
    for interface in model.interfaces.values():
        assert interface.area == pytest.approx(600.0, rel=1e-6)  # six decimals of coordinates


def test_nastran_search_distance(tmp_path):
    path = tmp_path / "job.bdf"
    path.write_text(MATCHING.nastran(contact=["BCSET = 5"], more="BCTSET,5,2,1,0.,,.05"))
    with pytest.raises(fy.exceptions.ModelError, match=r"contact-2-1' is empty"):
        fy.read_nastran(path)
