"""What each group of cards means."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import eigh

from faying.exceptions import FormatError
from faying.io.nastran.case_control import LUMPED
from faying.model.assembly import Assembly, PointMass
from faying.model.matrices import assemble_matrices
from refusals import refuses

NODES = "".join(
    f"GRID,{i},,{x},{y},{z}\n"
    for i, x, y, z in (
        (1, 0.0, 0.0, 0.0),
        (2, 1.0, 0.0, 0.0),
        (3, 1.0, 1.0, 0.0),
        (4, 0.0, 1.0, 0.0),
        (5, 0.0, 0.0, 1.0),
        (6, 1.0, 0.0, 1.0),
        (7, 1.0, 1.0, 1.0),
        (8, 0.0, 1.0, 1.0),
    )
)
STEEL = "MAT1,9,210000.,,.3,7.8-9\n"
BRICK = "CHEXA,1,1,1,2,3,4,5,6\n,7,8\n"
Read = Callable[..., Assembly]


@pytest.fixture
def read(nastran) -> Read:
    return lambda *cards, head="": nastran(head + NODES + STEEL, *cards).assembly


def test_cylindrical_and_spherical_grids(read: Read) -> None:
    # System 5: origin (1, 2, 3), z along basic x, x along basic y; system 6 the same, spherical.
    frame = "{0},0,1.,2.,3.,2.,2.,3.\n,1.,3.,3."
    assembly = read(
        "CORD2C,5" + frame.format(""),
        "CORD2S,6" + frame.format(""),
        "GRID,11,5,2.,90.,7.",
        "GRID,12,6,2.,90.,90.",
        "GRID,13,6,2.,0.,0.",
    )
    local_y = np.array([0.0, 0.0, 1.0])  # z × x of the system
    origin = np.array([1.0, 2.0, 3.0])
    expected = [origin + 2 * local_y + [7, 0, 0], origin + 2 * local_y, [3, 2, 3]]
    # cos 90° is 6e-17.
    np.testing.assert_allclose(assembly.mesh.nodes[8:], expected, atol=1e-14)


def test_chained_and_grid_based_systems(read: Read) -> None:
    assembly = read(
        "CORD2R,3,2,1.,0.,0.,1.,0.,1.\n,2.,0.,0.",  # in system 2, shifted by 1 along its x
        "CORD2R,2,0,0.,0.,0.,0.,0.,1.,+MARK\n+MARK,0.,1.,0.",  # x along basic y
        "CORD1R,4,1,5,4",  # origin 1, z through 5, x through 4: the same axes
        "GRID,20,3,1.,0.,0.",
        "GRID,21,4,2.,1.,0.",
    )
    np.testing.assert_allclose(assembly.mesh.nodes[8:], [[0, 2, 0], [-1, 2, 0]], atol=1e-15)
    with pytest.raises(FormatError, match=r"CORD2R: coordinate system 2 refers to .* 3"):
        read("CORD2R,2,3,0.,0.,0.,0.,0.,1.\n,1.,0.,0.", "CORD2R,3,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.")
    refuses("on one line", read, "CORD2R,2,0,0.,0.,0.,0.,0.,1.\n,0.,0.,2.")


def test_grdset_fills_blank_fields(read: Read) -> None:
    assembly = read("GRDSET,,2,,,,,123456", "CORD2R,2,0,5.,0.,0.,5.,0.,1.\n,6.,0.,0.", "GRID,9,0")
    assert assembly.mesh.nodes[0].tolist() == [5, 0, 0]
    assert assembly.mesh.nodes[8].tolist() == [0, 0, 0]
    assert assembly.supports[0].nodes.tolist() == list(range(9))


@pytest.mark.parametrize(
    ("fields", "element"),
    [
        ("", "incompatible"),
        (",,BUBBLE,,REDUCED", "incompatible"),
        (",,TWO,,REDUCED", "incompatible"),
        (",,2", "incompatible"),
        (",,2,,1", "standard"),
        (",,TWO,GRID,FULL", "standard"),
    ],
)
def test_formulation_of_bricks(read: Read, fields: str, element: str) -> None:
    assembly = read(BRICK, "PSOLID,1,9" + fields)
    assert assembly.element == element
    assert assembly.mesh.element_sets["pid:1"].tolist() == [1]
    bare = element == "incompatible" and "2" in fields.replace("TWO", "2")
    assert any("without them a cantilever" in note for note in assembly.ignored) == bare


def test_formulations_that_are_refused(read: Read) -> None:
    refuses("IN = 'THREE' with ISOP = 'REDUCED'", read, BRICK, "PSOLID,1,9,,THREE,,REDUCED")
    with pytest.raises(FormatError, match="one formulation"):
        read(BRICK, BRICK.replace("CHEXA,1,1", "CHEXA,2,2"), "PSOLID,1,9", "PSOLID,2,9,,2,,1")
    refuses("FCTN = PFLUID", read, BRICK, "PSOLID,1,9,,,,,PFLUID")


def test_quadratic_and_wedge_elements(read: Read) -> None:
    more = "".join(f"GRID,{i},,{i}.,0.,0.\n" for i in range(11, 30))
    ids = ",".join
    hexa = "CHEXA,1,1,1,2,3,4,5,6\n,7,8," + ids(map(str, range(11, 17)))
    hexa += "\n," + ids(map(str, range(17, 23)))
    tetra = "CTETRA,2,1,1,2,3,5,11,12\n,13,14,15,16"
    assembly = read(more, hexa, tetra, "CPENTA,3,1,1,2,3,5,6,7", "PSOLID,1,9,,,,1")
    assert [b.kind for b in assembly.mesh.blocks] == ["hex20", "wedge6", "tet10"]
    assert assembly.mesh.blocks[0].nodes[0].tolist() == [*range(20)]
    fifteen = "CPENTA,3,1,1,2,3,5,6,7\n,11,12,13,14,15,16,17,18\n,19"
    block = read(more, fifteen, "PSOLID,1,9").mesh.blocks[0]
    assert block.kind == "wedge15"
    assert block.nodes[0].tolist() == [0, 1, 2, 4, 5, 6, *range(8, 17)]


def test_blank_mid_side_nodes_of_solids_leave_sides_straight(read: Read) -> None:
    """The side has a node in its middle that moves as the mean of its ends."""
    more = "".join(f"GRID,{i},,{i}.,0.,0.\n" for i in range(11, 20))
    fourteen = "CPENTA,3,1,1,2,3,5,6,7\n,11,12,13,14,15,16,17,18"
    assembly = read(more, fourteen, "PSOLID,1,9")
    (block,) = assembly.mesh.blocks
    assert block.kind == "wedge15"
    new = int(block.nodes[0, 14])
    ends = [int(block.nodes[0, 5]), int(block.nodes[0, 3])]
    np.testing.assert_array_equal(assembly.mesh.nodes[new], assembly.mesh.nodes[ends].mean(axis=0))
    assert [{(n, c): a for n, c, a in e.terms} for e in assembly.equations] == [
        {(new, c): 1.0, **{(end, c): -0.5 for end in ends}} for c in range(3)
    ]
    assert "1 blank mid-side nodes of CPENTA: straight sides" in assembly.ignored
    with pytest.raises(FormatError, match="CPENTA: 14 nodes; supported are 6 or 15, of which the"):
        read(more, "CPENTA,3,1,1,,3,5,6,7\n,11,12,13,14,15,16,17,18\n,19", "PSOLID,1,9")


def test_pyramids(read: Read) -> None:
    """Five nodes, and thirteen with the mid-sides of the base before those to the apex."""
    apex = "GRID,20,,.5,.5,2."
    mids = [(0.5, 0, 1), (1, 0.5, 1), (0.5, 1, 1), (0, 0.5, 1)]
    mids += [(x / 2 + 0.25, y / 2 + 0.25, 1.5) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    grids = [f"GRID,{31 + i},,{x},{y},{z}" for i, (x, y, z) in enumerate(mids)]
    five = "CPYRAM,50,1,5,6,7,8,20"
    thirteen = "CPYRAM,51,1,5,6,7,8,20,31\n,32,33,34,35,36,37,38"
    blocks = read(BRICK, apex, *grids, five, thirteen, "PSOLID,1,9").mesh.blocks
    assert [(block.kind, block.ids.tolist()) for block in blocks[1:]] == [
        ("pyramid5", [50]),
        ("pyramid13", [51]),
    ]
    with pytest.raises(FormatError, match="CPYRAM: 4 nodes; supported are 5 or 13, of"):
        read(BRICK, apex, "CPYRAM,50,1,1,2,3,4", "PSOLID,1,9")


def test_material_constants(read: Read) -> None:
    brick = (BRICK, "PSOLID,1,8")
    assert read(*brick, "MAT1,8,,80000.,.25").materials[1].youngs_modulus == 200000.0
    assert read(*brick, "MAT1,8,200000.,80000.").materials[1].poissons_ratio == 0.25
    refuses("has 1 of E, G, NU", read, *brick, "MAT1,8,,70000.")
    refuses(r"MAT1: material '8': Poisson's ratio is 0\.6", read, *brick, "MAT1,8,200000.,,.6")


def test_constants_that_contradict_each_other_count_as_in_nastran(read: Read) -> None:
    """Solids and membranes take E and NU, transverse shear and torsion of lines take G."""
    assembly = read(
        BRICK,
        "PSOLID,1,8",
        "MAT1,8,200000.,70000.,.25",
        "PSHELL,2,8,2.,8,,8\nCQUAD4,2,2,1,2,3,4",
        "PBAR,3,8,1.,2.,3.,4.\nCBAR,3,3,1,2,0.,1.,0.",
    )
    solid, section, beam = assembly.materials[1], assembly.shell_sections[2], assembly.beams[0]
    assert (solid.youngs_modulus, solid.poissons_ratio) == (200000.0, 0.25)
    assert section.stiffness[2, 2] == pytest.approx(2 * 80000)
    assert section.shear == pytest.approx(5 / 6 * 2 * 70000 * np.eye(2))
    assert beam.material.shear_modulus * beam.section.torsion == pytest.approx(4 * 70000)
    assert any(note.startswith("E, G and NU of MAT1 8 contradict") for note in assembly.ignored)


def test_youngs_modulus_alone(read: Read) -> None:
    """NU and G are zero then; solids take NU, lines G."""
    bar = "PBAR,3,8,1.,2.,3.,4.\n\n,.5,.5\nCBAR,3,3,1,2,0.,1.,0."
    assembly = read(BRICK, "PSOLID,1,8", "MAT1,8,200000.", bar)
    assert assembly.materials[1].poissons_ratio == 0.0
    section = assembly.beams[0].section
    assert (section.torsion, section.shear_factor_y) == (0.0, np.inf)
    assert any(note.startswith("MAT1 8 with E alone") for note in assembly.ignored)
    refuses("has 1 of E, G, NU", read, "MAT1,8,200000.", "PSHELL,2,8,2.\nCQUAD4,2,2,1,2,3,4")


def test_wtmass_scales_density_and_masses(read: Read) -> None:
    assembly = read(BRICK, "PSOLID,1,9", "PARAM,WTMASS,.5", "PARAM,POST,-1", "CONM2,4,1,,3.")
    assert assembly.materials[1].density == 3.9e-9
    assert assembly.masses[0].mass == 1.5
    assert assembly.ignored == ("PARAM POST",)
    refuses("CK2 scales", read, "PARAM,CK2,2.")
    head = "SOL 101\nCEND\n PARAM,WTMASS,2.\nPARAM,POST,1\nBEGIN BULK\n"
    assembly = read("CONM2,4,1,,3.", head=head)
    assert assembly.masses[0].mass == 6
    assert assembly.ignored == ("PARAM POST",)
    refuses(r"a\.bdf:3: PARAM: WTMASS = -2", read, head=head.replace("2.", "-2."))


def test_lumped_masses_of_nastran_are_said(read: Read) -> None:
    brick = (BRICK, "PSOLID,1,9")
    head = "SOL 103\nCEND\n{}BEGIN BULK\n"
    assert LUMPED in read(*brick, head=head.format("")).ignored
    assert LUMPED in read(*brick, "PARAM,COUPMASS,-1", head=head.format("")).ignored
    assert LUMPED not in read(*brick, "PARAM,COUPMASS,1", head=head.format("")).ignored
    assert LUMPED not in read(*brick, head=head.format("PARAM,COUPMASS,1\n")).ignored
    with pytest.raises(FormatError, match=r"PARAM: field 3 \(V1\) holds 'YES'"):
        read(*brick, "PARAM,COUPMASS,YES", head=head.format(""))


@pytest.mark.parametrize(("to_a_wave", "more"), [(10, 0.03), (5, 0.14)])
def test_what_lumped_masses_do_to_frequencies(to_a_wave: int, more: float, read: Read) -> None:
    """The percentages of the note, for a rod held at both ends."""
    n = 20
    cards = [f"GRID,{100 + i},,{i}.,5.,0." for i in range(n + 1)]
    cards += [f"CONROD,{i + 1},{100 + i},{101 + i},9,1." for i in range(n)]
    assembly = read(*cards)
    matrices = assemble_matrices(assembly)
    axial = 6 * np.arange(9, 8 + n)
    K, M = (matrix.toarray()[np.ix_(axial, axial)] for matrix in (matrices.K, matrices.M))
    mode = 2 * n // to_a_wave - 1  # mode k from 1 has k half waves
    consistent = eigh(K, M, eigvals_only=True)[mode]
    lumped = eigh(K, np.diag(np.full(n - 1, 2 * M[0, 1] + M[0, 0])), eigvals_only=True)[mode]
    assert np.sqrt(consistent / lumped) - 1 == pytest.approx(more, abs=0.005)  # as it is rounded


def test_beams_and_sections(read: Read) -> None:
    bar, beam = read(
        "CBAR,1,5,1,2,0.,1.,0.",
        "CBEAM,2,6,1,5,4",
        "PBAR,5,9,2.,3.,4.,5.",
        "PBEAM,6,9,2.,3.,4.,,5.\n,YES,1.,2.,3.\n,1.,1.\n,.5,0.",
    ).beams
    assert bar.nodes == (0, 1)
    assert bar.orientation == (0, 1, 0)
    # I1 is for bending in plane 1, the local x-y plane.
    assert (bar.section.area, bar.section.inertia_z, bar.section.inertia_y) == (2, 3, 4)
    assert (bar.section.torsion, bar.section.shear_factor_y) == (5, np.inf)
    assert beam.orientation == (0, 1, 0)  # towards grid 4
    assert (beam.section.shear_factor_y, beam.section.shear_factor_z) == (0.5, np.inf)
    (plain,) = read("CBEAM,2,6,1,5,4", "PBEAM,6,9,2.,3.,4.,,5.").beams
    assert plain.section.shear_factor_y == 1.0


@pytest.mark.parametrize(
    ("kind", "sizes", "area", "i1", "i2", "torsion"),
    [
        ("ROD", "2.", 4 * np.pi, 4 * np.pi, 4 * np.pi, 8 * np.pi),
        ("TUBE", "2.,1.", 3 * np.pi, 15 / 4 * np.pi, 15 / 4 * np.pi, 7.5 * np.pi),
        # J of a square is 0.1406 a⁴ (Saint-Venant); the approximation is good to 0.5 %.
        ("BAR", "1.,2.", 2.0, 8 / 12, 2 / 12, 0.4573),
        # Thin square box: A = 4 a t, I = 2/3 a³ t, J = a³ t with a the mean width.
        ("BOX", "10.01,10.01,.01,.01", 0.4, 20 / 3, 20 / 3, 10.0),
        # Two flanges of 6 x 1 and a web of 8 x 1.
        ("I", "10.,6.,6.,1.,1.,1.", 20.0, 12 * 20.25 + 1 + 512 / 12, 36 + 8 / 12, 20 / 3),
        ("I1", "5.,1.,8.,10.", 20.0, 12 * 20.25 + 1 + 512 / 12, 36 + 8 / 12, 20 / 3),
        ("H", "8.,2.,6.,1.", 20.0, 36 + 8 / 12, 12 * 20.25 + 1 + 512 / 12, 20 / 3),
    ],
)
def test_dimensioned_sections(
    read: Read, kind: str, sizes: str, area: float, i1: float, i2: float, torsion: float
) -> None:
    for element, card in (("CBAR", "PBARL"), ("CBEAM", "PBEAML")):
        (beam,) = read(f"{element},1,5,1,2,0.,1.,0.", f"{card},5,9,,{kind}\n,{sizes}").beams
        s = beam.section
        found = [s.area, s.inertia_z, s.inertia_y, s.torsion]
        np.testing.assert_allclose(found, [area, i1, i2, torsion], rtol=5e-3)
        assert 0.3 < s.shear_factor_y < 1


@pytest.mark.parametrize(
    ("kind", "sizes", "area", "i1", "i2"),
    [
        # Web 2 x 24, flanges 10 x 2 at its ends: the centre is 328 / 88 from the back.
        ("CHAN1", "10.,2.,20.,24.", 88.0, 24**3 / 6 + 40 * 121 + 40 / 3, 1134.788),
        # Top 15 x 2, webs 2 x 18, brims 5 x 2: the centre is 1264 / 122 above the brims' foot.
        ("HAT", "20.,2.,15.,5.", 122.0, 6080.011, 562.5 + 24 + 72 * 6.5**2 + 250 / 6 + 2000),
    ],
)
def test_sections_that_are_open_on_a_side(
    read: Read, kind: str, sizes: str, area: float, i1: float, i2: float
) -> None:
    """By hand, for mystran's have other centres."""
    assembly = read("CBAR,1,5,1,2,0.,1.,0.", f"PBARL,5,9,,{kind}\n,{sizes}")
    s = assembly.beams[0].section
    np.testing.assert_allclose([s.area, s.inertia_z, s.inertia_y], [area, i1, i2], rtol=1e-6)
    assert any("made of thin walls" in note for note in assembly.ignored)
    with pytest.raises(FormatError, match=f"centroid and shear centre of {kind} differ"):
        read("CBEAM,1,5,1,2,0.,1.,0.", f"PBEAML,5,9,,{kind}\n,{sizes}")
    with pytest.raises(FormatError, match="a wall has no length or thickness"):
        read("CBAR,1,5,1,2,0.,1.,0.", f"PBARL,5,9,,{kind}\n,1.,2.,20.,1.")


