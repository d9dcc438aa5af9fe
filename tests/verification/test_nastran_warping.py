"""A cantilever of Nastran beams with warping points against Vlasov's torsion."""

import numpy as np
import pytest

from faying.io.nastran import read_deck
from linear_solution import displacements_of

LENGTH, WARPING, TORSION, G, E = 10.0, 30.0, 2.0, 210e3 / 2.6, 210e3
DIRECTION = np.array([1.0, 2.0, 2.0]) / 3


def _deck(n_beam: int, points: bool) -> str:
    """Return a cantilever beside a shell that is held."""
    lines = ["CEND", "SPC = 1", "BEGIN BULK", f"SPOINT,101,THRU,{101 + n_beam}"]
    for i in range(n_beam + 1):
        x, y, z = (DIRECTION * LENGTH * i / n_beam).tolist()
        lines.append(f"GRID,{i + 1},,{x:.10f},{y:.10f},{z:.10f}")
    for i in range(n_beam):
        lines.append(f"CBEAM,{i + 1},1,{i + 1},{i + 2},0.,0.,1.")
        if points:
            lines += [",,,,,,,,", f",{101 + i},{102 + i}"]
    lines += [
        *(f"PBEAM,1,1,10.,50.,50.,,{TORSION}", ",,,,,,,,", f",,,,,,,{WARPING}"),
        *(f"MAT1,1,{E},,.3", "SPC1,1,123456,1", "SPC1,1,0,101", "SPC1,1,123456,901,THRU,903"),
        *("GRID,901,,0.,0.,0.", "GRID,902,,1.,0.,0.", "GRID,903,,1.,1.,0."),
        *("CTRIA3,900,9,901,902,903", "PSHELL,9,1,.1,1,,1", "MOMENT,7,{},,1.,{},{},{}", "ENDDATA"),
    ]
    return "\n".join(lines).format(n_beam + 1, *(1000 * DIRECTION))


def _twist(tmp_path, n_beam: int, points: bool = True) -> float:
    path = tmp_path / "beam.bdf"
    path.write_text(_deck(n_beam, points))
    assembly = read_deck(path)
    u = displacements_of(assembly, assembly.loads["7"])
    return float(u[n_beam, 3:] @ DIRECTION)


def test_warping_points_hold_the_twist_of_a_root_that_does_not_warp(tmp_path):
    k = np.sqrt(G * TORSION / (E * WARPING))
    exact = 1000 / (G * TORSION) * (LENGTH - np.tanh(k * LENGTH) / k)
    errors = [abs(_twist(tmp_path, n) / exact - 1) for n in (1, 2, 4)]
    # Energy of cubic twist is wrong by the fourth power of the length, at the tip as much.
    assert errors[0] < 0.05
    assert errors[1] < errors[0] / 8
    assert errors[2] < errors[1] / 12


def test_without_points_a_section_warps_freely(tmp_path):
    # Seven digits of coordinates.
    assert _twist(tmp_path, 3, points=False) == pytest.approx(1000 * LENGTH / (G * TORSION), 1e-8)
