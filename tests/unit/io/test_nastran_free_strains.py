"""Temperatures and DEFORM of Nastran decks, by hand."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from faying.io.nastran import read_joint
from faying.model.assembly import Assembly
from faying.model.temperature import Temperature, expansion_of
from linear_solution import displacements_of

LENGTH, ALPHA, YOUNGS = 8.0, 1.2e-5, 210000.0
PLACES = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 4, 8)]
# A bar of two bricks, held at x = 0 so that nothing keeps it from growing sideways.
BAR = (
    "".join(f"GRID,{i},,{x}.,{y}.,{z}.\n" for i, (x, y, z) in enumerate(PLACES, 1))
    + "CHEXA,1,1,1,2,5,4,7,8\n,11,10\nCHEXA,2,1,2,3,6,5,8,9\n,12,11\n"
    + "SPC1,1,1,1,4,7,10\nSPC1,1,2,1,7\nSPC1,1,3,1,4\n"
    + "FORCE,2,3,0,25.,1.,0.,0.\nFORCE,2,6,0,25.,1.,0.,0.\n"
    + "FORCE,2,9,0,25.,1.,0.,0.\nFORCE,2,12,0,25.,1.,0.,0.\n"
)
STEEL = "PSOLID,1,1\nMAT1,1,210000.,,.3,7.8-9,1.2-5,0.\n"
# Solving brings 1e-12 of the largest displacement; eight columns hold these numbers exactly.
SOLVED = {"rtol": 1e-9, "atol": 1e-15}

Deck = Callable[[str], Assembly]


@pytest.fixture
def deck(nastran) -> Deck:
    return lambda text: nastran(text).assembly


FORCE = 100 * LENGTH / YOUNGS


@pytest.mark.parametrize(
    ("control", "cards", "load", "tip"),
    [
        ("LOAD=2\nTEMP(LOAD)=3", "TEMPD,3,80.", "2", FORCE + ALPHA * 80 * LENGTH),
        ("LOAD=2\nTEMPERATURE=3", "TEMPD,3,80.", "2", FORCE + ALPHA * 80 * LENGTH),
        ("LOAD=2\nSUBCASE 1\nTEMP(BOTH)=3", "TEMPD,3,80.", "2", FORCE + ALPHA * 80 * LENGTH),
        ("TEMP(LOAD)=3", "TEMPD,4,9.,3,80.", "temperature", ALPHA * 80 * LENGTH),
        ("TEMP(LOAD)=3\nTEMP(INIT)=4", "TEMPD,3,100.,4,20.", "temperature", ALPHA * 80 * LENGTH),
        # One grid of the twelve apart: in bricks of eight nodes the mean counts.
        ("TEMP(LOAD)=3", "TEMPD,3,80.\nTEMP,3,3,80.,6,80.", "temperature", ALPHA * 80 * LENGTH),
    ],
)
def test_bar_grows_by_its_temperature(
    deck: Deck, control: str, cards: str, load: str, tip: float
) -> None:
    assembly = deck(f"SOL 101\nCEND\nSPC=1\n{control}\nBEGIN BULK\n{BAR}{STEEL}{cards}\nENDDATA\n")
    motion = displacements_of(assembly, assembly.loads[load])
    np.testing.assert_allclose(motion[assembly.mesh.nodes[:, 0] == LENGTH, 0], tip, **SOLVED)
    assert any(f"part of load '{load}'" in note for note in assembly.ignored)


def test_the_coefficient_of_the_deck_serves_temperatures_of_a_study(deck: Deck) -> None:
    assembly = deck(
        f"SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n{BAR}{STEEL}TEMPD,3,80.\nENDDATA\n"
    )
    forces = np.zeros((12, 6))
    forces[assembly.loads["temperature"].nodes] = assembly.loads["temperature"].forces
    warm, _ = expansion_of(assembly, Temperature(reference=20.0, uniform=100.0), {})
    # Round-off of sums of eight nodes.
    np.testing.assert_allclose(warm, forces, rtol=1e-12, atol=1e-9)


def test_reference_temperature_counts_unless_there_is_an_initial_one(deck: Deck) -> None:
    warm = STEEL.replace(",0.\n", ",30.\n")
    for control, degrees in (("", 50), ("TEMP(INIT)=4\n", 60)):
        assembly = deck(
            f"SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\n{control}BEGIN BULK\n"
            f"{BAR}{warm}TEMPD,3,80.,4,20.\nENDDATA\n"
        )
        motion = displacements_of(assembly, assembly.loads["temperature"])
        np.testing.assert_allclose(motion[2, 0], ALPHA * degrees * LENGTH, **SOLVED)


def test_expansion_along_directions_of_a_solid(deck: Deck) -> None:
    """MAT9 turned by 90°: its x is the bar's y; shear strains turn angles, not lengths."""
    law = "MAT9,1,3.,1.,1.,,,,3.\n,1.,,,,3.\n,1.,,,1.,,1.,,1.-5\n,2.-5,3.-5,4.-5\n"
    solid = f"PSOLID,1,1,7\n{law}CORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"
    assembly = deck(
        f"SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n{BAR}{solid}TEMPD,3,10.\nENDDATA\n"
    )
    motion = displacements_of(assembly, assembly.loads["temperature"])
    np.testing.assert_allclose(motion[2, 0], 2e-5 * 10 * LENGTH, **SOLVED)
    np.testing.assert_allclose(motion[3, 1], 1e-5 * 10, **SOLVED)
    np.testing.assert_allclose(motion[6, 2], 3e-5 * 10, **SOLVED)
    # x and y of the material are y and -x here: γ = 4e-5 has the other sign.
    np.testing.assert_allclose(motion[2, 1], -4e-5 * 10 * LENGTH, **SOLVED)


