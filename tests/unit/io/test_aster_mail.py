"""Meshes of code_aster in text."""

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.mesh_files import read_mesh_file
from faying.model.assembly import Material
from faying.model.elements import SOLIDS

STEEL = Material(name="default", youngs_modulus=210e3, poissons_ratio=0.3, density=1.0)
# Edges of the mid-side nodes, corners counted from one (code_aster, document U3.01.00).
EDGES = {
    "hex20": "12 23 34 41 15 26 37 48 56 67 78 85",
    "wedge15": "12 23 31 14 25 36 45 56 64",
    "pyramid13": "12 23 34 41 15 25 35 45",
    "tet10": "12 23 31 14 24 34",
}
NAMES = {"hex": "HEXA", "wed": "PENTA", "pyr": "PYRAM", "tet": "TETRA"}
TWO = """TITRE
 two cubes, 50% of them steel
FINSF
COOR_3D NOM=INDEFINI NBOBJ= 12 NBLIGE=2
  NUMIN=1 AUTEUR=NOBODY  % a header goes on
 A0 0. 0. 0.   A1 1. 0. 0.   A2 1. 1. 0.   A3 0. 1. 0.
 B0 0. 0. 1.D0 B1 1. 0. 1.d0 B2 1. 1. 1.   B3 0. 1. 1.
 C0 0. 0. 20E-1 C1 1. 0. 2. C2 1. 1. 2.   C3 0. 1. 2.
FINSF
HEXA8
 LOW A0 A1 A2 A3
     B0 B1 B2 B3
 UP  B0 B1 B2 B3 C0 C1 C2 C3
FINSF
QUAD4
 TOP C0 C1 C2 C3
FINSF
GROUP_MA NOM=UPPER % one
 UP
FINSF
GROUP_MA
 LID TOP
FINSF
GROUP_NO NOM = FEET NBOBJ=2
 A1 A0
FINSF
FIN
nothing is read here
"""


@pytest.fixture
def read(tmp_path):
    def run(text):
        path = tmp_path / "a.mail"
        path.write_text(text)
        return read_mesh_file(path, materials={"default": STEEL})

    return run


@pytest.mark.parametrize("kind", SOLIDS)
def test_node_order(read, kind):
    element = SOLIDS[kind]
    corners = element.reference_nodes[: element.n_corners]
    edges = [(int(a) - 1, int(b) - 1) for a, b in EDGES.get(kind, "").split()]
    points = np.vstack([corners, *((corners[a] + corners[b])[None] / 2 for a, b in edges)])
    nodes = "".join(f"N{i} {x} {y} {z}\n" for i, (x, y, z) in enumerate(points.tolist()))
    name = f"{NAMES[kind[:3]]}{len(points)}"
    cell = " ".join(f"N{i}" for i in range(len(points)))
    found = read(f"COOR_3D\n{nodes}FINSF\n{name}\nM1 {cell}\nFINSF\nFIN\n")
    (block,) = found.mesh.blocks
    assert block.kind == kind
    np.testing.assert_array_equal(found.mesh.nodes[block.nodes[0]], element.reference_nodes)


def test_groups(read):
    found = read(TWO)
    np.testing.assert_array_equal(found.mesh.nodes[[4, 5, 8], 2], [1.0, 1.0, 2.0])
    sets = {name: ids.tolist() for name, ids in found.mesh.element_sets.items()}
    assert sets == {"solids": [1, 2], "UPPER": [2]}  # the lower cube is in no group
    assert found.mesh.node_sets["FEET"].tolist() == [0, 1]
    assert found.face_sets["LID"][:, :4].tolist() == [[8, 9, 10, 11]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("COOR_3D", "COOR_2D", r"coordinate sections: COOR_2D; expected one COOR_3D"),
        (" C3 0. 1. 2.", " C3 0. 1.", r":4: COOR_3D: 47 words; expected 4 each"),
        ("20E-1", "2O.", r":4: COOR_3D: a coordinate is not a number .*2O"),
        ("C1 1. 0. 2.", "C0 1. 0. 2.", r":4: COOR_3D: node 'C0' occurs twice"),
        ("B3\n UP", "B4\n UP", r":10: HEXA8: there is no node 'B4'"),
        ("\n UP\nFINSF", "\n DOWN\nFINSF", r":18: GROUP_MA: there is no cell 'DOWN'"),
        ("FIN\nnothing", "nothing", "does not end with FIN, so it is incomplete"),
        ("QUAD4", "HEXA27", r":15: HEXA27: 5 words; expected 28 each"),
        ("B3\n UP", f"{'B' * 300}\n UP", r":10: HEXA8: a word of 300 characters; .* at most 80"),
    ],
)
def test_what_is_wrong_is_named(read, old, new, message):
    assert old in TWO
    with pytest.raises(FormatError, match=message):
        read(TWO.replace(old, new))


def test_empty_lines_are_passed_once(read):
    """Looking for the end anew from each of them, through all that follow, took minutes."""
    found = read(TWO.replace("TITRE", "\n" * 300_000 + "TITRE"))
    assert len(found.mesh.nodes) == 12
