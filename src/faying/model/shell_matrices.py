"""Mass and stiffness of the shells of an assembly."""

from collections.abc import Callable, Iterator

import numpy as np

from faying._typing import Matrix, SparseMatrix
from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.elements.curved_shell import (
    CURVED_SHELLS,
    curved_matrices,
    directors,
    points_of,
    without_shear_strains,
)
from faying.model.elements.flat_shell import FLAT_SHELLS, flat_matrices
from faying.model.elements.shear_panel import panel_matrices
from faying.model.elements.shell_frames import carried, check_area, flat_frames, laws_in, on_nodes
from faying.model.node_pairs import NodePairs
from faying.model.shells import ShellBlock

PANEL = "panel4"
"""A shear panel, the one kind without membrane or bending stiffness."""

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
    _check_kind(block)
    integrate = _integrator(block)
    pattern = NodePairs.of(block.nodes, len(assembly.mesh.nodes))
    M, K = np.zeros((pattern.n_pairs, 36)), np.zeros((pattern.n_pairs, 36))
    for part in _batches(block):
        mass, stiffness = integrate(assembly, block, part)
        pattern.add(M, part, mass.reshape(-1, 36))
        pattern.add(K, part, stiffness.reshape(-1, 36))
    return pattern.expanded_six(M), pattern.expanded_six(K)


def shell_stiffness(
    assembly: Assembly, block: ShellBlock
) -> Iterator[tuple[slice, Matrix, Matrix]]:
    """Yield shells, places (n, n_node, 3) of their surface and stiffness (n, node, node, 6, 6)."""
    for part in _batches(block):
        places = assembly.mesh.nodes[block.nodes[part]]
        if block.kind in CURVED_SHELLS:
            places = places + block.offsets[part, None, None] * directors(block.kind, places)
        yield part, places, _integrator(block)(assembly, block, part)[1]


def _batches(block: ShellBlock) -> Iterator[slice]:
    for start in range(0, len(block.ids), _BATCH):
        yield slice(start, min(start + _BATCH, len(block.ids)))


def _integrator(
    block: ShellBlock,
) -> Callable[[Assembly, ShellBlock, slice], tuple[Matrix, Matrix]]:
    return _curved if block.kind in CURVED_SHELLS else _flat


def _check_kind(block: ShellBlock) -> None:
    kinds = (*FLAT_SHELLS, *CURVED_SHELLS, PANEL)
    if block.kind not in kinds:
        message = f"there is no shell '{block.kind}'; known kinds are {', '.join(kinds)}"
        raise ModelError(message)


def _flat(assembly: Assembly, block: ShellBlock, part: slice) -> tuple[Matrix, Matrix]:
    coordinates = assembly.mesh.nodes[block.nodes[part]]
    frames, local = flat_frames(coordinates, block.ids[part])
    laws = laws_in(block, part, frames, assembly.shell_sections)
    if block.kind == PANEL:
        mass, stiffness = panel_matrices(local, laws, block.ids[part])
    else:
        mass, stiffness = flat_matrices(block.kind, local[..., :2], laws)
    # Arms from the nodes to the flat surface and on to where the section refers to.
    rise = block.offsets[part, None] - local[..., 2]
    motion = carried(frames, rise[..., None] * frames[:, None, 2])
    return on_nodes(mass, motion), on_nodes(stiffness, motion)


def _curved(assembly: Assembly, block: ShellBlock, part: slice) -> tuple[Matrix, Matrix]:
    coordinates = assembly.mesh.nodes[block.nodes[part]]
    ids = block.ids[part]
    director = directors(block.kind, coordinates)
    check_area(np.asarray(np.isfinite(director).all(axis=(1, 2))), ids)
    arms = block.offsets[part, None, None] * director
    tables = {}
    for name, rule in CURVED_SHELLS[block.kind].rules.items():
        points = points_of(rule, coordinates + arms)
        # A surface that turns over within an element has normals that point apart.
        along = np.einsum("eqc,eic->eqi", points.frames[:, :, 2], director)
        check_area((along > 0).all(axis=(1, 2)) & (points.area > 0).all(axis=1), ids)
        laws = laws_in(block, part, points.frames, assembly.shell_sections)
        tables[name] = (points, without_shear_strains(laws))
    mass, stiffness = curved_matrices(block.kind, coordinates + arms, director, tables)
    axes = np.broadcast_to(np.eye(3), (*arms.shape[:2], 3, 3))
    motion = carried(axes, arms)
    return on_nodes(mass, motion), on_nodes(stiffness, motion)
