"""Initial gaps of interfaces as their deck wants them."""

from dataclasses import replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.interface.interface import Interface
from faying.model.specs import GapRule


def with_gap_rule(
    interface: Interface, nodes: Matrix, node_ids: Indices, rule: GapRule
) -> Interface:
    """Return the interface with the initial gap that a rule gives it.

    Nodes (n_node, 3) [length] have ids (n_node,).
    """
    if rule.value is not None:
        return replace(interface, initial_gap=np.full(interface.n_points, rule.value))
    gap = pair_gaps(interface, nodes)
    closed = gap <= rule.closed_up_to
    closed |= np.isin(node_ids[interface.pairs[:, 0]], rule.closed_nodes)
    moved = np.where(closed, gap, 0.0)
    if interface.coupling is not None:
        change = interface.point_shape @ moved
    else:
        shift = interface.point_shape @ (moved[:, None] * interface.pair_normals)
        change = np.einsum("kd,kd->k", interface.normals, shift)
    return replace(interface, initial_gap=interface.initial_gap - change)


def pair_gaps(interface: Interface, nodes: Matrix) -> Vector:
    """Return the gap of the mesh at the pairs (n_pair,) [length]."""
    if interface.coupling is not None:
        return interface.coupling.gap
    apart = nodes[interface.pairs[:, 1]] - nodes[interface.pairs[:, 0]]
    gaps: Vector = np.einsum("pd,pd->p", apart, interface.pair_normals)
    return gaps