LINE = (
    "GRID,1,,0.,0.,0.\nGRID,2,,5.,0.,0.\nSPC1,1,123456,1\nSPC1,1,23456,2\n"
    "MAT1,1,210000.,,.3,7.8-9,1.2-5,20.\nPROD,1,1,3.,2.\nPBAR,2,1,3.,2.,2.,1.\nPBEAM,3,1,3.,2.,2.,,1.\n"
)


@pytest.mark.parametrize(
    "element",
    [
        "CROD,7,1,1,2",
        "CONROD,7,1,2,1,3.",
        "CBAR,7,2,1,2,0.,1.,0.",
        "CBEAM,7,3,1,2,0.,1.,0.",
        # An end of its own, five beyond the grid, which does not take part in the expansion.
        "CBAR,7,2,1,2,0.,1.,0.\n,,,,,,5.,0.,0.",
        "CBAR,7,2,1,2,0.,1.,0.\n,56,",
    ],
)
@pytest.mark.parametrize(
    ("selection", "cards", "change"),
    [
        ("TEMP(LOAD)=3", "TEMPD,3,100.", ALPHA * 80),
        ("TEMP(LOAD)=3", "TEMP,3,1,60.,2,140.", ALPHA * 80),
        ("TEMP(LOAD)=3", "TEMPD,3,0.\nTEMPRB,3,7,90.,110.", ALPHA * 80),
        ("TEMP(LOAD)=3", "TEMPD,3,0.\nTEMPRB,3,9,90.,110.\n,\n,7", ALPHA * 80),
        ("DEFORM=3", "DEFORM,3,7,.01", None),
    ],
)
def test_line_elements_grow(
    deck: Deck, element: str, selection: str, cards: str, change: float | None
) -> None:
    assembly = deck(
        f"SOL 101\nCEND\nSPC=1\n{selection}\nBEGIN BULK\n{LINE}{element}\n{cards}\nENDDATA\n"
    )
    (beam,) = assembly.beams
    start, end = assembly.mesh.nodes[list(beam.nodes)]
    load = "deform" if change is None else "temperature"
    growth = 0.01 if change is None else change * np.linalg.norm(end - start)
    np.testing.assert_allclose(
        displacements_of(assembly, assembly.loads[load])[1, 0], growth, **SOLVED
    )


PLATE = (
    "".join(f"GRID,{1 + i + 3 * j},,{2 * i}.,{2 * j}.,0.\n" for j in range(3) for i in range(3))
    + "SPC1,1,123456,1\nSPC1,1,345,2,THRU,9\n"
)
QUADS = "".join(
    f"CQUAD4,{n},1,{a},{a + 1},{a + 4},{a + 3},THETA\n" for n, a in enumerate((1, 2, 4, 5), 1)
)
THICK = QUADS.replace("THETA", "0.\n,,,.7,.7,.7,.7", 1)
EIGHT = "CQUAD8,1,1,1,3,9,7,2,6\n,8,4\n"
MAT8 = "MAT8,1,140000.,9000.,.3,5000.,4000.,3000.,1.6-9\n,1.-5,3.-5,20.\n"


@pytest.mark.parametrize(
    ("shells", "material", "strains"),
    [
        (QUADS, STEEL[STEEL.index("MAT1") :], (ALPHA, ALPHA, 0)),
        (EIGHT, STEEL[STEEL.index("MAT1") :], (ALPHA, ALPHA, 0)),
        (THICK, STEEL[STEEL.index("MAT1") :], (ALPHA, ALPHA, 0)),
        (QUADS, MAT8, (1e-5, 3e-5, 0)),
        (QUADS.replace("THETA", "90."), MAT8, (3e-5, 1e-5, 0)),
        # 45°: the mean along both axes, and γxy = a1 - a2.
        (QUADS.replace("THETA", "45."), MAT8, (2e-5, 2e-5, -2e-5)),
        (QUADS, "MAT2,1,3.,1.,0.,3.,0.,1.,0.\n,1.-5,2.-5,4.-5\n", (1e-5, 2e-5, 4e-5)),
    ],
)
def test_shells_grow(deck: Deck, shells: str, material: str, strains: tuple[float, ...]) -> None:
    shells = shells.replace("THETA", "0.")
    zero = 20.0 if material is MAT8 else 0.0
    assembly = deck(
        "SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n"
        f"{PLATE}{shells}PSHELL,1,1,.5,1\n{material}TEMPD,3,{80 + zero}\nENDDATA\n"
    )
    used = np.unique(np.concatenate([block.nodes.ravel() for block in assembly.shells]))
    place = assembly.mesh.nodes[used]
    motion = displacements_of(assembly, assembly.loads["temperature"])[used]
    a, b, shear = 80 * np.array(strains)
    # Node 1 does not turn, and what shears keeps the drilling of the node beside it: rotations are
    # those of the field (0, 0, 0), so that both displacements have half the angle.
    wanted = place[:, :2] @ np.array([[a, shear / 2], [shear / 2, b]])
    # Drilling is 10⁻⁴ as stiff as the membrane, so that rounding counts as many times more.
    np.testing.assert_allclose(motion[:, :2], wanted, rtol=1e-8, atol=1e-8 * np.abs(wanted).max())


