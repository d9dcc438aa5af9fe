"""Vibrations of a joint that nothing holds, against CalculiX's *FREQUENCY."""

import os
import re
import subprocess
from dataclasses import replace

import numpy as np
from calculix_runs import needs_calculix
from scipy.spatial import cKDTree

import faying as fy
from faying.joint.lap_joint import lap_joint_assembly


def glued_deck(mesh, materials):
    """Deck of the mesh whose coincident nodes are one: what hard contact that sticks is."""
    (block,) = mesh.blocks
    order = [*range(12), *range(16, 20), *range(12, 16)]  # mid-side nodes of the top first
    tree = cKDTree(mesh.nodes)
    first = np.array([min(near) for near in tree.query_ball_point(mesh.nodes, 1e-9)])
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i + 1},{x:.12g},{y:.12g},{z:.12g}" for i, (x, y, z) in enumerate(mesh.nodes)]
    lines += ["*ELEMENT, TYPE=C3D20, ELSET=SOLID"]
    lines += [
        ",".join(map(str, row[:12])) + ",\n" + ",".join(map(str, row[12:]))
        for row in np.column_stack([np.arange(len(block.nodes)), first[block.nodes][:, order]]) + 1
    ]
    steel = materials[1]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC"]
    lines += [f"{steel.youngs_modulus},{steel.poissons_ratio}", "*DENSITY", f"{steel.density}"]
    lines += ["*SOLID SECTION, ELSET=SOLID, MATERIAL=STEEL", "*STEP", "*FREQUENCY", "12"]
    return "\n".join([*lines, "*NODE PRINT, NSET=ALL, FREQUENCY=0", "U", "*END STEP", ""])


@needs_calculix
def test_elastic_modes_are_those_of_calculix(tmp_path):
    joint = lap_joint_assembly(element_size=10.0, shape="hex20", hole_radius=0.0)
    free = replace(joint.assembly, supports=(), beams=(), rigid_couplings=())
    (tmp_path / "job.inp").write_text(glued_deck(free.mesh, free.materials))
    subprocess.run(
        ["ccx", "job"],
        cwd=tmp_path,
        check=True,
        capture_output=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    rows = re.findall(
        r"^\s+\d+\s+\S+\s+\S+\s+(\S+)\s+\S+$", (tmp_path / "job.dat").read_text(), re.MULTILINE
    )
    theirs = np.array(rows, dtype=float)
    assert (theirs[:6] < 1.0).all()
    spec = fy.InterfaceSpec(name="joint", penalty=1e10, friction=0.5)
    model = fy.with_weak_springs(fy.build_model(free, interfaces=[spec], bolts=[]), 1e-3)
    rest = fy.solve_path(model, [fy.Load()])
    glued = replace(rest, contact_forces=np.ones_like(rest.contact_forces))
    ours = fy.preloaded_frequencies(model, 6, state=glued)
    # CalculiX prints seven digits; springs of the contact yield 2e-6 of what elements do, E/h 1e10.
    np.testing.assert_allclose(ours, theirs[6:12], rtol=2e-5)
