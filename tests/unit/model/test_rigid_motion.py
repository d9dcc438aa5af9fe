"""Motions that no stiffness resists, of structures of several parts."""

import numpy as np
import pytest

from faying.model.assembly import Assembly
from faying.model.constraints import constrain
from faying.model.matrices import assemble_matrices
from faying.model.mesh import Mesh
from faying.model.rigid_motion import free_motions, rigid_motions
from faying.model.shells import ShellBlock, ShellSection, plane_stress

THICKNESS = 0.5
SECTION = ShellSection(
    stiffness=np.kron(np.diag([THICKNESS, THICKNESS**3 / 12]), plane_stress(2.1e5, 0.3)),
    shear=5 / 6 * THICKNESS * 8e4 * np.eye(2),
    mass=1e-9,
    inertia=0.0,
)


def plates(*cells):
    """Free square shells of unit size, each a block of its own, given by where their corners are.

    Corners at the same place are one node.
    """
    corners = np.concatenate([np.add(cell, np.array(SQUARE)) for cell in cells])
    nodes, node = np.unique(corners, axis=0, return_inverse=True)
    blocks = [
        ShellBlock(
            kind="quad4",
            nodes=table[None],
            ids=[number],
            properties=[1],
            offsets=[0.0],
            directions=np.zeros((1, 3)),
        )
        for number, table in enumerate(node.reshape(-1, 4), start=1)
    ]
    return Assembly(
        mesh=Mesh(nodes=nodes, node_ids=np.arange(len(nodes))),
        shells=tuple(blocks),
        shell_sections={1: SECTION},
    )


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("cells", "parts"),
    [
        ([[0, 0, 0], [1, 0, 0], [5, 0, 2]], [2, 1]),  # the first two share a side
        ([[0, 0, 0], [3, 0, 0], [6, 0, 2]], [1, 1, 1]),
    ],
)
def test_every_part_of_shells_moves_alone(cells, parts):
    assembly = plates(*cells)
    matrices = assemble_matrices(assembly)
    dofs = constrain(assembly, np.ones(6 * len(assembly.mesh.nodes), dtype=bool))
    free = free_motions(assembly, dofs, matrices.K)
    sizes = sorted((np.bincount(free.labels) - 2) // 2, reverse=True)
    assert sizes == sorted(parts, reverse=True)
    node, component = np.divmod(dofs.free, 6)
    assert free.motions.shape[1] == 6 * len(parts)
    for label in range(len(parts)):
        # The six motions of one part, the others at rest, are among those found, to round-off.
        motions = rigid_motions(assembly.mesh.nodes[node], component, np.zeros(3))
        motions[free.labels[node] != label] = 0.0
        missed = motions - free.motions @ (free.motions.T @ motions)
        assert np.abs(missed).max() < 1e-10
