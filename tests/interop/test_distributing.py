"""Nodes that move as the average of a face: CalculiX's displacements and ours, kind by kind."""

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

from faying.io.abaqus import read_joint
from faying.model.generate import brick_grid, shaped

pytestmark = needs_calculix

HEIGHT = 6.0
TYPES = {"hex8": "C3D8", "hex20": "C3D20", "tet4": "C3D4", "tet10": "C3D10"}
FACES = {
    "hex": [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
    "tet": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
}
COUPLED = "*COUPLING, REF NODE=9000, SURFACE=FACE, CONSTRAINT NAME=C\n*DISTRIBUTING\n1, 6"
OLD = "*ELEMENT, TYPE=DCOUP3D, ELSET=DC\n900, 9000\n*DISTRIBUTING COUPLING, ELSET=DC\nTOP, 1."


def deck(kind, coupling, aside, load):
    """A column, its base held, its top averaged to a node above it, perhaps beside its middle."""
    column = shaped(brick_grid(*(np.linspace(0, size, 3) for size in (2, 3, HEIGHT))), kind)
    top = np.flatnonzero(column.nodes[:, 2] > HEIGHT - 1e-9) + 1
    base = np.flatnonzero(column.nodes[:, 2] < 1e-9) + 1
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{i}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(column.nodes.tolist(), 1)]
    lines += [f"9000, {1.0 + aside!r}, 1.5, {HEIGHT + 0.5!r}"]
    lines += [f"*ELEMENT, TYPE={TYPES[kind]}, ELSET=ALL"]
    face = []
    for number, cell in enumerate((column.cells + 1).tolist(), start=1):
        # Edges of the top come before those along the height there.
        row = [number, *cell[:12], *cell[16:], *cell[12:16]] if kind == "hex20" else [number, *cell]
        lines += [", ".join(map(str, row[:16])) + "," * (len(row) > 16)]
        lines += [", ".join(map(str, row[16:]))] if len(row) > 16 else []
        for side, corners in enumerate(FACES[kind[:3]], start=1):
            if np.isin([cell[i] for i in corners], top).all():
                face.append(f"{number}, S{side}")
    lines += ["*NSET, NSET=TOP", *map(str, top.tolist()), "*NSET, NSET=BASE"]
    lines += [*map(str, base.tolist()), "*MATERIAL, NAME=S", "*ELASTIC", "1000., 0."]
    lines += ["*SOLID SECTION, ELSET=ALL, MATERIAL=S", "*SURFACE, NAME=FACE", *face, coupling]
    lines += ["*BOUNDARY", "BASE, 1, 3", "*STEP", "*STATIC", "*CLOAD", f"9000, {load}"]
    return "\n".join([*lines, "*NODE PRINT, NSET=NALL", "U", "*END STEP", ""])


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("coupling", [COUPLED, OLD], ids=["coupling", "old"])
@pytest.mark.parametrize("load", ["3, 10.", "1, 1."], ids=["pull", "shear"])
def test_average_of_a_face(kind, coupling, load, tmp_path):
    for aside in (0.0, 0.7):
        theirs = displacements(tmp_path, deck(kind, coupling, aside, load))[0]
        ours = solved(read_joint(tmp_path / "job.inp").assembly)
        expected = np.array([theirs[node] for node in range(1, len(ours))])
        # Seven digits are printed, and two columns of elements bend: 1e-6 of the largest.
        np.testing.assert_allclose(ours[:-1, :3], expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("kind", TYPES)
def test_a_central_force_stretches_uniformly(kind, tmp_path):
    """The forces at the nodes are those of a uniform pressure."""
    path = tmp_path / "job.inp"
    path.write_text(deck(kind, COUPLED, 0.0, "3, 10."))
    assembly = read_joint(path).assembly
    stretch = 10.0 / (6.0 * 1000.0)
    motion = solved(assembly)[:-1, :3]
    np.testing.assert_allclose(motion[:, 2], stretch * assembly.mesh.nodes[:-1, 2], atol=1e-12)
    np.testing.assert_allclose(motion[:, :2], 0.0, atol=1e-12)


def test_what_the_old_keyword_leaves_out_is_said(tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(deck("hex8", OLD, 0.0, "3, 10."))
    assert any("Abaqus adds rotation" in note for note in read_joint(path).assembly.ignored)