def test_properties_of_other_materials_that_no_element_names(read: Read) -> None:
    """As those of an optimization; MAT8 is none of beams."""
    assembly = read("PBARL,5,8,,BAR\n,1.,2.", "MAT8,8,1.,1.,.3")
    assert "PBARL 5, without a MAT1, that no element uses" in assembly.ignored
    with pytest.raises(FormatError, match=r"material 8 is not in the deck.*MAT1"):
        read("PBARL,5,8,,BAR\n,1.,2.", "MAT8,8,1.,1.,.3", "CBAR,1,5,1,2,0.,1.,0.")


def test_mass_per_length_of_beams(read: Read) -> None:
    cards = {
        "PBAR,5,9,2.,3.,4.,5.,.1": "CBAR",
        "PBARL,5,9,,BAR\n,1.,2.,.1": "CBAR",
        "PBEAM,5,9,2.,3.,4.,0.,5.,.1\n,NO,1.,2.,3.,4.,0.,5.,.1": "CBEAM",
        "PBEAML,5,9,,BAR\n,1.,2.,.1,YES,1.,1.,2.,.1": "CBEAM",
    }
    for card, name in cards.items():
        assembly = read(f"{name},1,5,1,2,0.,1.,0.", card, "PARAM,WTMASS,.5")
        (beam,) = assembly.beams
        assert beam.section.area == 2.0
        assert beam.material.density == pytest.approx(0.5 * (7.8e-9 + 0.1 / 2))
        assert any("non-structural mass of 1 properties" in note for note in assembly.ignored)
    with pytest.raises(FormatError, match="changes along the beam"):
        read("CBEAM,1,5,1,2,0.,1.,0.", "PBEAML,5,9,,BAR\n,1.,2.,.1,YES,1.,1.,2.,.2")


