"""Constraints: couplings, equations and supports eliminated to u_node = T u_free.

Dependent degrees of freedom are substituted by the others, chains included. Where a load enters at
one that its coupling would make dependent (the reference node of an RBE3), the coupling is solved
for degrees of freedom of the other nodes instead, so that every load meets a free one.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Mask, Matrix, SparseMatrix, read_only
from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.couplings.average import average_rows
from faying.model.couplings.equation import equation_rows
from faying.model.couplings.rigid import rigid_rows
from faying.model.couplings.rows import Rows, dof_name, stacked
from faying.model.couplings.support import fixed_components, inclined_rows
from faying.model.dofs import DofMap

# Relative size of a pivot below which equations repeat each other.
_RANK = 1e-9
# Relative size of coefficients that are rounding of the solution of those equations.
_ROUNDING = 1e-13


def constrain(assembly: Assembly, used: Mask, *, keep: Indices | Sequence[int] = ()) -> DofMap:
    """Eliminate all couplings, equations and supports.

    Parameters
    ----------
    assembly
        Couplings and supports refer to its nodes.
    used : (6 n_node,)
        Components with stiffness or mass of their own.
    keep
        Degrees of freedom 6 · node index + component that must stay free, because loads enter
        there.

    Returns
    -------
    DofMap
        Free degrees of freedom in ascending order. Those that neither have stiffness or mass nor
        move anything that has are dropped.

    Raises
    ------
    ModelError
        If a component depends on two couplings, on itself through a chain, or is both dependent
        and supported; if a kept one is supported, moves nothing, or is tied to other kept ones.

    Notes
    -----
    Cost: a few sparse products, as many as the longest chain of couplings; and for couplings whose
    dependent component is kept, a dense QR decomposition of their equations.
    """
    n_dof = 6 * len(assembly.mesh.nodes)
    kept = np.zeros(n_dof, dtype=bool)
    kept[np.asarray(keep, dtype=np.int64)] = True
    fixed = fixed_components(assembly)
    rows = _equations(assembly, used, fixed, kept)
    turned = kept[rows.dependent]
    T = _substituted(assembly, rows.taken(~turned), fixed)
    if turned.any():
        T = T @ _turned(assembly, rows.taken(turned), T, used, kept)
    moving = np.zeros(n_dof, dtype=bool)
    moving[T[np.flatnonzero(used)].indices] = True
    _check_kept(assembly, kept & ~moving)
    free = np.flatnonzero(moving)
    T = T[:, free].tocsr()
    T.sort_indices()
    return DofMap(transformation=read_only(T), free=free)


def movable_components(assembly: Assembly, used: Mask) -> Mask:
    """Mark the components (6 n_node,) that can take a load.

    They are free, or depend on free ones; supported ones and those without any stiffness or mass
    behind them are not.

    Raises
    ------
    ModelError
        As :func:`constrain`.
    """
    T = constrain(assembly, used).transformation
    movable: Mask = np.diff(T.indptr) > 0
    return movable


def _equations(assembly: Assembly, used: Mask, fixed: Mask, kept: Mask) -> Rows:
    """Collect all equations, each dependent component determined once."""
    rigid, equations = rigid_rows(assembly), equation_rows(assembly)
    existing = used.copy()
    for part in (rigid, equations):
        existing[part.dependent] = True
        existing[part.matrix.indices] = True
    for average in assembly.average_couplings:
        existing[6 * average.reference + np.array(average.reference_components)] = True
    rows = stacked([rigid, average_rows(assembly, existing), equations])
    _check_single(assembly, rows)
    _check_unsupported(assembly, rows, fixed)
    _check_load(assembly, kept & fixed)
    blocked = kept | fixed
    blocked[rows.dependent] = True
    return stacked([rows, inclined_rows(assembly, fixed=fixed, blocked=blocked)])


def _substituted(assembly: Assembly, rows: Rows, fixed: Mask) -> SparseMatrix:
    """Resolve chains: T (n, n) with zero columns for dependent and fixed degrees of freedom."""
    n_dof = len(fixed)
    dependent = np.zeros(n_dof, dtype=bool)
    dependent[rows.dependent] = True
    _check_acyclic(assembly, rows)
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
    """Set the marked columns to zero and drop all zeros."""
    result = matrix.tocsr()
    result.data[columns[result.indices]] = 0.0
    result.eliminate_zeros()
    return result


def _turned(
    assembly: Assembly, rows: Rows, T: SparseMatrix, used: Mask, kept: Mask
) -> SparseMatrix:
    """Solve equations for components other than the kept ones: v = (this) w after u = T v."""
    n_dof = len(kept)
    own = sp.csr_array(
        (np.ones(len(rows.dependent)), (np.arange(len(rows.dependent)), rows.dependent)),
        shape=(len(rows.dependent), n_dof),
    )
    residual = ((own - rows.matrix) @ T).tocsr()
    choosable = np.zeros(n_dof, dtype=bool)
    choosable[T[np.flatnonzero(used)].indices] = True
    choosable &= ~kept
    _, group = connected_components(abs(residual) @ abs(residual).T, directed=False)
    replaced = np.zeros(n_dof, dtype=bool)
    parts = []
    for number in range(group.max() + 1):
        members = np.flatnonzero(group == number)
        columns = np.unique(residual[members].indices)
        dense = residual[members][:, columns].toarray()
        chosen = _independent_columns(dense, choosable[columns])
        if len(chosen) < len(members):
            _refuse_tied(assembly, rows, members)
        others = np.setdiff1d(np.arange(len(columns)), chosen)
        solution = -np.linalg.solve(dense[:, chosen], dense[:, others])
        solution[np.abs(solution) <= _ROUNDING * np.abs(solution).max(initial=0.0)] = 0.0
        replaced[columns[chosen]] = True
        parts.append((columns[chosen], columns[others], solution))
    return _replacement(replaced, parts)


def _replacement(replaced: Mask, parts: list[tuple[Indices, Indices, Matrix]]) -> SparseMatrix:
    """Identity, but for the replaced rows, which hold the solutions."""
    keep = np.flatnonzero(~replaced)
    row = np.concatenate([keep, *(np.repeat(r, len(c)) for r, c, _ in parts)])
    column = np.concatenate([keep, *(np.tile(c, len(r)) for r, c, _ in parts)])
    value = np.concatenate([np.ones(len(keep)), *(s.ravel() for _, _, s in parts)])
    result = sp.coo_array((value, (row, column)), shape=(len(replaced),) * 2).tocsr()
    result.eliminate_zeros()
    return result


def _independent_columns(equations: Matrix, allowed: Mask) -> Indices:
    """As many allowed columns as there are rows, the best conditioned; fewer if they depend."""
    positions = np.flatnonzero(allowed)
    if not len(positions):
        return positions
    largest = np.abs(equations).max(axis=1, keepdims=True)
    scaled = equations / np.where(largest > 0, largest, 1.0)
    R, order = scipy.linalg.qr(scaled[:, positions], mode="r", pivoting=True)
    pivots = np.abs(np.diag(R))
    chosen: Indices = positions[order[: len(pivots)][pivots > _RANK * pivots[0]]]
    return chosen


def _check_single(assembly: Assembly, rows: Rows) -> None:
    dofs, counts = np.unique(rows.dependent, return_counts=True)
    if np.any(counts > 1):
        dof = int(dofs[np.argmax(counts > 1)])
        message = (
            f"{dof_name(assembly, dof)}, depends on more than one coupling: "
            f"{rows.names(rows.dependent == dof)}; take the node out of all but one of them"
        )
        raise ModelError(message)


def _check_unsupported(assembly: Assembly, rows: Rows, fixed: Mask) -> None:
    held = fixed[rows.dependent]
    if held.any():
        dof = int(rows.dependent[np.argmax(held)])
        message = (
            f"{dof_name(assembly, dof)}, depends on {rows.names(rows.dependent == dof)} and is "
            f"held by {_supports_of(assembly, dof)} too; release the support there, or take the "
            "node out of the coupling"
        )
        raise ModelError(message)


def _supports_of(assembly: Assembly, dof: int) -> str:
    """Name the supports that hold a degree of freedom, or others of its triple if inclined."""
    node, component = divmod(dof, 6)
    triple = range(component - component % 3, component - component % 3 + 3)
    found = [
        f"support {support.id}"
        for support in assembly.supports
        if node in support.nodes
        and set(support.components).intersection([component] if support.axes is None else triple)
    ]
    return ", ".join(found)


def _check_load(assembly: Assembly, held: Mask) -> None:
    if held.any():
        message = (
            f"load on a fixed degree of freedom: {dof_name(assembly, int(np.argmax(held)))}, is "
            "supported; load another node or release the support"
        )
        raise ModelError(message)


def _check_kept(assembly: Assembly, lost: Mask) -> None:
    if lost.any():
        message = (
            f"{dof_name(assembly, int(np.argmax(lost)))}, cannot take a load: no stiffness or mass "
            "moves with it; leave the component out, or tie the node to the structure"
        )
        raise ModelError(message)


def _check_acyclic(assembly: Assembly, rows: Rows) -> None:
    between = rows.matrix[:, rows.dependent].tocsr()
    if not between.nnz:
        return
    n_group, group = connected_components(between, connection="strong")
    if n_group == between.shape[0] and not between.diagonal().any():
        return
    sizes = np.bincount(group)
    members = np.flatnonzero((sizes[group] > 1) | (between.diagonal() != 0))
    members = members[group[members] == group[members[0]]]
    message = (
        f"{dof_name(assembly, int(rows.dependent[members[0]]))}, depends on itself through "
        f"{rows.names(members)}; exchange the dependent and independent nodes of one of them"
    )
    raise ModelError(message)


def _refuse_tied(assembly: Assembly, rows: Rows, members: Indices) -> None:
    names = "; ".join(dof_name(assembly, dof) for dof in rows.dependent[members][:3].tolist())
    more = "; …" if len(members) > 3 else ""
    message = (
        f"loads enter at components ({names}{more}) that {rows.names(members)} ties to one "
        "another or to a support, so they cannot all be free; load the coupling's reference node "
        "instead"
    )
    raise ModelError(message)