def test_laminate_grows_as_its_layers_together(deck: Deck) -> None:
    """Crossed layers: E1 a1 + E2 a2 + ν12 E2 (a1 + a2) over E1 + E2 + 2 ν12 E2, both ways."""
    laminate = "PCOMP,1,,,,,20.,,SYM\n,1,.5,0.,,1,.5,90.\n"
    assembly = deck(
        "SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n"
        f"{PLATE}{QUADS.replace('THETA', '0.')}{laminate}{MAT8}TEMPD,3,100.\nENDDATA\n"
    )
    first, second, cross = 140000.0, 9000.0, 0.3 * 9000.0
    mean = (first * 1e-5 + second * 3e-5 + cross * 4e-5) / (first + second + 2 * cross)
    motion = displacements_of(assembly, assembly.loads["temperature"])
    np.testing.assert_allclose(motion[8, :2], 80 * mean * 4.0, rtol=1e-8)


@pytest.mark.parametrize(
    ("cards", "reason"),
    [
        ("TEMP,3,1,80.", "GRID 2 without a temperature in set 3"),
        ("TEMPD,4,80.", "temperature set 3, which the deck does not have"),
        ("TEMPD,3,80.\nTEMPP3,3,1,0.,80.", "TEMPP3"),
        ("TEMPD,3,80.\nTEMPRB,3,9,1.,1.,2.", "with a gradient across the element"),
        ("TEMPD,3,80.\nMATT1,1,,,,,5", "at temperatures of TEMPERATURE"),
    ],
)
def test_what_is_not_read_spoils_the_load(deck: Deck, cards: str, reason: str) -> None:
    assembly = deck(
        f"SOL 101\nCEND\nSPC=1\nLOAD=2\nTEMP=3\nBEGIN BULK\n{BAR}{STEEL}{cards}\nENDDATA\n"
    )
    assert "2" not in assembly.loads
    assert any(note.startswith("load set 2 (") and reason in note for note in assembly.ignored)


def test_temperatures_left_out(tmp_path: Path, deck: Deck) -> None:
    text = "SOL 101\nCEND\nSPC=1\nLOAD=2\n{}BEGIN BULK\n" + f"{BAR}{STEEL}TEMPD,3,80.\nENDDATA\n"
    assembly = deck(text.format(""))
    assert any("1 TEMPD: case control selects none" in note for note in assembly.ignored)
    np.testing.assert_allclose(
        displacements_of(assembly, assembly.loads["2"])[2, 0], FORCE, **SOLVED
    )
    (tmp_path / "b.bdf").write_text(text.format("TEMP(LOAD)=3\n"))
    assembly = read_joint(tmp_path / "b.bdf", ignore=["temperature"]).assembly
    np.testing.assert_allclose(
        displacements_of(assembly, assembly.loads["2"])[2, 0], FORCE, **SOLVED
    )


def test_bolt_of_one_beam_that_expands_is_refused(deck: Deck) -> None:
    """Its force is read from its elongation."""
    line = f"{LINE}CBAR,7,2,1,2,0.,1.,0.\nBOLT,1,1,7\nTEMPD,3,100.\n"
    assembly = deck(f"SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n{line}ENDDATA\n")
    assert not assembly.loads
    assert any("element 7, a bolt" in note for note in assembly.ignored)


def test_force_in_a_bolt_of_solids_that_cannot_grow(tmp_path: Path) -> None:
    """The spring that closes the cut carries E A α ΔT as compression."""
    path = tmp_path / "a.bdf"
    path.write_text(
        "SOL 101\nCEND\nSPC=1\nTEMP(LOAD)=3\nBEGIN BULK\n"
        f"{BAR}{STEEL}SPC1,1,1,3,6,9,12\nBOLT,1,2,0,1,2,5,8\n,11\nTEMPD,3,80.\nENDDATA\n"
    )
    joint = read_joint(path)
    (bolt,) = joint.bolts
    (spring,) = [one for one in joint.assembly.springs if one.id in bolt.elements]
    motion = displacements_of(joint.assembly, joint.assembly.loads["temperature"])
    first, second = (motion[end] for end in spring.ends)
    # The spring itself gives way by some 10⁻⁵ of the elongation that is prevented.
    force = spring.stiffness * (second - first)
    np.testing.assert_allclose(force, -YOUNGS * ALPHA * 80, rtol=1e-4)