def test_gravity_and_rotation_act_on_all_masses(read: Read) -> None:
    heavy = (BRICK, "PSOLID,1,9", "CONM2,4,1,,3.-9")
    frame = "CORD2R,7,,0.,0.,0.,1.,0.,0.\n,0.,1.,0."  # z along x, x along y
    loads = read(
        *heavy,
        frame,
        "GRAV,1,7,10.,0.,0.,-2.",
        "RFORCE,2,2,7,3.,0.,1.,0.",
        "LOAD,9,1.,2.,1,1.,2",
    ).loads
    np.testing.assert_allclose(loads["1"].forces.sum(axis=0)[:3], [-20 * 10.8e-9, 0, 0], atol=1e-20)
    # About z, which is y of the system, through node 2 at (1, 0, 0): the brick's middle is at
    # (-0.5, 0.5) from it, the mass at (-1, 0).
    square = (6 * np.pi) ** 2
    turning = square * np.array([-0.5 * 7.8e-9 - 3e-9, 0.5 * 7.8e-9, 0])
    np.testing.assert_allclose(loads["2"].forces.sum(axis=0)[:3], turning, atol=1e-16)
    np.testing.assert_allclose(
        loads["9"].forces.sum(axis=0),
        2 * loads["1"].forces.sum(axis=0) + loads["2"].forces.sum(axis=0),
        atol=1e-16,
    )
    cylinder = "CORD2C,8,,0.,0.,0.,0.,0.,1.\n,1.,0.,0."
    for card in ("GRAV,3,8,1.,1.,0.,0.", "RFORCE,3,,,1.,2.,0.,0.", "RFORCE,3,,,1.,1.,0.,0.,1\n,5."):
        left = read(*heavy, cylinder, card)
        assert "3" not in left.loads
        assert any("load set 3" in text for text in left.ignored)
    refuses("GRAV: coordinate system 9 is not in the deck", read, *heavy, "GRAV,3,9,1.,1.,0.,0.")


