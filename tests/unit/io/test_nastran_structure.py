"""What cards of rods, bushes, rigid bars, scalar points and shells mean."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from faying.exceptions import FormatError, StudyError
from faying.io.nastran import write_deck
from faying.model.assembly import Assembly
from faying.model.constraints import constrain
from faying.model.matrices import (
    assemble_matrices,
    mass_properties,
    rigid_body_motions,
    used_components,
)
from faying.study.inputs.load_model import load_model
from faying.study.keys.schema import read_study
from refusals import refuses

NODES = "".join(
    f"GRID,{i},,{x}.,{y}.,{z}.\n"
    for i, x, y, z in ((1, 0, 0, 0), (2, 4, 0, 0), (3, 4, 2, 0), (4, 0, 2, 0), (5, 1, 2, 3))
)
STEEL = "MAT1,9,210000.,,.3,7.8-9\n"
FRAME = "CORD2R,7,,0.,0.,0.,1.,1.,0.\n,0.,0.,1.\n"  # z along (1, 1, 0), x along basic z
Read = Callable[..., Assembly]


@pytest.fixture
def read(nastran) -> Read:
    return lambda *cards: nastran(NODES + STEEL + FRAME, *cards).assembly


def test_rods(read: Read) -> None:
    assembly = read(
        "CROD,1,10,1,2\nPROD,10,9,3.,5.,,.6",
        "CONROD,2,1,3,9,2.,1.",
        "CTUBE,3,11,1,5\nPTUBE,11,9,4.,1.",
        "PARAM,WTMASS,.5",
    )
    one, three, two = assembly.beams
    assert (one.section.area, one.section.torsion, one.section.inertia_y) == (3.0, 5.0, 0.0)
    assert one.material.density == pytest.approx(0.5 * (7.8e-9 + 0.6 / 3))
    assert (two.nodes, two.section.area, two.section.torsion) == ((0, 2), 2.0, 1.0)
    assert three.section.area == pytest.approx(np.pi * 3)  # diameters 4 and 2
    assert three.section.torsion == pytest.approx(np.pi / 32 * (4**4 - 2**4))


def test_bushes_and_their_axes(read: Read) -> None:
    assembly = read(
        "PBUSH,20,K,1.,2.,3.,4.,5.,6.\n,,M,8.",
        "PBUSH,21,K,9.",
        "CBUSH,1,20,1,2,,,,7",
        "CBUSH,2,20,1,2,0.,0.,1.\n,.25",
        "CBUSH,3,21,1,5",
        "CBUSH,4,20,2,,,,,0\n,,7,1.,2.,3.",
        "CBUSH,5,20,1,2,4\n,,-1",
    )
    by_id = {one.id: one for one in assembly.bushes}
    root = np.sqrt(0.5)
    np.testing.assert_allclose(
        by_id[1].axes, [[0, 0, 1], [root, -root, 0], [root, root, 0]], atol=1e-15
    )
    assert by_id[1].place == (2.0, 0.0, 0.0)
    np.testing.assert_allclose(by_id[2].axes, [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)
    assert by_id[2].place == (1.0, 0.0, 0.0)
    np.testing.assert_allclose(by_id[3].axes[0], np.array([1, 2, 3]) / np.sqrt(14), atol=1e-15)
    assert by_id[4].nodes == (1,)
    expected = np.array([2.0 * root + 3 * root, -2 * root + 3 * root, 1.0])
    np.testing.assert_allclose(by_id[4].place, expected, atol=1e-15)
    np.testing.assert_allclose(by_id[5].axes, np.eye(3), atol=1e-15)
    assert by_id[2].stiffness == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert by_id[2].mass == 8.0


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("CBUSH,1,20,1,2", "need an orientation"),
        ("CBUSH,1,20,1", "give the axes of the springs by CID"),
        ("CBUSH,1,22,1,2,,,,0", "property 22 is not in the deck.*PBUSH"),
        ("CBUSH,1,20,1,2,1.,0.,0.", "parallel to the line"),
        ("PBUSH,23,K,-1.", "neither may be negative"),
        ("PBUSH,23,X,1.", "'X' in field 3 is not supported"),
    ],
)
def test_bushes_that_are_refused(read: Read, card: str, message: str) -> None:
    refuses(message, read, "PBUSH,20,K,1.,2.,3.,4.,5.,6.", card)


@pytest.mark.parametrize("far", ["5", "6"])
@pytest.mark.parametrize(
    "card",
    [
        "RBAR,1,1,{0},123456",
        "RBAR,1,1,{0},,123456",
        "RBAR,1,1,{0},1234,23",
        "RBE1,1,1,1234,{0},23\n,UM,1,56,{0},1456",
        "RBE2,1,1,123456,{0}",
    ],
)
def test_rigid_bars_leave_six_rigid_motions(read: Read, card: str, far: str) -> None:
    """Between nodes 1 and 5, or 1 and 6 with a displacement system of its own."""
    assembly = read(card.format(far), "GRID,6,,1.,2.,3.,7")
    used = np.zeros((len(assembly.mesh.nodes), 6), dtype=bool)
    used[[0, int(far) - 1]] = True
    T = constrain(assembly, used.ravel()).transformation.toarray()[used.ravel()]
    assert np.linalg.matrix_rank(T) == 6
    motion = rigid_body_motions(assembly.mesh.nodes, np.ones(3))[used.ravel()]
    # Rounding of motions of the size of the model.
    assert np.abs(T @ np.linalg.lstsq(T, motion, rcond=None)[0] - motion).max() < 1e-12 * 5


def test_a_pin_at_one_place_needs_three_independent_components(read: Read) -> None:
    """Both grids keep their rotations, and one is turned."""
    assembly = read("RBAR,1,5,6,123,,,123", "GRID,6,,1.,2.,3.,7")
    used = np.zeros((6, 6), dtype=bool)
    used[4:] = True
    T = constrain(assembly, used.ravel()).transformation.toarray()
    assert T.shape[1] == 9
    np.testing.assert_allclose(T[24:27], T[30:33], atol=1e-14)


def test_single_components_follow_in_turned_systems(read: Read) -> None:
    """The third component of node 6 lies along (1, 1, 0)."""
    assembly = read("RBE2,1,1,3,6", "GRID,6,,1.,2.,3.,7")
    used = np.zeros((6, 6), dtype=bool)
    used[0] = used[5, :3] = True
    T = constrain(assembly, used.ravel()).transformation.toarray()
    along = (T[30] + T[31]) / np.sqrt(2)
    motion = rigid_body_motions(assembly.mesh.nodes, np.zeros(3))
    expected = (motion[30] + motion[31]) / np.sqrt(2)
    np.testing.assert_allclose(along[:6], expected, atol=1e-14)
    assert T.shape[1] == 8


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("RBAR,1,1,5,12346,2", "do not determine the rigid motion"),
        ("RBAR,1,1,5,123,12", "do not determine the rigid motion"),
        ("RBAR,1,1,5,123456,1", "7 independent"),
        ("RBAR,1,1,5,123,,,123", "rigid motion of the dependent"),
        ("RROD,1,1,2", "one translation at one of them as dependent"),
        ("RBE2,1,1,123456,1", "dependent nodes other than its independent one"),
    ],
)
def test_rigid_elements_that_are_refused(read: Read, card: str, message: str) -> None:
    refuses(message, read, card)


def test_groups_of_an_average_have_components_of_their_own(read: Read) -> None:
    """The least squares of what enters, weight by weight, rotations at the mean distance."""
    assembly = read(
        "RBE3,9,,5,123456,1.,123,1,2,\n,2.5,12,3,.7,1235,4",
        "CBAR,8,1,1,4,0.,0.,1.\nPBAR,1,9,1.,1.,1.,1.",
    )
    used = np.zeros((5, 6), dtype=bool)
    used[:4, :3] = used[[0, 3, 4]] = True
    T = constrain(assembly, used.ravel()).transformation.toarray()
    entering = {0: (0, 1, 2), 1: (0, 1, 2), 2: (0, 1), 3: (0, 1, 2, 4)}
    weights = [1.0, 1.0, 2.5, 0.7]
    nodes = assembly.mesh.nodes
    distance = np.linalg.norm(nodes[:4] - nodes[4], axis=1).mean()
    motions = rigid_body_motions(nodes, nodes[4]).reshape(5, 6, 6)
    rows, places = [], []
    for node, own in entering.items():
        for c in own:
            rows.append(motions[node, c] * (w := weights[node] ** 0.5 * (distance if c > 2 else 1)))
            places.append((6 * node + c, w))
    pinned = np.linalg.pinv(np.array(rows))
    wanted = np.zeros((6, 30))
    for k, (dof, w) in enumerate(places):
        wanted[:, dof] = w * pinned[:, k]
    np.testing.assert_allclose(T[24:], wanted @ T, atol=1e-13)


def test_a_rigid_rod_keeps_its_length(read: Read) -> None:
    (equation,) = read("RROD,1,1,5,,3").equations
    assert equation.terms[0][:2] == (4, 2)
    along = {(0, 0): -1, (0, 1): -2, (0, 2): -3, (4, 0): 1, (4, 1): 2, (4, 2): 3}
    scale = equation.terms[0][2] / 3
    assert {(n, c): value / scale for n, c, value in equation.terms} == along


def test_scalar_points_springs_and_masses(read: Read) -> None:
    assembly = read(
        "SPOINT,101,THRU,103",
        "CELAS3,1,30,101,102\nPELAS,30,7.",
        "CELAS4,2,8.,103",
        "CMASS1,3,40,102,,1,2\nPMASS,40,3.",
        "CMASS4,4,5.,103",
        "SPC1,1,,101\nSPC,1,102,0,0.",
        "MPC,2,102,,1.,1,3,-2.",
    )
    assert assembly.mesh.node_ids[5:].tolist() == [101, 102, 103]
    assert [(s.ends, s.stiffness) for s in assembly.springs] == [
        (((5, 0), (6, 0)), 7.0),
        (((7, 0),), 8.0),
    ]
    assert [(m.ends, m.mass) for m in assembly.scalar_masses] == [
        (((6, 0), (0, 1)), 3.0),
        (((7, 0),), 5.0),
    ]
    assert [(s.nodes.tolist(), s.components) for s in assembly.supports] == [([5, 6], (0,))]
    assert assembly.equations[0].terms == ((6, 0, 1.0), (0, 2, -2.0))
    refuses("scalar point 5 is also a GRID", read, "SPOINT,5")


def test_damping_and_control_are_left_out_and_named(read: Read) -> None:
    assembly = read("CDAMP1,1,2,1,1\nPDAMP,2,3.", "PGAP,5,1.", "DVTREL1,1,A,2", "MATT1,9,5")
    notes = " ".join(assembly.ignored)
    for text in (
        "1 CDAMP1",
        "give [damping]",
        "1 PGAP that no element uses",
        "1 DVTREL1",
        "reference temp",
    ):
        assert text in notes


def test_a_shell_of_each_kind(read: Read) -> None:
    assembly = read(
        "PSHELL,1,9,.5,9,,9,,.1",
        "CQUAD4,1,1,1,2,3,4,30.,.25",
        "CTRIA3,2,1,1,2,5,7,-.1",
        "CTRIA3,3,1,2,3,5\n,,,1.,2.,3.",
        "PARAM,WTMASS,.5",
    )
    three, four = assembly.shells
    assert (three.kind, three.nodes.tolist()) == ("tri3", [[0, 1, 4], [1, 2, 4]])
    assert (four.kind, four.offsets.tolist()) == ("quad4", [0.25])
    np.testing.assert_allclose(three.offsets, [-0.1, 0.0])
    # THETA from the first side; MCID's x axis.
    np.testing.assert_allclose(four.directions[0] / 4, [np.cos(np.pi / 6), 0.5, 0], atol=1e-15)
    np.testing.assert_allclose(three.directions[0], [0, 0, 1], atol=1e-15)
    section = assembly.shell_sections[1]
    A, D = 210000 * 0.5 / 0.91, 210000 * 0.5**3 / 12 / 0.91
    np.testing.assert_allclose(np.diag(section.stiffness), [A, A, A * 0.35, D, D, D * 0.35])
    np.testing.assert_allclose(section.shear, 5 / 6 * 0.5 * 210000 / 2.6 * np.eye(2))
    assert section.mass == pytest.approx(0.5 * (7.8e-9 * 0.5 + 0.1))
    own = assembly.shell_sections[int(three.properties[1])]
    assert own.stiffness[3, 3] == pytest.approx(210000 * 2**3 / 12 / 0.91)  # the mean of three
    assemble_matrices(assembly)
    assert used_components(assembly)[: 6 * 5].all()


def test_a_laminate_of_equal_layers_is_a_plate(read: Read) -> None:
    plate, laminate, mirrored = (
        read(card, "CQUAD4,1,1,1,2,3,4").shell_sections[1]
        for card in (
            "PSHELL,1,9,1.,9,,9",
            "PCOMP,1\n,9,.2,0.,,9,.3,45.\n,9,.5,90.",
            "PCOMP,1,,,,,,,SYM\n,9,.2,0.,,9,.3",
        )
    )
    # Rounding of sums over the layers.
    for other in (laminate, mirrored):
        np.testing.assert_allclose(other.stiffness, plate.stiffness, rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(other.shear, plate.shear, rtol=1e-12)
        assert other.mass == pytest.approx(plate.mass)
        assert other.inertia == pytest.approx(plate.inertia)


def test_layers_lie_at_their_angles(read: Read) -> None:
    """One layer at 90° is the layer at 0° with its axes exchanged; Z0 couples."""
    along, across, above = (
        read("MAT8,8,100.,10.,.3,5.,4.,2.", card, "CQUAD4,1,1,1,2,3,4").shell_sections[1]
        for card in (
            "PCOMP,1\n,8,2.,0.",
            "PCOMP,1\n,8,2.,90.",
            "PCOMPG,1,0.\n,77,8,2.,0.",
        )
    )
    order = [1, 0, 2, 4, 3, 5]
    np.testing.assert_allclose(
        across.stiffness, along.stiffness[np.ix_(order, order)], rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(np.diag(along.shear), [5 / 6 * 2 * 4, 5 / 6 * 2 * 2])
    np.testing.assert_allclose(np.diag(across.shear), [5 / 6 * 2 * 2, 5 / 6 * 2 * 4])
    A = along.stiffness[:3, :3]
    np.testing.assert_allclose(above.stiffness[:3, 3:], A, rtol=1e-12)  # A z with z = 1
    np.testing.assert_allclose(above.stiffness[3:, 3:], A * (2**2 / 12 + 1), rtol=1e-12)


@pytest.mark.parametrize(
    ("cards", "message"),
    [
        ("PSHELL,1,9,0.", "must be positive"),
        ("PSHELL,1,,1.,9", "without membrane"),
        ("PSHELL,1,8,1.", "material 8 is not"),
        ("PCOMP,1,,,,,,,BEND\n,9,1.", "LAM = 'BEND' is not supported"),
        ("PCOMP,1\n,9,-1.", "layer has thickness"),
        ("PCOMP,1", "no layers"),
        ("PCOMP,2\n,9,1.", "property 1 is not in the deck.*PSHELL, PCOMP"),
        ("MAT8,8,1.,1.,2.\nPSHELL,1,8,1.", "an unstable material"),
    ],
)
def test_shells_that_are_refused(read: Read, cards: str, message: str) -> None:
    refuses(message, read, cards, "CQUAD4,1,1,1,2,3,4")


def test_shells_have_the_mass_of_their_surface(read: Read) -> None:
    found = mass_properties(read("PSHELL,1,9,.5", "CQUAD4,1,1,1,2,3,4"))
    assert found.mass == pytest.approx(7.8e-9 * 0.5 * 8)


def test_decks_are_not_written_without_their_shells(read: Read, tmp_path: Path) -> None:
    assembly = read("PSHELL,1,9,.5", "CQUAD4,1,1,1,2,3,4")
    with pytest.raises(FormatError, match="has shells, which faying reads but does not write"):
        write_deck(assembly, tmp_path / "b.bdf")


MIDDLES = (
    "GRID,11,,2.,0.,0.\nGRID,12,,4.,1.,0.\nGRID,13,,2.,2.,0.\nGRID,14,,0.,1.,0.\nGRID,15,,2.,1.,0."
)


def test_shells_with_mid_side_nodes(read: Read) -> None:
    assembly = read(
        MIDDLES,
        "PSHELL,1,9,.5,9,,9",
        "CQUAD8,1,1,1,2,3,4,11,12\n,13,14,,,,,30.,.25",
        "CTRIA6,2,1,1,2,3,11,12,15\n,,-.1",
        "CSHEAR,3,2,1,2,3,4\nPSHEAR,2,9,.5",
    )
    six, eight, panel = assembly.shells
    assert (six.kind, six.nodes.tolist()) == ("tri6", [[0, 1, 2, 5, 6, 9]])
    assert (eight.kind, eight.nodes.tolist()) == ("quad8", [[0, 1, 2, 3, 5, 6, 7, 8]])
    assert (six.offsets[0], eight.offsets[0]) == (-0.1, 0.25)
    np.testing.assert_allclose(eight.directions[0] / 4, [np.cos(np.pi / 6), 0.5, 0], atol=1e-15)
    assert panel.kind == "panel4"
    assert assembly.shell_sections[2].stiffness[2, 2] == pytest.approx(0.5 * 210000 / 2.6)
    assemble_matrices(assembly)


@pytest.mark.parametrize(("factor", "width"), [("1.", 2.0), (".5", 1.0), ("30.", 15.0)])
def test_shear_panels_that_carry_along_their_sides(read: Read, factor: str, width: float) -> None:
    """A rectangle of 4 by 2, pulled along the long sides: F1 of its width, or F1 T."""
    assembly = read(f"CSHEAR,3,2,1,2,3,4\nPSHEAR,2,9,.5,,{factor}")
    assert [(rod.id, rod.nodes) for rod in assembly.beams] == [(4, (0, 1)), (5, (2, 3))]
    u = np.zeros((len(assembly.mesh.nodes), 6))
    u[:, 0] = 1e-3 * assembly.mesh.nodes[:, 0] / 4
    work = u.ravel() @ assemble_matrices(assembly).K @ u.ravel()
    assert work == pytest.approx(210000 * 0.5 * width / 4 * 1e-6, rel=1e-12)
    (side,) = {rod.nodes for rod in read("CSHEAR,3,2,1,2,3,4\nPSHEAR,2,9,.5,,,.5").beams[:1]}
    assert side == (1, 2)
    assert mass_properties(assembly).mass == pytest.approx(7.8e-9 * 8 * 0.5)


def test_a_factor_of_shear_panels_that_makes_no_sense(read: Read) -> None:
    with pytest.raises(FormatError, match=r"PSHEAR: field 6 \(F1\) is -1; it must not be negative"):
        read("CSHEAR,3,2,1,2,3,4\nPSHEAR,2,9,.5,,-1.")


def test_loads_of_scalar_points(read: Read) -> None:
    loads = read("SPOINT,21,22,23", "CELAS4,1,5.,21,22", "SLOAD,7,21,2.,23,-1.,21,.5").loads
    assert loads["7"].nodes.tolist() == [5, 7]
    np.testing.assert_allclose(loads["7"].forces[:, 0], [2.5, -1.0])
    assert not loads["7"].forces[:, 1:].any()
    other = read("SPOINT,21", "SLOAD,7,3,2.")
    assert not other.loads
    assert any("SLOAD on GRID 3, which is no SPOINT" in note for note in other.ignored)


def test_blank_mid_side_nodes_leave_sides_straight(read: Read) -> None:
    """A node stands in the middle that moves as the mean of the ends: the same stiffness."""
    whole, blank = (
        read(MIDDLES, "PSHELL,1,9,.5,9,,9", card)
        for card in (
            "CQUAD8,1,1,1,2,3,4,11,12\n,13,14",
            "CQUAD8,1,1,1,2,3,4,11\n,13,14",
        )
    )
    assert blank.mesh.node_ids.tolist() == [*whole.mesh.node_ids.tolist(), 16]
    np.testing.assert_allclose(blank.mesh.nodes[-1], [4, 1, 0])
    mean = np.eye(60)
    mean[36:42] = 0.0
    mean[36:42, 6:12] = mean[36:42, 12:18] = np.eye(6) / 2
    K = mean.T @ assemble_matrices(whole).K.toarray() @ mean
    T = constrain(blank, used_components(blank)).transformation
    free = np.flatnonzero(np.isin(np.arange(66), T.indices))
    found = (T.T @ assemble_matrices(blank).K @ T).toarray()
    kept = constrain(blank, used_components(blank)).free
    assert len(free) == len(kept)
    np.testing.assert_allclose(found, K[np.ix_(kept, kept)], atol=1e-9 * np.abs(K).max())


def test_pressure_on_shells_acts_along_their_normals(read: Read) -> None:
    assembly = read(
        "PSHELL,1,9,.5",
        "CQUAD4,1,1,1,2,3,4\nCTRIA3,2,1,1,3,2\nCTRIA3,9,1,1,2,3",
        "PLOAD4,5,1,3.",
        "PLOAD4,6,1,2.,,,,THRU,8",
        "PLOAD4,7,1,2.\n,0,1.,0.,0.",
    )
    total = {name: load.forces[:, :3].sum(axis=0) for name, load in assembly.loads.items()}
    np.testing.assert_allclose(total["5"], [0, 0, 3 * 8], atol=1e-12)
    np.testing.assert_allclose(total["6"], [0, 0, 2 * (8 - 4)], atol=1e-12)
    np.testing.assert_allclose(total["7"], [2 * 8, 0, 0], atol=1e-12)


def test_lines_have_the_shear_modulus_they_are_given(read: Read) -> None:
    """E and G of a beam need not be those of an isotropic material; the NU of a shell must."""
    steel = "MAT1,8,1000.,100.,,2."
    beam, rod = read(
        steel, "PBAR,1,8,3.,4.,5.,6.\n\n,.5", "CBAR,1,1,1,2,0.,1.,0.", "CONROD,2,1,3,8,1.,2."
    ).beams
    for line, torsion in ((beam, 6.0), (rod, 2.0)):
        stiffness = line.material.shear_modulus * line.section.torsion
        assert stiffness == pytest.approx(100 * torsion)
        assert line.material.youngs_modulus == 1000.0
    refuses("Poisson's ratio is 4", read, steel, "PSHELL,1,8,1.", "CQUAD4,1,1,1,2,3,4")


def test_areas_of_zero_at_the_far_end_are_blanks(read: Read) -> None:
    card = "PBEAM,1,9,3.,4.,5.,,6.\n,0.,0.\n,YESA,1.,0.,0.,0."
    assert read(card, "CBEAM,1,1,1,2,0.,1.,0.").beams[0].section.area == 3.0


def test_a_study_does_not_change_the_material_of_solids_alone(read: Read, tmp_path: Path) -> None:
    read(
        "GRID,6,,0.,0.,1.\nCTETRA,1,5,1,2,3,6\nPSOLID,5,9",
        "PSHELL,1,9,.5\nCTRIA3,2,1,1,2,3",
        "CONROD,3,1,6,8,1.\nMAT1,8,7.,,.3",
    )
    path = tmp_path / "study.toml"
    study = 'title = "a"\nunits = "mm-t-s"\n[model]\nsource = "nastran"\nfile = "a.bdf"\n'
    path.write_text(f"{study}[material.8]\nE = 1.0\n")
    load_model(read_study(path))  # of the rod alone
    path.write_text(f"{study}[material.9]\nE = 1.0\n")
    with pytest.raises(StudyError, match="shells use material '9' too"):
        load_model(read_study(path))


def test_corners_without_thickness(read: Read) -> None:
    """Tapered to nothing at one side, the mean counts; a shell that has none is refused."""
    tapered = "CQUAD4,1,1,1,2,3,4\n,,,0.,0.,3.,3."
    (section,) = (
        read(tapered, "PSHELL,1,9,2.").shell_sections[n]
        for n in read(tapered, "PSHELL,1,9,2.").shells[0].properties.tolist()
    )
    whole = read("CQUAD4,1,1,1,2,3,4", "PSHELL,1,9,1.5").shell_sections[1]
    np.testing.assert_allclose(section.mass, whole.mass)
    for corners in ("0.,0.,0.,0.", "-1.,0.,3.,3."):
        with pytest.raises(FormatError, match="thicknesses T1 to T4 must not be negative"):
            read(f"CQUAD4,1,1,1,2,3,4\n,,,{corners}", "PSHELL,1,9,2.")


def test_aerodynamics_and_radiation_are_left_out(read: Read) -> None:
    notes = read("AECOMP,W,AELIST,1", "MONPNT3,A,B", "CAERO7,1", "RADCAV,1").ignored
    assert any("AECOMP" in note and "CAERO7" in note and "aerodynamics" in note for note in notes)
    assert any("RADCAV" in note and "heat" in note for note in notes)


BRICK = (
    "".join(
        f"GRID,{k + 11},,{x}.,{y}.,{z}.\n"
        for k, (x, y, z) in enumerate(
            [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2)]
        )
    )
    + "CHEXA,1,1,11,12,13,14,15,16\n,17,18\nPSOLID,1,9\n"
    + "GRID,21,,1.,0.,.5\nGRID,22,,1.,1.,.5\nGRID,23,,2.,1.,.5\nGRID,24,,2.,0.,.5\n"
    + "CQUAD4,5,2,21,24,23,22\nPSHELL,2,9,.1,9\n"
)


@pytest.mark.parametrize("card", ["RSSCON,9,ELEM,5,1", "RSSCON,9,GRID,21,12,16,22,13,17"])
def test_an_edge_of_a_shell_is_clamped_to_a_solid(read: Read, card: str) -> None:
    """A quarter of the way up the face; a deck of MSC's moves 2 % less than in its op2."""
    assembly = read(BRICK + card)
    used = np.zeros((len(assembly.mesh.nodes), 6), dtype=bool)
    used[5:13, :3] = used[13:] = True
    T = constrain(assembly, used.ravel()).transformation.toarray().reshape(-1, 6, 8 * 3 + 24 - 10)
    for shell, low, high in ((13, 6, 10), (14, 7, 11)):
        np.testing.assert_allclose(T[shell, :3], 0.75 * T[low, :3] + 0.25 * T[high, :3], atol=1e-14)
        np.testing.assert_allclose(T[shell, 3], (T[low, 1] - T[high, 1]) / 2, atol=1e-14)
        np.testing.assert_allclose(T[shell, 4], (T[high, 0] - T[low, 0]) / 2, atol=1e-14)


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("RSSCON,9,ELEM,5,99", "element 99 is not a solid"),
        ("RSSCON,9,ELEM,99,1", "element 99 is not a shell"),
        ("RSSCON,9,ELEM,5,1,,5,1", "one shell with one solid"),
        ("RSSCON,9,GRID,21,12,12", "coincide"),
        ("GRID,31,,5.,5.,5.\nCTRIA3,6,2,31,23,24\nRSSCON,9,ELEM,6,1", "no edge of shell 6 lies on"),
    ],
)
def test_edges_that_cannot_be_clamped(read: Read, card: str, message: str) -> None:
    refuses(message, read, BRICK + card)


