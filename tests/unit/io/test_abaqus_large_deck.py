"""A deck of half a million nodes."""

import subprocess
import sys

import numpy as np
import pytest

CELLS = np.array([100, 100, 48])

SCRIPT = """
import resource, sys, time
from faying.io.abaqus import read_joint
start = time.process_time()
mesh = read_joint(sys.argv[1]).assembly.mesh
seconds = time.process_time() - start
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(len(mesh.nodes), mesh.n_elements, seconds, peak / 2**20)
"""


@pytest.mark.slow
def test_half_a_million_nodes(tmp_path):
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in CELLS), indexing="ij"), -1)
    numbers = 1 + np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    bricks = [
        numbers[a : a + CELLS[0], b : b + CELLS[1], c : c + CELLS[2]].ravel()
        for c in (0, 1)
        for a, b in corners
    ]
    path = tmp_path / "large.inp"
    with path.open("w") as file:
        file.write("*NODE, NSET=ALL\n")
        table = np.column_stack([numbers.ravel(), 1.2345678 * grid.reshape(-1, 3)])
        np.savetxt(file, table, fmt="%d, %.7e, %.7e, %.7e")
        file.write("*ELEMENT, TYPE=C3D8I, ELSET=SOLID\n")
        rows = np.column_stack([np.arange(1, len(bricks[0]) + 1), *bricks])
        np.savetxt(file, rows, fmt="%d", delimiter=", ")
        file.write("*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n*SOLID SECTION, ELSET=SOLID, MATERIAL=M\n")
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(path)], capture_output=True, text=True, check=True
    )
    nodes, elements, seconds, gibibytes = map(float, run.stdout.split())
    assert (nodes, elements) == (numbers.size, CELLS.prod())
    # Measured 5.4 s and 0.66 GB on a loaded two-core machine; the issue asks for these.
    assert seconds < 20
    assert gibibytes < 2
