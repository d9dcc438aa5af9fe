"""Rotations in matrices of CalculiX, which calls them displacements of other nodes."""

from dataclasses import replace

import numpy as np
import pytest
from programs import calculix, or_skip, run_calculix

from faying.io.abaqus import write_deck
from faying.io.matrices import matrices_assembly, read_matrices
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.matrices import assemble_matrices, mass_properties

COARSE = {"element_size": 10.0, "hole_radius": 0.0, "washer_radius": 11.0, "element": "standard"}


@pytest.fixture(scope="module")
def binary():
    return or_skip(calculix)


@pytest.mark.parametrize("options", [{}, {"washer": "rbe3"}, {"plates": 3}], ids=str)
def test_mass_of_matrices_with_rotations(options, binary, tmp_path):
    """The tip couples a face rigidly, the bolt has ends that turn: auxiliary nodes in the deck."""
    description = lap_joint_assembly(**COARSE, **options)
    path = tmp_path / "joint.inp"
    write_deck(description, path, modes=1)
    path.write_text(path.read_text().replace("*FREQUENCY", "*FREQUENCY,SOLVER=MATRIXSTORAGE"))
    run_calculix(binary, path)
    files = {key: path.with_suffix(end) for key, end in (("M", ".mas"), ("K", ".sti"))}
    read = read_matrices(**files, nodes=path)
    # The clamped face has no rows: its mass is not there, in either.
    free = replace(description.assembly, supports=())
    clamp = description.assembly.mesh.node_sets["clamp"]
    moving = np.ones(6 * len(free.mesh.nodes))
    moving[(6 * clamp[:, None] + np.arange(6)).ravel()] = 0.0
    M = assemble_matrices(free).M
    along = moving * (np.arange(len(moving)) % 6 == 0)
    expected = float(along @ (M @ along))
    found = mass_properties(read).mass
    assert found == pytest.approx(expected, rel=1e-10)  # CalculiX writes fourteen digits
    assert found < mass_properties(free).mass
    auxiliary = read.matrices.nodes[read.matrices.components >= 3]
    assert len(np.unique(auxiliary)) >= 1
    assert any("taken as their rotations 4 to 6" in note for note in read.ignored)


def test_rows_that_move_stay_as_they_are():
    """A mass on a spring to ground is no rotation, however stiff the spring."""
    nodes = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    for ground in (1e-3, 1.0, 1e12):
        K = np.kron(np.array([[1.0 + ground, -1.0], [-1.0, 1.0]]), np.eye(3))
        assembly = matrices_assembly(np.eye(6), K, nodes=nodes)
        assert set(assembly.matrices.components.tolist()) == {0, 1, 2}
        assert assembly.ignored == ()
