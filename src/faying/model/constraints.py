"""Constraints: couplings, equations and supports eliminated to u_node = T u_free.

Dependent degrees of freedom are replaced by independent ones, chains included. An equation is
solved for other degrees of freedom than its own in three cases: where a load enters at the
dependent one (the reference node of an RBE3), where two couplings or a support and a coupling
determine the same one, and where couplings determine each other in a circle. Redundant equations
are dropped.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector, read_only
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly
from faying.model.couplings.average import average_rows
from faying.model.couplings.equation import equation_rows
from faying.model.couplings.groups import Part, grouped
from faying.model.couplings.rigid import rigid_rows
from faying.model.couplings.rows import Rows, dof_name, stacked
from faying.model.couplings.support import fixed_components, inclined_rows
from faying.model.dofs import DofMap

NEIGHBOURS = 27
"""Nodes of the bricks around a node: elements fill K as much as a mean of √(27 n) components."""


def constrain(assembly: Assembly, used: Mask, *, keep: Indices | Sequence[int] = ()) -> DofMap:
    """Eliminate all couplings, equations and supports.

    ``used`` are the components (6 n_node,) with stiffness or mass of their own. Those in ``keep``,
    6 · node index + component, must stay free, because loads enter there. Free degrees of freedom
    are in ascending order; those without stiffness or mass that move nothing else are dropped.

    Raises
    ------
    ModelError
        If a kept component is supported, moves nothing, or is tied to other kept ones.

    Notes
    -----
    Cost: a few sparse products, as many as the longest chain of couplings; and for equations that
    are solved for other components than their own, a dense QR decomposition of those that share
    components.
    """
    n_dof = 6 * len(assembly.mesh.nodes)
    free_dofs = np.zeros(n_dof, dtype=bool)
    free_dofs[np.asarray(keep, dtype=np.int64)] = True
    fixed = fixed_components(assembly)
    rows = all_rows(assembly, used, fixed, free_dofs)
    turned = free_dofs[rows.dependent] | _in_conflict(rows, fixed)
    T = _resolve_chains(rows.taken(~turned), fixed)
    if turned.any():
        T = T @ _solve_for_others(assembly, rows.taken(turned), T, used, free_dofs)
    moving = np.zeros(n_dof, dtype=bool)
    moving[T[np.flatnonzero(used)].indices] = True
    _check_kept(assembly, free_dofs & ~moving)
    free = np.flatnonzero(moving)
    T = T[:, free].tocsr()
    T.sort_indices()
    return DofMap(transformation=read_only(T), free=free)


def movable_components(assembly: Assembly, used: Mask) -> Mask:
    """Return the components (6 n_node,) that can take a load.

    They are free, or depend on free ones; supported ones and those without any stiffness or mass
    behind them are not.
    """
    T = constrain(assembly, used).transformation
    return np.asarray(np.diff(T.indptr) > 0)


def all_rows(assembly: Assembly, used: Mask, fixed: Mask, free: Mask) -> Rows:
    """Return all couplings, equations and inclined supports, with fixed and free components."""
    rigid, equations = rigid_rows(assembly), equation_rows(assembly)
    existing = used.copy()
    for part in (rigid, equations):
        existing[part.dependent] = True
        existing[part.matrix.indices] = True
    for average in assembly.average_couplings:
        existing[6 * average.reference + np.array(average.reference_components)] = True
    rows = stacked([rigid, average_rows(assembly, existing), equations])
    _check_load(assembly, free & fixed)
    blocked = free | fixed
    blocked[rows.dependent] = True
    return stacked([rows, inclined_rows(assembly, fixed=fixed, blocked=blocked)])


def _in_conflict(rows: Rows, fixed: Mask) -> Mask:
    """Return equations whose component is fixed, belongs to an earlier one, or is in a circle."""
    first = np.zeros(len(rows.dependent), dtype=bool)
    first[np.unique(rows.dependent, return_index=True)[1]] = True
    conflict: Mask = ~first | fixed[rows.dependent]
    plain = np.flatnonzero(~conflict)
    between = rows.matrix[plain][:, rows.dependent[plain]].tocsr()
    if between.nnz:
        n_group, group = connected_components(between, connection="strong")
        if n_group < len(plain) or between.diagonal().any():
            circle = (np.bincount(group)[group] > 1) | (between.diagonal() != 0)
            conflict[plain[circle]] = True
    return conflict


def _resolve_chains(rows: Rows, fixed: Mask) -> SparseMatrix:
    """Return T (n, n) with chains resolved; columns of dependent and fixed ones are zero."""
    n_dof = len(fixed)
    dependent = np.zeros(n_dof, dtype=bool)
    dependent[rows.dependent] = True
    lift = sp.csr_array(
        (np.ones(len(rows.dependent)), (rows.dependent, np.arange(len(rows.dependent)))),
        shape=(n_dof, len(rows.dependent)),
    )
    step = sp.diags_array((~dependent & ~fixed).astype(float)) + lift @ rows.matrix
    step = _without_columns(step, fixed)
    T = step
    while dependent[T.indices].any():
        T = _without_columns(T @ step, fixed)
    return T


def _without_columns(matrix: SparseMatrix, columns: Mask) -> SparseMatrix:
    """Return a matrix with the marked columns set to zero and zeros dropped."""
    result = matrix.tocsr()
    result.data[columns[result.indices]] = 0.0
    result.eliminate_zeros()
    return result


def _solve_for_others(
    assembly: Assembly, rows: Rows, T: SparseMatrix, used: Mask, free: Mask
) -> SparseMatrix:
    """Solve equations for other components than the kept ones: v = (this) w after u = T v."""
    n_dof = len(free)
    identity = sp.csr_array(
        (np.ones(len(rows.dependent)), (np.arange(len(rows.dependent)), rows.dependent)),
        shape=(len(rows.dependent), n_dof),
    )
    plain = (identity - rows.matrix).tocsr()
    residual = _without_rounding((plain @ T).tocsr(), abs(plain).max(axis=1).toarray().ravel())
    moving = np.zeros(n_dof, dtype=bool)
    moving[T[np.flatnonzero(used)].indices] = True
    choosable = moving & ~free
    # Equations and their components as one graph: a coupling of many nodes stays sparse.
    graph = sp.block_array([[None, residual], [residual.T, None]], format="csr")
    _, group = connected_components(graph, directed=False)
    parts: list[Part] = []
    groups: list[Part] = []
    for number in np.unique(group[: len(rows.dependent)]).tolist():
        members = np.flatnonzero(group[: len(rows.dependent)] == number)
        columns = np.unique(residual[members].indices)
        dense = residual[members][:, columns].toarray()
        chosen, reduced = _eliminate(dense, choosable[columns])
        if len(_eliminate(dense, moving[columns])[0]) > len(chosen):
            _refuse_tied(assembly, rows, members)
        if len(columns) ** 2 > NEIGHBOURS * n_dof:
            means, dense, columns = _in_groups(assembly, dense, columns, choosable)
            groups += means
            chosen, reduced = _eliminate(dense, choosable[columns])
        others = np.setdiff1d(np.arange(len(columns)), chosen)
        solved = -np.linalg.solve(reduced[:, chosen], reduced[:, others])
        solution = np.asarray(solved, dtype=np.float64)
        solution[np.abs(solution) <= ROUND_OFF * np.abs(solution).max(initial=0.0)] = 0.0
        parts.append((columns[chosen], columns[others], solution))
    result = _replacement(n_dof, parts)
    return (_replacement(n_dof, groups) @ result).tocsr() if groups else result


def _in_groups(
    assembly: Assembly, equations: Matrix, columns: Indices, choosable: Mask
) -> tuple[list[Part], Matrix, Indices]:
    """Return replaced components of groups, and equations between their means, with columns."""
    nodes, components = np.divmod(columns, 6)
    bodies = np.where(choosable[columns], assembly.mesh.bodies[nodes], -1)
    parts, equations = grouped(equations, assembly.mesh.nodes[nodes], components, bodies)
    left = equations.any(axis=0)
    named = [(columns[rows], columns[others], factors) for rows, others, factors in parts]
    return named, equations[:, left], columns[left]


def _without_rounding(matrix: SparseMatrix, size: Vector) -> SparseMatrix:
    """Drop round-off in each row, of largest coefficient ``size`` before substitutions.

    Redundant equations vanish. A mean of n nodes has coefficients of a few 1/n.
    """
    rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    largest = abs(matrix).max(axis=1).toarray().ravel()
    limit = np.where(largest > SOLVED * size, ROUND_OFF * largest, largest)
    matrix.data[np.abs(matrix.data) <= limit[rows]] = 0.0
    matrix.eliminate_zeros()
    return matrix


def _replacement(n_dof: int, parts: list[Part]) -> SparseMatrix:
    """Return the identity, except for the replaced rows, which hold the solutions."""
    keep = np.setdiff1d(np.arange(n_dof), np.concatenate([rows for rows, _, _ in parts]))
    row = np.concatenate([keep, *(np.repeat(r, len(c)) for r, c, _ in parts)])
    column = np.concatenate([keep, *(np.tile(c, len(r)) for r, c, _ in parts)])
    value = np.concatenate([np.ones(len(keep)), *(s.ravel() for _, _, s in parts)])
    result = sp.coo_array((value, (row, column)), shape=(n_dof, n_dof)).tocsr()
    result.eliminate_zeros()
    return result


def _eliminate(equations: Matrix, allowed: Mask) -> tuple[Indices, Matrix]:
    """Return allowed columns that the equations determine, and the equations solved for them.

    The best conditioned columns are taken; redundant equations are dropped.
    """
    positions = np.flatnonzero(allowed)
    largest = np.abs(equations).max(axis=1, keepdims=True, initial=0.0)
    scaled = equations / np.where(largest > 0, largest, 1.0)
    if not len(positions) or not largest.any():
        return positions[:0], scaled[:0]
    basis, R, order = scipy.linalg.qr(scaled[:, positions], mode="economic", pivoting=True)
    pivots = np.abs(np.diag(R))
    rank = int((pivots > SOLVED * pivots[0]).sum())
    chosen: Indices = positions[order[:rank]]
    return chosen, basis[:, :rank].T @ scaled


def _check_load(assembly: Assembly, supported: Mask) -> None:
    if supported.any():
        refuse_model(
            "load on a fixed degree of freedom: "
            f"{dof_name(assembly, int(np.argmax(supported)))}, is supported; "
            "load another node or release the support"
        )


def _check_kept(assembly: Assembly, lost: Mask) -> None:
    if lost.any():
        refuse_model(
            f"{dof_name(assembly, int(np.argmax(lost)))}, cannot take a load: no stiffness or mass "
            "moves with it; leave the component out, or tie the node to the structure"
        )


def _refuse_tied(assembly: Assembly, rows: Rows, members: Indices) -> None:
    names = "; ".join(dof_name(assembly, dof) for dof in rows.dependent[members][:3].tolist())
    more = "; …" if len(members) > 3 else ""
    refuse_model(
        f"loads enter at components ({names}{more}) that {rows.names(members)} ties to one "
        "another or to a support, so they cannot all be free; load the coupling's reference node "
        "instead"
    )
