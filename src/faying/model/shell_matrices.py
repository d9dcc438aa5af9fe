"""Mass and stiffness of the shells of an assembly."""

import numpy as np

from faying._typing import Matrix, SparseMatrix
from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.elements.flat_shell import FLAT_SHELLS, flat_matrices
from faying.model.elements.shell_frames import carried, flat_frames, laws_in, on_nodes
from faying.model.node_pairs import NodePairs
from faying.model.shells import ShellBlock

# Shells in one batch: their temporary arrays hold some thousand numbers each.
_BATCH = 512


def shell_matrices(assembly: Assembly, block: ShellBlock) -> tuple[SparseMatrix, SparseMatrix]:
    """Return mass and stiffness (6 n_node, 6 n_node) of a block of shells.

    Raises
    ------
    ModelError
        If a shell is collapsed, of an unknown kind, or its property has no section.

    Notes
    -----
    About 60 µs a shell.
    """
    if block.kind not in FLAT_SHELLS:
        message = f"there is no shell '{block.kind}'; known kinds are {', '.join(FLAT_SHELLS)}"
        raise ModelError(message)
    pattern = NodePairs.of(block.nodes, len(assembly.mesh.nodes))
    M, K = np.zeros((pattern.n_pairs, 36)), np.zeros((pattern.n_pairs, 36))
    for start in range(0, len(block.ids), _BATCH):
        part = slice(start, min(start + _BATCH, len(block.ids)))
        mass, stiffness = _flat(assembly, block, part)
        pattern.add(M, part, mass.reshape(-1, 36))
        pattern.add(K, part, stiffness.reshape(-1, 36))
    return pattern.expanded_six(M), pattern.expanded_six(K)


def _flat(assembly: Assembly, block: ShellBlock, part: slice) -> tuple[Matrix, Matrix]:
    coordinates = assembly.mesh.nodes[block.nodes[part]]
    frames, local = flat_frames(coordinates, block.ids[part])
    laws = laws_in(block, part, frames, assembly.shell_sections)
    mass, stiffness = flat_matrices(block.kind, local[..., :2], laws)
    # Arms from the nodes to the flat surface and on to where the section refers to.
    rise = block.offsets[part, None] - local[..., 2]
    motion = carried(frames, rise[..., None] * frames[:, None, 2])
    return on_nodes(mass, motion), on_nodes(stiffness, motion)