FLEXIBLE = "Z,2.,.5,.1,3.,.2,4."


@pytest.mark.parametrize("rigid", [False, True])
def test_elements_given_by_their_flexibility(read: Read, rigid: bool) -> None:
    """GENEL between node 5 and node 1: K (u_i - S u_d) of components 1, 2, 6."""
    held = "1,1,1,2,1,3\n,1,4,1,5,1,6" if rigid else "1,1,1,2"
    S = "" if rigid else "\n,S,1.,.5,0.,2.,-1.,0."
    assembly = read(f"GENEL,7,,5,1,5,2,5,6\n,UD,,{held}\n,{FLEXIBLE}{S}")
    K = assemble_matrices(assembly).K.toarray()
    flexibility = np.array([[2.0, 0.5, 0.1], [0.5, 3.0, 0.2], [0.1, 0.2, 4.0]])
    places, across = [24, 25, 29, 0, 1], np.array([[1.0, 0.5], [0.0, 2.0], [-1.0, 0.0]])
    if rigid:
        places = [24, 25, 29, *range(6)]
        across = rigid_body_motions(assembly.mesh.nodes, assembly.mesh.nodes[0])[[24, 25, 29]]
    both = np.hstack([np.eye(3), -across])
    wanted = np.zeros_like(K)
    wanted[np.ix_(places, places)] = both.T @ np.linalg.inv(flexibility) @ both
    np.testing.assert_allclose(K, wanted, atol=1e-14 * np.abs(wanted).max())


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("GENEL,7,,5,1,5,2\n,Z,1.,2.", "Z has 2 numbers; expected 3"),
        ("GENEL,7,,5,1,5,2\n,Z,1.,1.,1.", "cannot be inverted"),
        ("GENEL,7,,5,1\n,UD,,1,1\n,K,1.", "1 components in UD and no S"),
        ("GENEL,7,,6,1\n,K,1.\nGRID,6,,1.,2.,3.,7", "without a displacement system"),
        ("GENEL,7,,99,1\n,K,1.", "GRID 99 is not in the deck"),
    ],
)
def test_elements_of_numbers_that_are_refused(read: Read, card: str, message: str) -> None:
    refuses(message, read, card)