@pytest.mark.parametrize(
    ("cards", "message"),
    [
        ("CBAR,1,5,1,2,0.,1.,0.\n,55", r"CBAR: pin flag: components are '55'"),
        ("CBAR,1,5,1,2,0.,1.,0.,GOX\n,,,.5", "CBAR: OFFT = 'GOX' is not supported"),
        ("CBAR,1,5,1,2,1.,0.,0.", "zero or parallel"),
        ("CBAR,1,5,1,1,1.,0.,0.", "no length"),
        ("CBAR,1,4,1,2,0.,1.,0.", "property 4 is not in the deck.*PBAR"),
        ("CBEAM,1,5,1,2,0.,1.,0.", "property 5 is not in the deck.*PBEAM"),
        ("PBAR,6,9,2.,3.,4.,5.,-.1", r"\(NSM\) is -0.1; it must not be negative"),
        ("PBAR,6,9,0.", r"\(A\) is 0; it must be positive"),
        ("PBEAM,6,9,2.,3.,4.\n,NO,1.,3.", r"a\.bdf:12: PBEAM: the section changes"),
        ("PBARL,6,9,,HEXA\n,1.,2.,3.", "section 'HEXA'"),
        ("PBARL,6,9,,TUBE\n,1.,2.", "fill its inside"),
    ],
)
def test_beams_that_are_refused(read: Read, cards: str, message: str) -> None:
    refuses(message, read, "PBAR,5,9,2.,3.,4.,5.", cards)


