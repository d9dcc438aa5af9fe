"""Run CalculiX on a deck and read the displacements it prints."""

import os
import shutil
import subprocess

import numpy as np
import pytest

from linear_solution import displacements_of

needs_calculix = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed"
)


def displacements(folder, text):
    """Run a deck; return for each printed step a mapping of node id to displacement."""
    (folder / "job.inp").write_text(text)
    run = subprocess.run(
        ["ccx", "job"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    assert run.returncode == 0, run.stdout[-2000:]
    found = []
    for part in (folder / "job.dat").read_text().split(" displacements (vx,vy,vz)")[1:]:
        rows = [line.split() for line in part.splitlines()[1:]]
        end = next((i for i, row in enumerate(rows) if i and len(row) != 4 and rows[i - 1]), None)
        table = [row for row in rows[:end] if len(row) == 4]
        found.append({int(row[0]): np.array(row[1:], dtype=float) for row in table})
    return found


def solved(assembly):
    """Linear displacements (n_node, 6) of an assembly under its loads, without any contact."""
    (load,) = assembly.loads.values()
    return displacements_of(assembly, load)
