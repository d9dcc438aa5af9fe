"""Solids whose directions differ, by what CalculiX and the open Nastran `mystran` compute."""

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved
from programs import mystran, or_skip, run_mystran

from faying.io.abaqus import read_joint
from faying.io.nastran import read_deck
from faying.model.assembly import Assembly
from faying.model.elastic_law import orthotropic_law, turned
from faying.model.elements import SOLIDS
from faying.model.matrices import assemble_matrices
from solid_blocks import solid_block

# Seven digits are printed of displacements; the solvers' rounding is below.
PRINTED = 2e-6
# mystran's constants have eight digits in the deck; sums in another order beyond.
WRITTEN = 1e-6

TYPES = {
    "engineering": "ENGINEERING CONSTANTS\n16000.,900.,600.,0.4,0.45,0.35,700.,800.,\n60.",
    "ortho": "ORTHO\n5000.,1500.,3000.,900.,700.,2500.,400.,500.,\n600.",
    "ortho over temperature": (
        "ORTHO\n4000.,1400.,2500.,800.,600.,2100.,300.,400.,\n500.,0.\n"
        "6000.,1600.,3500.,1000.,800.,2900.,500.,600.,\n700.,90."
    ),
    "aniso": (
        "ANISOTROPIC\n5000.,1500.,3000.,900.,700.,2500.,100.,-50.,\n"
        "80.,400.,30.,20.,-60.,10.,500.,70.,\n-20.,40.,15.,-25.,600."
    ),
}
ORIENTATION = "*ORIENTATION,NAME=OR\n1.,2.,0.,-1.,1.,1.\n3,25.\n"
DISTRIBUTED = (
    "*DISTRIBUTION,NAME=D\n,1.,2.,0.,-1.,1.,1.\n2,0.,1.,1.,1.,0.,0.\n*ORIENTATION,NAME=OR\nD\n"
)


@needs_calculix
@pytest.mark.parametrize("name", TYPES)
@pytest.mark.parametrize(
    ("kind", "type_"), [("hex8", "C3D8I"), ("hex20", "C3D20"), ("tet10", "C3D10")]
)
def test_displacements_of_calculix(name, kind, type_, tmp_path):
    mesh = solid_block(kind, (2, 1, 3), np.array([2.0, 1.0, 3.0]), 0.0)
    (cells,) = mesh.blocks
    lines = ["*NODE,NSET=ALL"]
    lines += [f"{i},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(mesh.nodes.tolist(), 1)]
    lines.append(f"*ELEMENT,TYPE={type_},ELSET=E")
    for i, row in enumerate((SOLIDS[kind].elsewhere.theirs(cells.nodes) + 1).tolist(), 1):
        lines.append(f"{i}," + ",".join(map(str, row[:14])) + ("," if row[14:] else ""))
        lines += [",".join(map(str, row[14:]))] if row[14:] else []
    lines.append("*BOUNDARY")
    lines += [f"{i},1,3" for i in np.flatnonzero(mesh.nodes[:, 2] == 0.0) + 1]
    along = DISTRIBUTED if name == "ortho" else ORIENTATION
    lines += ["*INITIAL CONDITIONS,TYPE=TEMPERATURE\nALL,40."]
    lines += [along + f"*MATERIAL,NAME=WOOD\n*ELASTIC,TYPE={TYPES[name]}"]
    lines += ["*SOLID SECTION,ELSET=E,MATERIAL=WOOD,ORIENTATION=OR", "*STEP\n*STATIC\n*CLOAD"]
    top = np.flatnonzero(mesh.nodes[:, 2] == 3.0) + 1
    lines += [f"{i},{c},{c}." for i in top for c in (1, 2, 3)]
    text = "\n".join([*lines, "*NODE PRINT,NSET=ALL\nU\n*END STEP\n"])
    (theirs,) = displacements(tmp_path, text)
    (tmp_path / "wood.inp").write_text(text)
    assembly = read_joint(tmp_path / "wood.inp").assembly
    ours = solved(assembly)[:, :3]
    wanted = np.array([theirs[n] for n in assembly.mesh.node_ids.tolist()])
    assert np.abs(ours - wanted).max() < PRINTED * np.abs(wanted).max()


@pytest.fixture(scope="module")
def binary():
    return or_skip(mystran)


@pytest.mark.parametrize("system", ["", "7"])
def test_stiffness_of_mystran(system, binary, tmp_path):
    mesh = solid_block("hex8", (2, 1, 2), np.array([2.0, 1.0, 2.0]), 0.1)
    (cells,) = mesh.blocks
    law = np.array(turned(orthotropic_law([9.0, 2, 1], [0.3, 0.3, 0.2], np.ones(3)), skew()))
    numbers = [f"{value:.2E}".replace("E", "").replace("+00", "+0") for value in law[TRIANGLE]]
    rows = [numbers[:7], numbers[7:15], [*numbers[15:], "1.-9"]]
    cards = [
        *(f"GRID,{i},,{x:.4f},{y:.4f},{z:.4f}" for i, (x, y, z) in enumerate(mesh.nodes, 1)),
        *(
            f"CHEXA,{i},1,{','.join(map(str, row[:6]))}\n,{row[6]},{row[7]}"
            for i, row in enumerate((cells.nodes + 1).tolist(), 1)
        ),
        *(f"SPC1,1,123456,{i}" for i in np.flatnonzero(mesh.nodes[:, 2] < 0.5) + 1),
        "CORD2R,7,,0.,0.,0.,1.,1.,0.\n,0.,0.,1.",
        f"PSOLID,1,5,{system},TWO,,FULL",
        "MAT9,5," + "\n,".join(",".join(row) for row in rows),
        "EIGRL,1,,,2\nENDDATA\n",
    ]
    path = tmp_path / "wood.bdf"
    path.write_text("\n".join(["SOL 103\nCEND\nMETHOD = 1\nSPC = 1\nBEGIN BULK", *cards]))
    theirs = run_mystran(binary, path, "KGG")
    assembly: Assembly = read_deck(path)
    K = assemble_matrices(assembly).K.toarray()
    place = 6 * assembly.mesh.node_index(theirs.everything[:, 0]) + theirs.everything[:, 1] - 1
    difference = np.abs(K[np.ix_(place, place)] - theirs.matrices["KGG"]).max()
    assert difference < WRITTEN * np.abs(K).max()


TRIANGLE = np.triu_indices(6)


def skew():
    q, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))
