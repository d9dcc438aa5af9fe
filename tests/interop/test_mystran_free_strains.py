"""Temperatures of decks, as the open Nastran `mystran` has them."""

import re
import subprocess

import numpy as np
import pytest
from programs import mystran, or_skip

from faying.io.nastran import read_joint
from linear_solution import displacements_of

BAR = (
    "".join(f"GRID,{i + 1},,{4 * (i % 3)}.,{i // 3 % 2}.,{i // 6}.\n" for i in range(12))
    + "CHEXA,1,1,1,2,5,4,7,8\n,11,10\nCHEXA,2,1,2,3,6,5,8,9\n,12,11\n"
    + "SPC1,1,123,1,4,7,10\nPSOLID,1,1,,TWO,,FULL\nFORCE,2,3,0,25.,1.,2.,3.\n"
)
STEEL = "MAT1,1,210000.,,.3,7.8-9,1.2-5,20.\n"
PLATE = (
    "".join(f"GRID,{1 + i + 3 * j},,{2 * i}.,{2 * j}.,0.\n" for j in range(3) for i in range(3))
    + "SPC1,1,123456,1\nSPC1,1,2,3\nSPC1,1,345,2,THRU,9\n"
    + "".join(f"CQUAD4,{n},1,{a},{a + 1},{a + 4},{a + 3}\n" for n, a in enumerate((1, 2, 4, 5), 1))
)
PLIES = "MAT8,1,140000.,9000.,.3,5000.,4000.,3000.,1.6-9\n,1.-5,3.-5,20.\n"
LINE = "GRID,1,,0.,0.,0.\nGRID,2,,5.,0.,0.\nSPC1,1,123456,1\n"


@pytest.mark.parametrize(
    ("cards", "tolerance"),
    [
        # Seven digits are printed.
        (f"{BAR}{STEEL}TEMPD,3,100.\n", 1e-6),
        # Of temperatures that differ in an element the mean counts here, their field there.
        (f"{BAR}{STEEL}TEMPD,3,100.\nTEMP,3,3,110.,6,110.\nTEMP,3,9,110.,12,110.\n", 1e-2),
        (f"{LINE}{STEEL}CROD,7,1,1,2\nPROD,1,1,3.,2.\nSPC1,1,23456,2\nTEMP,3,1,60.,2,140.\n", 1e-6),
        (
            f"{LINE}{STEEL}CBAR,7,1,1,2,0.,1.,0.\nPBAR,1,1,3.,2.,2.,1.\nTEMP,3,1,60.,2,140.\n",
            1e-6,
        ),
        (f"{PLATE}{STEEL}PSHELL,1,1,.5,1\nTEMPD,3,100.\n", 1e-6),
        (f"{PLATE}{PLIES}PCOMP,1,,,,,20.,,SYM\n,1,.5,0.,,1,.5,90.\nTEMPD,3,100.\n", 1e-6),
    ],
)
def test_displacements_by_temperature(tmp_path, cards, tolerance):
    selected = "LOAD=2\n" if "FORCE" in cards else ""
    path = tmp_path / "a.bdf"
    path.write_text(
        f"SOL 101\nCEND\nDISP=ALL\nSPC=1\nTEMP(LOAD)=3\n{selected}BEGIN BULK\n{cards}ENDDATA\n"
    )
    subprocess.run([or_skip(mystran), path.name], cwd=tmp_path, check=False, capture_output=True)
    printed = path.with_suffix(".F06").read_text()
    rows = re.findall(r"^ +(\d+) +0((?: +[-\d.E+]+){6}) *$", printed, re.MULTILINE)
    theirs = {int(grid): np.array(values.split(), dtype=float) for grid, values in rows}
    joint = read_joint(path)
    assembly, load = joint.assembly, joint.assembly.loads[joint.selected_load]
    ours = displacements_of(assembly, load)
    found = np.array([ours[assembly.mesh.node_index([grid])[0], :3] for grid in theirs])
    wanted = np.array([values[:3] for values in theirs.values()])
    assert len(wanted) > 1
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * np.abs(wanted).max())
