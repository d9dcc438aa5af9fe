"""Tied surfaces: two blocks that pull at each other as one does."""

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

from faying.exceptions import FormatError
from faying.io.abaqus import read_deck, read_joint
from faying.model.elements import SOLIDS
from solid_blocks import solid_block

SIZE = np.array([2.0, 1.0, 1.5])
HEAD = """\
*MATERIAL,NAME=M
*ELASTIC
1000.,0.25
*SOLID SECTION,ELSET=A,MATERIAL=M
*SOLID SECTION,ELSET=B,MATERIAL=M
*SURFACE,NAME=SLAVE
A,S2
*SURFACE,NAME=MASTER
B,S1
*TIE,NAME=T,POSITION TOLERANCE=0.1
SLAVE,MASTER
"""
TYPES = {"hex8": "C3D8", "hex20": "C3D20", "tet10": "C3D10"}


def deck(kind, below, above, gap, rest):
    """A block on another of its own divisions; sets X, Y, Z of the planes through the corner."""
    lines, nodes, cells = [], np.empty((0, 3)), 0
    layers = []
    for name, divisions, lift in (("A", below, 0.0), ("B", above, SIZE[2] + gap)):
        mesh = solid_block(kind, divisions, SIZE)
        (block,) = mesh.blocks
        theirs = SOLIDS[kind].elsewhere.theirs(block.nodes) + 1 + len(nodes)
        layers += [f"*ELEMENT,TYPE={TYPES[kind]},ELSET={name}"]
        for i, row in enumerate(theirs.tolist(), cells + 1):
            layers += [",".join(map(str, [i, *row[:14]])) + ("," if row[14:] else "")]
            layers += [",".join(map(str, row[14:]))] if row[14:] else []
        nodes = np.vstack([nodes, mesh.nodes + np.array([0.0, 0.0, lift])])
        cells += len(theirs)
    lines = ["*NODE,NSET=ALL"]
    lines += [f"{i},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(nodes.tolist(), 1)]
    for axis, name in enumerate("XYZ"):
        lines += [f"*NSET,NSET={name}", *(f"{i + 1}," for i in np.flatnonzero(nodes[:, axis] == 0))]
    lines += ["*NSET,NSET=TOP", *(f"{i + 1}," for i in np.flatnonzero(nodes[:, 2] > 2.9))]
    return "\n".join([*lines[:1], *lines[1:], *layers]) + "\n" + HEAD + rest, nodes


PULL = """\
*BOUNDARY
X,1
Y,2
Z,3
*STEP
*STATIC
*BOUNDARY
TOP,3,3,0.003
*NODE PRINT,NSET=ALL
U
*END STEP
"""


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
@pytest.mark.parametrize("above", [(2, 2, 1), (3, 1, 1)])
def test_uniform_tension_crosses_a_tie(kind, above, tmp_path):
    """Slave nodes on planes of symmetry are held, and tied to masters that are held too."""
    text, nodes = deck(kind, (2, 2, 2), above, 0.0, PULL)
    (tmp_path / "deck.inp").write_text(text)
    assembly = read_deck(tmp_path / "deck.inp")
    strain = 0.003 / 3.0
    exact = nodes * np.array([-0.25, -0.25, 1.0]) * strain
    # The springs that move the top give a millionth.
    np.testing.assert_allclose(solved(assembly)[:, :3], exact, rtol=0, atol=2e-6 * 0.003)
    said = [note for note in assembly.ignored if note.startswith("*TIE")]
    assert len(said) == 1


@needs_calculix
@pytest.mark.parametrize("friction", ["0.2,1.E3", "0.0001,50.", "0.2"])
@pytest.mark.parametrize(
    ("kind", "above"), [("hex8", (2, 2, 1)), ("hex8", (3, 1, 1)), ("hex20", (3, 1, 1))]
)
def test_contact_pairs_tied_by_slopes_are_elastic_layers(kind, above, friction, tmp_path):
    """As soft as CalculiX's, whatever the coefficient of friction; meshes match or not."""
    load = "Z,1,2\n" + PULL.removeprefix("*BOUNDARY\nX,1\nY,2\n").replace(
        "TOP,3,3,0.003", "TOP,3,3,0.003\nTOP,1,1,0.002"
    )
    text, nodes = deck(kind, (2, 2, 1), above, 0.0, "*BOUNDARY\n" + load)
    tie = text[text.index("*TIE") : text.index("*BOUNDARY")]
    pair = (
        "*SURFACE INTERACTION,NAME=GLUE\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TIED\n4.E3\n"
        f"*FRICTION\n{friction}\n*CONTACT PAIR,INTERACTION=GLUE,TYPE=SURFACE TO SURFACE\n"
        "SLAVE,MASTER\n"
    )
    theirs = displacements(tmp_path, text.replace(tie, pair))[-1]
    joint = read_joint(tmp_path / "job.inp")
    assert joint.interfaces == ()
    assert any("GLUE, which is TIED: an elastic layer" in note for note in joint.assembly.ignored)
    wanted = np.array([theirs[i + 1] for i in range(len(nodes))])
    # Squares of bilinear motions are integrated with 3 points to a triangle here, 7 there.
    np.testing.assert_allclose(
        solved(joint.assembly)[: len(nodes), :3], wanted, rtol=0, atol=5e-5 * np.abs(wanted).max()
    )
    (tmp_path / "deck.inp").write_text(text.replace(tie, pair).replace("*FRICTION\n", "** \n** "))
    notes = read_joint(tmp_path / "deck.inp").assembly.ignored
    assert any("stick slope 500 (half of the largest E" in note for note in notes)


def test_what_lies_beyond_the_tolerance_is_not_tied(tmp_path):
    """A slave that is half as long covers what it can, and the share is said."""
    text, _ = deck("hex8", (2, 2, 2), (3, 1, 1), 0.0, PULL)
    half = text.replace("*SURFACE,NAME=MASTER\nB,S1\n", "*SURFACE,NAME=MASTER\n9,S1\n")
    (tmp_path / "deck.inp").write_text(half.replace("SLAVE,MASTER", "MASTER,SLAVE"))
    assert read_deck(tmp_path / "deck.inp").equations
    slit = text.replace("TOLERANCE=0.1", "TOLERANCE=0.01").replace("A,S2\n", "A,S2\n")
    (tmp_path / "deck.inp").write_text(slit)
    whole = read_deck(tmp_path / "deck.inp")
    assert len(whole.equations) == 3 * 9


@needs_calculix
def test_meshes_of_one_pattern_are_tied_node_by_node(tmp_path):
    """Though a corner of the slave was moved off the master, as CalculiX does without ADJUST."""
    load = PULL.replace("*BOUNDARY\nTOP,3,3,0.003", "*CLOAD\nTOP,1,0.3\nTOP,3,-0.2")
    load = load.replace("X,1\nY,2\n", "Z,1,2\n")
    text, nodes = deck("hex20", (1, 1, 1), (1, 1, 1), 0.0, load)
    corner = 1 + int(np.flatnonzero((nodes == [2.0, 1.0, 1.5]).all(axis=1))[0])
    line = ",".join([str(corner), *map(repr, nodes[corner - 1].tolist())])
    assert line in text
    moved = text.replace(line, f"{corner},2.0,1.0,1.4").replace("NAME=T,", "NAME=T,ADJUST=NO,")
    moved = moved.replace("TOLERANCE=0.1", "TOLERANCE=0.2")
    theirs = displacements(tmp_path, moved)[-1]
    assembly = read_deck(tmp_path / "job.inp")
    assert all(len(equation.terms) == 2 for equation in assembly.equations)
    ours = solved(assembly)[:, :3]
    wanted = np.array([theirs[i + 1] for i in range(len(nodes))])
    # Seven digits are printed; tied in the mean, the corner is 3e-2 off.
    np.testing.assert_allclose(ours, wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())


@needs_calculix
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_matching_meshes_are_tied_as_calculix_does(gap, tmp_path):
    """A load along the tie shears it; across a gap slave nodes are moved onto the master."""
    load = PULL.replace("*BOUNDARY\nTOP,3,3,0.003", "*CLOAD\nTOP,1,0.3\nTOP,3,-0.2")
    load = load.replace("X,1\nY,2\n", "Z,1,2\n")
    text, nodes = deck("hex8", (2, 2, 2), (2, 2, 1), gap, load)
    theirs = displacements(tmp_path, text)[-1]
    ours = solved(read_deck(tmp_path / "job.inp"))[:, :3]
    wanted = np.array([theirs[i + 1] for i in range(len(nodes))])
    # Seven digits are printed.
    np.testing.assert_allclose(ours, wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())


@pytest.mark.parametrize("above", [(2, 2, 2), (3, 1, 1)])
def test_a_tie_across_a_gap_lets_the_whole_turn(above, tmp_path):
    """As large assemblies have them, whose parts are placed by six digits."""
    text, _ = deck("hex8", (2, 2, 2), above, 1e-4, "*STEP\n*STATIC\n*END STEP\n")
    (tmp_path / "deck.inp").write_text(text)
    assembly = read_deck(tmp_path / "deck.inp")
    turned = np.cross([0.3, -0.7, 0.2], assembly.mesh.nodes)
    resisted = [sum(v * turned[n, c] for n, c, v in row.terms) for row in assembly.equations]
    # Round-off of places of 2; the gap would leave 7e-5 of a row.
    assert np.abs(resisted).max() < 1e-14


def test_a_tie_of_a_part_says_how_much_it_ties(tmp_path):
    """The upper block is half a length aside, and of other divisions."""
    text, nodes = deck("hex8", (2, 2, 2), (3, 1, 1), 0.0, PULL)
    for number, (x, y, z) in enumerate(nodes.tolist(), 1):
        if number > len(solid_block("hex8", (2, 2, 2), SIZE).nodes):
            text = text.replace(f"{number},{x!r},{y!r},{z!r}", f"{number},{x + 1.0!r},{y!r},{z!r}")
    (tmp_path / "deck.inp").write_text(text)
    notes = read_deck(tmp_path / "deck.inp").ignored
    assert "*TIE T: 50% of the smaller surface is tied" in notes


@needs_calculix
@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_single_nodes_follow_the_place_they_lie_on(kind, tmp_path):
    """An edge and a corner of the upper block, which make no facet, tied to the lower one."""
    load = PULL.replace("*BOUNDARY\nTOP,3,3,0.003", "*CLOAD\nTOP,1,0.3\nTOP,3,-0.2")
    load = load.replace("X,1\nY,2\n", "Z,1,2\n")
    text, nodes = deck(kind, (2, 1, 1), (3, 2, 1), 0.0, load)
    upper = np.arange(len(nodes)) >= len(solid_block(kind, (2, 1, 1), SIZE).nodes)
    under = 1 + np.flatnonzero(upper & (nodes[:, 2] == SIZE[2]))
    loose = [node for node in under.tolist() if nodes[node - 1, 0] == 0.0] + [int(under[-1])]
    rows = "".join(f"{node},\n" for node in loose)
    surfaces = (
        f"*NSET,NSET=LOOSE\n{rows}*SURFACE,NAME=SLAVE,TYPE=NODE\nLOOSE,\n"
        "*SURFACE,NAME=MASTER\nA,S2\n"
    )
    text = text.replace(text[text.index("*SURFACE") : text.index("*TIE")], surfaces)
    theirs = displacements(tmp_path, text)[-1]
    assembly = read_deck(tmp_path / "job.inp")
    assert "*TIE T: each slave node follows the nearest point of the master" in assembly.ignored
    ours = solved(assembly)[:, :3]
    wanted = np.array([theirs[i + 1] for i in range(len(nodes))])
    # Seven digits are printed.
    np.testing.assert_allclose(ours, wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())


def test_slave_nodes_beyond_the_tolerance_are_counted(tmp_path):
    text, nodes = deck("hex8", (2, 2, 2), (3, 1, 1), 0.0, PULL)
    text = text.replace("*SURFACE,NAME=SLAVE\nA,S2\n", "*SURFACE,NAME=SLAVE,TYPE=NODE\nX,1.\n")
    (tmp_path / "deck.inp").write_text(text)
    (note,) = [n for n in read_deck(tmp_path / "deck.inp").ignored if n.startswith("*TIE T")]
    # Of 9 and 4 nodes at x = 0, three of the slave and two of the master itself lie on it.
    beyond = int((nodes[:, 0] == 0.0).sum()) - 5
    assert note.endswith(f"; {beyond} of {beyond + 5} lie beyond 0.1 of it and do not")
    (tmp_path / "deck.inp").write_text(text.replace("B,S1", "B,S2").replace("X,1.", "Z,1."))
    with pytest.raises(FormatError, match=r"TIE: no node of slave surface 'SLAVE' lies within 0.1"):
        read_deck(tmp_path / "deck.inp")
