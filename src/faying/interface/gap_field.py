"""Initial gap fields (form error, shim, heat) at every point, from points, nodes or a file.

A field is an offset added to the geometric gap: positive where material is missing, negative where
there is too much of it (a shim, an interference).

With an initial gap the contact forces are no longer proportional to the inputs: twice the loads and
initial bolt forces do not give twice the pressures. Training boxes that scale the initial bolt
forces N₀ (``LoadBox.preload_factors``) then no longer scale the preload by the same factor; they
remain valid training loads.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.interpolate as si
import scipy.sparse as sp
from scipy.spatial import QhullError

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.exceptions import ModelError, refuse, refuse_model
from faying.files.number_table import NumberTable, read_number_table
from faying.interface.interface import Interface
from faying.model.specs import GapRule

POINT_COLUMNS = ("x", "y", "z", "gap")
NODE_COLUMNS = ("node", "gap")


def with_gap_offset(interface: Interface, offset: Vector) -> Interface:
    """Return the interface with an offset (n_point,) added to its initial gap [length].

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.lap_joint(element_size=5.0)
    >>> shimmed = with_gap_offset(model.interfaces["joint"], -0.05)
    >>> model = model.with_interfaces({"joint": shimmed})
    """
    values = np.asarray(offset, dtype=float)
    if values.shape not in {(), (interface.n_points,)} or not np.isfinite(values).all():
        refuse_model(
            f"interface '{interface.name}': a gap offset of shape {values.shape} was given; it "
            f"needs one finite number for each of its {interface.n_points} contact points"
        )
    return replace(interface, initial_gap=interface.initial_gap + values)


def gap_from_points(interface: Interface, positions: Matrix, gaps: Vector) -> Vector:
    """Interpolate measured gap offsets to the contact points (n_point,).

    Positions (n, 3) are projected onto the plane that fits the contact points best; between the
    samples (n,) [length] the field is linear on their Delaunay triangles; outside their hull it is
    the nearest sample. Interfaces that bend by more than a right angle have no such plane: give
    nodes.
    """
    samples, values = np.asarray(positions, dtype=float), np.asarray(gaps, dtype=float)
    if samples.shape != (len(values), 3) or not (
        np.isfinite(samples).all() and np.isfinite(values).all()
    ):
        refuse_model(
            f"interface '{interface.name}': {samples.shape} positions and {values.shape} gaps do "
            "not match or are not finite; give (n, 3) positions and n gaps"
        )
    centre = interface.points.mean(axis=0)
    plane = np.linalg.svd(interface.points - centre, full_matrices=False)[2][:2].T
    places, targets = (samples - centre) @ plane, (interface.points - centre) @ plane
    try:
        inside = si.LinearNDInterpolator(places, values)(targets)
    except (QhullError, ValueError):
        message = (
            f"interface '{interface.name}': the {len(values)} positions of the gap field lie on "
            "one line along the interface; give samples spread over its area"
        )
        raise ModelError(message) from None
    nearest = si.NearestNDInterpolator(places, values)(targets)
    return np.asarray(np.where(np.isnan(inside), nearest, inside))


def gap_from_nodes(
    interface: Interface, node_ids: Indices, nodes: Sequence[int], gaps: Vector
) -> Vector:
    """Interpolate gap offsets given at nodes with the shape functions of the interface (n_point,).

    Nodes (n,) are ids of either side, among all ids of the mesh (n_node,), with gaps (n,)
    [length]. If both nodes of a pair are given, their gaps add up, since each side has a form
    error. Nodes elsewhere are ignored. Between non-matching meshes the gaps of plus nodes are
    projected, and all nodes around a pair are needed.
    """
    ids, values = np.asarray(nodes, dtype=np.int64), np.asarray(gaps, dtype=float)
    if ids.shape != values.shape or not np.isfinite(values).all():
        refuse_model(
            f"interface '{interface.name}': {ids.shape} nodes and {values.shape} gaps do not "
            "match or are not finite; give one gap per node"
        )
    order = np.argsort(ids)
    ids, values = ids[order], values[order]
    if (np.diff(ids) == 0).any():
        twice = int(ids[np.argmax(np.diff(ids) == 0)])
        refuse_model(f"interface '{interface.name}': the gap field names node {twice} twice")
    listed = np.isin(node_ids, ids)
    at_nodes = np.zeros(len(node_ids))
    at_nodes[listed] = values[np.searchsorted(ids, node_ids[listed])]
    total, named = np.zeros(len(interface.pairs)), np.zeros(len(interface.pairs), dtype=bool)
    for side in _sides(interface, len(node_ids)):
        # A pair takes the gap of a side only if all nodes that it depends on are given.
        complete = abs(side) @ ~listed == 0
        total += np.where(complete, side @ at_nodes, 0.0)
        named |= complete
    missing = np.flatnonzero(~named)
    if missing.size:
        minus, plus = node_ids[interface.pairs[missing[0]]].tolist()
        refuse_model(
            f"interface '{interface.name}': the gap field has no value at {missing.size} of "
            f"{len(named)} node pairs, the first of nodes {minus} and {plus}; give one for each"
        )
    return np.asarray(interface.point_shape @ total)


def read_gap_field(path: str | Path, interface: Interface, node_ids: Indices) -> Vector:
    """Read gap offsets (n_point,) from a CSV file with the columns ``x,y,z,gap`` or ``node,gap``.

    Its first line names the columns, in any order; lines that start with # are skipped. The values
    are interpolated by :func:`gap_from_points` or :func:`gap_from_nodes`.

    Raises
    ------
    FormatError
        If the file is missing, has other columns, or values that are not finite numbers.
    ModelError
        If the field does not cover the interface.
    """
    table = read_gap_table(Path(path))
    if set(table.names) == set(POINT_COLUMNS):
        *points, gaps = map(table.column, POINT_COLUMNS)
        return gap_from_points(interface, np.column_stack(points), gaps)
    nodes, gaps = map(table.column, NODE_COLUMNS)
    if (nodes != np.round(nodes)).any():
        refuse(f"{path}: node ids must be whole numbers")
    return gap_from_nodes(interface, node_ids, nodes.astype(np.int64).tolist(), gaps)


def read_gap_table(path: Path) -> NumberTable:
    """Read the numbers of a gap field and the names of their columns."""
    return read_number_table(path, (POINT_COLUMNS, NODE_COLUMNS), "the gap field")


def _sides(interface: Interface, n_node: int) -> tuple[SparseMatrix, SparseMatrix]:
    """Return the maps from nodes of the minus and the plus side to the pairs (n_pair, n_node).

    Their difference applied to translations of the nodes is the relative displacement.
    """
    if interface.coupling is not None:
        return interface.coupling.minus, interface.coupling.plus
    n_pair = len(interface.pairs)
    minus, plus = (
        sp.csr_array((np.ones(n_pair), (np.arange(n_pair), nodes)), shape=(n_pair, n_node))
        for nodes in interface.pairs.T
    )
    return minus, plus


def with_gap_rule(
    interface: Interface, nodes: Matrix, node_ids: Indices, rule: GapRule
) -> Interface:
    """Return the interface with the initial gap from a rule.

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
    return replace(interface, initial_gap=interface.initial_gap - change + rule.offset)


def pair_gaps(interface: Interface, nodes: Matrix) -> Vector:
    """Return the gap of the mesh at the pairs (n_pair,) [length]."""
    if interface.coupling is not None:
        return interface.coupling.gap
    apart = nodes[interface.pairs[:, 1]] - nodes[interface.pairs[:, 0]]
    return np.asarray(np.einsum("pd,pd->p", apart, interface.pair_normals))
