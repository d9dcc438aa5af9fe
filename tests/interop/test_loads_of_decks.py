"""Supports that move, rotation and temperature of CalculiX decks, by what CalculiX computes."""

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

from faying.exceptions import FormatError
from faying.io.abaqus import read_deck, read_joint
from faying.model.elements import SOLIDS
from solid_blocks import solid_block

pytestmark = needs_calculix


def block(kind, name, steps, model=""):
    """A block of 2 x 1 x 3 bricks, its lower half of another material."""
    mesh = solid_block(kind, (2, 1, 3), np.array([2.0, 1.0, 3.0]), 0.15)
    (cells,) = mesh.blocks
    lines = ["*NODE,NSET=ALL"]
    lines += [f"{i},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(mesh.nodes.tolist(), 1)]
    theirs = SOLIDS[kind].elsewhere.theirs(cells.nodes) + 1
    for set_name, low in (("LOW", True), ("HIGH", False)):
        lines.append(f"*ELEMENT,TYPE={name},ELSET={set_name}")
        for i, row in enumerate(theirs.tolist(), 1):
            if (mesh.nodes[np.array(row) - 1, 2].mean() < 1.5) == low:
                lines.append(f"{i}," + ",".join(map(str, row[:14])) + ("," if row[14:] else ""))
                lines += [",".join(map(str, row[14:]))] if row[14:] else []
    for set_name, z in (("BOTTOM", 0.0), ("TOP", 3.0)):
        ids = np.flatnonzero(np.isclose(mesh.nodes[:, 2], z)) + 1
        lines += [f"*NSET,NSET={set_name}", *(f"{i}," for i in ids)]
    return "\n".join(lines) + "\n" + MATERIALS + model + steps


MATERIALS = """\
*NODE,NSET=ALL
900,1.2,0.4,4.
901,1.2,0.4,4.
*MATERIAL,NAME=STEEL
*ELASTIC
210000.,0.3
*EXPANSION,ZERO=20.
1.2E-5
*DENSITY
7.8E-9
*MATERIAL,NAME=ALU
*ELASTIC
60000.,0.35,0.
80000.,0.3,40.
*EXPANSION
2.0E-5,0.
2.6E-5,200.
*DENSITY
2.7E-9
*SOLID SECTION,ELSET=LOW,MATERIAL=STEEL
*SOLID SECTION,ELSET=HIGH,MATERIAL=ALU
*BOUNDARY
BOTTOM,1,3
"""
PRINT = "*NODE PRINT,NSET=ALL\nU\n*END STEP\n"
ELEMENTS = [("hex8", "C3D8I"), ("hex8", "C3D8R"), ("hex20", "C3D20R"), ("tet10", "C3D10")]


def assert_same(folder, text, tolerance):
    theirs = displacements(folder, text)[-1]
    joint = read_joint(folder / "job.inp")
    load = joint.assembly.loads[joint.selected_load]
    ours = solved(type(joint.assembly)(**{**vars(joint.assembly), "loads": {"it": load}}))
    ids = joint.assembly.mesh.node_ids.tolist()
    rows = [i for i, number in enumerate(ids) if number < 900]
    wanted = np.array([theirs[ids[i]] for i in rows])
    assert np.abs(wanted).max() > 0
    np.testing.assert_allclose(
        ours[rows, :3], wanted, rtol=0, atol=tolerance * np.abs(wanted).max()
    )


@pytest.mark.parametrize(("kind", "name"), ELEMENTS)
def test_supports_that_move(kind, name, tmp_path):
    body = "*RIGID BODY,NSET=TOP,REF NODE=900,ROT NODE=901\n"
    moved = "*STEP\n*STATIC\n*BOUNDARY\n900,1,1,0.01\n901,2,2,-0.003\n900,2,2\n900,3,3\n"
    # The springs that move are a million times as stiff; CalculiX prints seven digits, and turns
    # rotations of a thousandth exactly, which squares of them measure.
    assert_same(tmp_path, block(kind, name, moved + PRINT, body), 1e-5)


@pytest.mark.parametrize(("kind", "name"), ELEMENTS)
def test_rotating_bodies(kind, name, tmp_path):
    spun = "*STEP\n*STATIC\n*DLOAD\nLOW,CENTRIF,1.E8,1.,0.,0.,0.,0.6,0.8\n"
    spun += "HIGH,CENTRIF,1.E8,1.,0.,0.,0.,0.6,0.8\n"
    # CalculiX takes one point for the load of C3D8R and four for that of C3D10, ours is exact.
    tolerance = {"C3D8R": 3e-2, "C3D10": 1e-3}.get(name, 1e-6)
    assert_same(tmp_path, block(kind, name, spun + PRINT), tolerance)


@pytest.mark.parametrize(("kind", "name"), ELEMENTS)
def test_temperatures(kind, name, tmp_path):
    start = "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nALL,20.\n"
    heated = "*STEP\n*STATIC\n*TEMPERATURE\nALL,120.\nTOP,170.\n"
    text = block(kind, name, heated + PRINT, start).replace("60000.,0.35,0.\n", "")
    text = text.replace("80000.,0.3,40.", "80000.,0.3")
    assert_same(tmp_path, text, 1e-6)


def test_constants_are_those_of_the_start(tmp_path):
    """Without a start it is 0; halfway in the table, and beyond it, CalculiX agrees."""
    pull = "*STEP\n*STATIC\n*CLOAD\nTOP,3,5.\n"
    for start, modulus in ((20.0, 70000.0), (90.0, 80000.0)):
        given = f"*INITIAL CONDITIONS,TYPE=TEMPERATURE\nALL,{start}\n"
        # A constant temperature makes CalculiX look into its tables.
        text = block("hex8", "C3D8", pull + f"*TEMPERATURE\nALL,{start}\n" + PRINT, given)
        displacements(tmp_path, text)
        cold = text.replace(f"*TEMPERATURE\nALL,{start}\n", "")
        theirs = displacements(tmp_path, text)[-1]
        (tmp_path / "job.inp").write_text(cold)
        assembly = read_deck(tmp_path / "job.inp")
        found = {m.name: m.youngs_modulus for m in assembly.materials.values()}
        assert found["ALU"] == pytest.approx(modulus)
        rows = np.flatnonzero(assembly.mesh.node_ids < 900)
        wanted = np.array([theirs[i] for i in assembly.mesh.node_ids[rows].tolist()])
        scale = np.abs(wanted).max()
        np.testing.assert_allclose(solved(assembly)[rows, :3], wanted, rtol=0, atol=1e-6 * scale)
    warmer = text.replace("*TEMPERATURE\nALL,90.0\n", "*TEMPERATURE\nALL,90.0\nTOP,20.0\n")
    (tmp_path / "job.inp").write_text(warmer)
    with pytest.raises(FormatError, match="temperature"):
        read_deck(tmp_path / "job.inp")


def test_supports_follow_the_course_of_the_steps(tmp_path):
    steps = (
        "*AMPLITUDE,NAME=A\n0.,0.,1.,0.5\n"
        "*STEP\n*STATIC\n1.,1.\n*BOUNDARY,AMPLITUDE=A\nTOP,3,3,0.02\n*END STEP\n"
        "*STEP\n*STATIC\n*BOUNDARY\nTOP,3,3,0.03\n*END STEP\n"
    )
    (tmp_path / "deck.inp").write_text(block("hex8", "C3D8", steps))
    assembly = read_deck(tmp_path / "deck.inp")
    top = assembly.mesh.node_sets["TOP"]
    for name, wanted in (("step 1", 0.01), ("step 2", 0.03)):
        one = type(assembly)(**{**vars(assembly), "loads": {"it": assembly.loads[name]}})
        # A millionth is what the springs give.
        np.testing.assert_allclose(solved(one)[top, 2], wanted, rtol=2e-6)
    (tmp_path / "deck.inp").write_text(
        block("hex8", "C3D8", steps.replace("*BOUNDARY\nTOP,3,3,0.03", "*BOUNDARY,FIXED\nTOP,3,3"))
    )
    assembly = read_deck(tmp_path / "deck.inp")
    assert list(assembly.loads) == ["step 1"]
    assert any(note.startswith("steps from 2 on: *BOUNDARY, FIXED") for note in assembly.ignored)


def test_nothing_expands_where_that_is_asked_for(tmp_path):
    start = "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nALL,20.\n"
    heated = "*STEP\n*STATIC\n*TEMPERATURE\nALL,120.\n" + PRINT
    (tmp_path / "deck.inp").write_text(block("hex8", "C3D8", heated, start))
    found = read_joint(tmp_path / "deck.inp", ignore=["temperature"]).assembly
    assert not found.loads
    assert any(note.startswith("*TEMPERATURE: nothing expands") for note in found.ignored)
