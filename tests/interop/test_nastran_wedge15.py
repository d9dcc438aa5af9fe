"""The fifteen-node wedge against CalculiX's C3D15, which CPENTA decks have no other witness for."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from faying.model.matrices import assemble_matrices
from solid_blocks import one_sheared_cell, solid_assembly, solid_block, solid_dofs

# C3D15 numbers the top edges before the upright ones.
ABAQUS_ORDER = (*range(9), 12, 13, 14, 9, 10, 11)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_stiffness_equals_that_of_calculix(tmp_path: Path) -> None:
    mesh = one_sheared_cell(solid_block("wedge15", (1, 1, 1), np.array([3.0, 2.0, 4.0])))
    ours = assemble_matrices(solid_assembly(mesh)).K.toarray()
    dofs = solid_dofs(15)
    stiffness = ours[dofs][:, dofs]
    rows = [f"{i + 1},{','.join(map(repr, p))}" for i, p in enumerate(mesh.nodes.tolist())]
    deck = [
        *("*NODE,NSET=ALL", *rows, "*ELEMENT,TYPE=C3D15,ELSET=E"),
        "1," + ",".join(str(i + 1) for i in ABAQUS_ORDER),
        *("*MATERIAL,NAME=S", "*ELASTIC", "210000.,.29", "*DENSITY", "7.82e-9"),
        *("*SOLID SECTION,ELSET=E,MATERIAL=S", "*STEP"),
        *("*FREQUENCY,SOLVER=MATRIXSTORAGE", "1", "*END STEP"),
    ]
    (tmp_path / "w.inp").write_text("\n".join(deck) + "\n")
    subprocess.run(["ccx", "w"], cwd=tmp_path, check=True, capture_output=True, timeout=600)
    table = np.loadtxt(tmp_path / "w.sti")
    i, j = table[:, :2].astype(int).T - 1
    theirs = np.zeros_like(stiffness)
    theirs[i, j] = theirs[j, i] = table[:, 2]
    names = (tmp_path / "w.dof").read_text().split()
    node, direction = np.array([name.split(".") for name in names], dtype=int).T
    place = 3 * (node - 1) + direction - 1
    # The same nine points; the file holds fourteen digits. (C3D15's mass is integrated by the same
    # nine points, which leaves it singular; faying's is exact.)
    difference = np.abs(theirs - stiffness[np.ix_(place, place)]).max()
    assert difference < 1e-12 * np.abs(stiffness).max()