def test_orientation_in_the_displacement_system_of_end_a(read: Read) -> None:
    turned = "CORD2R,2,0,0.,0.,0.,0.,0.,1.\n,0.,1.,0."  # x along basic y
    cards = (turned, "GRID,9,,5.,0.,0.,2", "PBAR,5,9,2.,3.,4.,5.")
    (beam,) = read(*cards, "CBAR,1,5,9,1,1.,0.,0.").beams
    assert beam.orientation == (0, 1, 0)
    refuses("parallel", read, *cards, "CBAR,1,5,9,1,1.,0.,0.,BGG")


def test_couplings(read: Read) -> None:
    assembly = read("RBE2,1,1,123,2,THRU,5,7,1.-5", "RBE3,2,,1,123456,1.,123,2,3\n,4,2.5,123,5")
    (rigid,), (average,) = assembly.rigid_couplings, assembly.average_couplings
    assert (rigid.reference, rigid.nodes.tolist(), rigid.components) == (
        0,
        [1, 2, 3, 4, 6],
        (0, 1, 2),
    )
    assert average.nodes.tolist() == [1, 2, 3, 4]
    assert average.weights.tolist() == [1, 1, 1, 2.5]
    assert average.components == (0, 1, 2)


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("RBE2,1,1,127,2", "components are '127'"),
        ("RBE2,1,1,123,99", "GRID 99 is not"),
        ("RBE2,1,1,123,1", "other than its independent"),
        ("RBE3,1,,1,123,1.,123,2\n,UM,2,123", "a UM set"),
        ("RBE3,1,,1,123,1,123,2", "'1' occurs where a positive real weight"),
    ],
)
def test_couplings_that_are_refused(read: Read, card: str, message: str) -> None:
    refuses(message, read, card)


TURNED = "CORD2C,2,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,9,2,2.,30.,0.,2\nGRID,10,2,2.,30.,1.,2"


def test_single_components_in_a_turned_system(read: Read) -> None:
    refuses("single components of GRID 9", read, TURNED, "RBE3,1,,9,1,1.,123,1,2\n,3")
    assert len(read(TURNED, "RBE2,1,1,123,9").rigid_couplings) == 1
    with pytest.raises(FormatError, match=r"not a basic axis; such a spring leads to the ground"):
        read(TURNED, "CELAS2,1,5.,9,1,10,1")
    refuses(r"not a basic axis; masses", read, TURNED, "CMASS2,1,5.,9,1")
    assert read(TURNED, "CELAS2,1,5.,9,3").springs[0].ends == ((8, 2),)


@pytest.mark.parametrize(("other", "component"), [("", 1), ("11,1", 1), ("", 5), ("11,5", 5)])
def test_springs_along_turned_axes(read: Read, other: str, component: int) -> None:
    """To the ground, or to a grid at the same place: a motion apart does its work."""
    beside = "GRID,11,2,2.,30.,0.,2"
    assembly = read(TURNED, beside, f"CELAS2,1,5.,9,{component},{other}")
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    along = np.array([c, s, 0.0]) if component == 1 else np.array([-s, c, 0.0])
    K = assemble_matrices(assembly).K
    ids = assembly.mesh.node_ids
    for node, expected in ((9, 5.0), (11, 5.0 if other else 0.0)):
        u = np.zeros((len(ids), 6))
        first = 3 * (component // 4)
        u[ids == node, first : first + 3] = along
        assert u.ravel() @ K @ u.ravel() == pytest.approx(expected, abs=1e-14)
    across = np.zeros((len(ids), 6))
    across[:, 3 * (component // 4) : 3 * (component // 4) + 3] = np.cross([0, 0, 1], along)
    across[:, 2] = 1.0
    np.testing.assert_allclose(K @ across.ravel(), 0.0, atol=1e-14)


def test_grids_on_the_axis_of_their_system_are_told(read: Read) -> None:
    text = TURNED + "\nGRID,11,2,0.,0.,5.,2"
    (note,) = [note for note in read(text).ignored if "on the axis" in note]
    assert note.startswith("1 GRID on the axis of their displacement system")
    assert not [note for note in read(TURNED).ignored if "on the axis" in note]


def test_warping_constants_serve_warping_points_alone(read: Read) -> None:
    card = "PBEAM,5,9,1.,2.,3.,0.,4.\n,,,,,,,,\n,,,,,,,1.5,1.5"
    (beam,) = read(card, "CBEAM,7,5,1,5,1.,0.,0.").beams
    assert (
        beam.section == read("PBEAM,5,9,1.,2.,3.,0.,4.", "CBEAM,7,5,1,5,1.,0.,0.").beams[0].section
    )
    refuses("a warping point at one end only", read, card, "CBEAM,7,5,1,5,1.,0.,0.\n,,,,,,,,\n,1")


def test_supports(read: Read) -> None:
    cards = ("SPC,1,1,12,0.,2,12", "SPC1,2,3,1,THRU,99999999", "SPC1,1,12,3", "SPCADD,7,1")
    both = read(*cards).supports
    assert [(s.id, s.nodes.tolist(), s.components) for s in both] == [
        (1, [0, 1, 2], (0, 1)),
        (2, list(range(8)), (2,)),
    ]
    (one,) = read(*cards, head="SOL 101\nCEND\nSPC = 7\nBEGIN BULK\n").supports
    assert one.id == 1
    head = "SOL 101\nCEND\nSPC = 1\nSUBCASE 3\n SPC = 2\nSUBCASE 4\n SPC = 1\nBEGIN BULK\n"
    assert [s.id for s in read(*cards, head=head).supports] == [2]
    refuses("selects SPC = 8", read, *cards, head="SOL 101\nCEND\nSPC = 8\nBEGIN BULK\n")
    refuses("SPC1: GRID 99", read, "SPC1,1,3,99")


def test_support_in_a_cylindrical_system(read: Read) -> None:
    (support,) = read(TURNED, "SPC1,1,1,9,10").supports
    assert support.nodes.tolist() == [8, 9]
    assert support.axes is not None
    c, s = np.cos(np.pi / 6), 0.5
    # Rounding of sine and cosine.
    np.testing.assert_allclose(support.axes, [[c, s, 0], [-s, c, 0], [0, 0, 1]], atol=1e-15)


def test_equations(read: Read) -> None:
    (equation,) = read("MPC,3,1,1,1.,2,1,-2.\n,,3,2,4.").equations
    assert equation.terms == ((0, 0, 1.0), (1, 0, -2.0), (2, 1, 4.0))
    (turned,) = read(TURNED, "MPC,3,9,1,1.,1,1,-1.").equations
    # The radial displacement at 30°; the larger share, along x, becomes the dependent one.
    assert [(node, c) for node, c, _ in turned.terms] == [(8, 0), (8, 1), (0, 0)]
    np.testing.assert_allclose(
        [a for _, _, a in turned.terms], [np.sqrt(3) / 2, 0.5, -1.0], rtol=1e-15
    )
    both = read(TURNED, "MPC,3,9,1,1.,1,1,-1.", "MPC,3,9,2,1.,1,2,-1.").equations
    assert [e.terms[0][:2] for e in both] == [(8, 0), (8, 1)]
    refuses("already dependent", read, "MPC,3,1,1,1.,2,1,-2.", "MPC,3,1,1,1.,3,1,-2.")
    assert read("MPC,3,1,1,1.,2,1,-2.", head="CEND\nMPC=4\nBEGIN BULK\nMPCADD,4,3\n").equations


def test_loads(read: Read) -> None:
    cards = (
        TURNED,
        "FORCE,1,1,,10.,1.,0.,2.",
        "FORCE,1,9,2,2.,1.,0.,0.",  # radial at 30°
        "MOMENT,2,1,,3.,0.,1.,0.",
        "LOAD,5,2.,1.,1,.5,2",
        "ACCEL1,6,,9.,0.,0.,1.\n,1",
    )
    assembly = read(*cards, head="SOL 101\nCEND\nLOAD = 5\nBEGIN BULK\n")
    assert list(assembly.loads) == ["5", "1", "2"]
    five = assembly.loads["5"]
    assert five.nodes.tolist() == [0, 8]
    np.testing.assert_allclose(five.forces[0], [20, 0, 40, 0, 3, 0])
    np.testing.assert_allclose(five.forces[1, :3], [2 * np.sqrt(3), 2, 0], atol=1e-15)
    assert any("load set 6" in text and "ACCEL1" in text for text in assembly.ignored)
    # A study says which loads it applies, so nothing is lost that was to be used.
    selected = read(*cards, head="SOL 101\nCEND\nLOAD = 6\nBEGIN BULK\n")
    assert list(selected.loads) == ["1", "2", "5"]
    refuses("load set 77", read, "LOAD,5,1.,1.,77")


def test_springs_and_masses(read: Read) -> None:
    assembly = read(
        "CELAS1,1,4,1,1,2,1",
        "PELAS,4,50.,,,5,60.",
        "CELAS2,2,7.,2,6",
        "CONM2,3,2,0,5.\n,1.,.1,2.,.2,.3,3.",
    )
    assert [(s.stiffness, s.ends) for s in assembly.springs] == [
        (50.0, ((0, 0), (1, 0))),
        (7.0, ((1, 5),)),
    ]
    assert assembly.masses[0].inertia == ((1, -0.1, -0.2), (-0.1, 2, -0.3), (-0.2, -0.3, 3))
    # Nothing keeps the grid from turning: Nastran holds it, and the offset does nothing.
    assembly = read("CONM2,3,2,0,5.,1.\n,1.")
    assert assembly.masses == (PointMass(id=3, node=1, mass=5.0),)
    assert any("offset of 1 CONM1 or CONM2 at grids" in note for note in assembly.ignored)
    refuses(r"property 9 is not in the deck.*PELAS", read, "CELAS1,1,9,1,1,2,1")


@pytest.mark.parametrize(
    ("system", "numbers", "offset"),
    [
        ("0", "1.,2.,-3.", (1, 2, -3)),
        ("7", "1.,2.,-3.", (-2, 1, -3)),
        ("-1", "3.,2.,-3.", (1, 1, -3)),
    ],
)
def test_masses_beside_their_grids(
    read: Read, system: str, numbers: str, offset: tuple[float, ...]
) -> None:
    """They move as the rigid arm does: kinetic energy of turning about the grid, by hand."""
    assembly = read(
        "GRID,90,,2.,1.,0.",
        *(f"CELAS2,{9 + c},7.,90,{c}" for c in range(1, 7)),
        "CORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.",  # its x is y, its y is -x
        f"CONM2,3,90,{system},5.,{numbers}\n,4.,,6.,,,8.",
    )
    axes = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]) if system == "7" else np.eye(3)
    M = assemble_matrices(assembly).M.toarray()[-6:, -6:]
    for turning in np.eye(3):
        motion = np.concatenate([[0.3, 0.2, 0.1], turning])
        velocity = motion[:3] + np.cross(turning, offset)
        spin = axes @ turning
        energy = 5 * velocity @ velocity + spin @ (np.array([4, 6, 8]) * spin)
        np.testing.assert_allclose(motion @ M @ motion, energy, rtol=1e-14)


def test_a_mass_matrix_of_a_mass_with_inertia(read: Read) -> None:
    springs = [f"CELAS2,{9 + c},7.,1,{c}" for c in (4, 5, 6)]
    assembly = read(
        *springs, "CONM1,3,1,,5.,0.,5.,0.,0.\n,5.,0.,0.,0.,4.,0.,0.,0.\n,-.1,6.,0.,0.,0.,-.2,-.3,8."
    )
    (mass,) = assembly.masses
    assert mass.mass == 5.0
    assert mass.inertia == ((4, -0.1, -0.2), (-0.1, 6, -0.3), (-0.2, -0.3, 8))
    refuses("masses that differ between directions", read, "CONM1,3,1,,5.,0.,6.,0.,0.\n,5.")


def test_sets(read: Read) -> None:
    assembly = read(
        BRICK, "PSOLID,1,9", "SET1,4,1,THRU,6,EXCEPT,3", "BSURFS,5,,,,1,1,2,3", "BCPROP,6,1"
    )
    assert assembly.mesh.node_sets["set:4"].tolist() == [0, 1, 3, 4, 5]
    more = read("SET1,4,1,THRU,6,EXCEPT,3,5\n,8")
    assert more.mesh.node_sets["set:4"].tolist() == [0, 1, 3, 5, 7]
    for rest, message in (
        ("", "names no id"),
        (",9", "names no id"),
        (",3,THRU,4", "list the ids"),
    ):
        refuses(f"SET1: EXCEPT .*{message}", read, f"SET1,4,1,THRU,6,EXCEPT{rest}")
    assert assembly.face_sets["bsurfs:5"][:, :4].tolist() == [[0, 3, 2, 1]]
    assert assembly.mesh.element_sets["bcprop:6"].tolist() == [1]


def test_case_control_matrices_are_refused(read: Read) -> None:
    refuses(r"a\.bdf:3: K2GG", read, head="SOL 103\nCEND\nK2GG = STIFF\nBEGIN BULK\n")


def test_default_orientations(read: Read) -> None:
    bar = ("PBAR,5,9,1.,1.,1.,1.", "BAROR,,5,,,0.,1.,0.")
    beams = read(*bar, "CBAR,1,,1,2", "CBAR,2,5,1,2,0.,0.,1.", "CBAR,3,,1,2,4").beams
    assert [beam.orientation for beam in beams] == [(0, 1, 0), (0, 0, 1), (0, 1, 0)]
    assert [beam.property for beam in beams] == [5, 5, 5]
    # A node as the default, and a beam that gives a vector of its own.
    beams = read(bar[0], "BAROR,,5,,,4", "CBAR,1,,1,2", "CBAR,2,,1,2,0.,1.,1.").beams
    assert [beam.orientation for beam in beams] == [(0, 1, 0), (0, 1, 1)]
    refuses("give all of X1, X2, X3", read, *bar, "CBAR,1,,1,2,,1.")
    refuses("a second BAROR", read, *bar, bar[1])
    refuses("are fields shifted", read, bar[0], "BAROR,5,,,0.,1.,0.")
