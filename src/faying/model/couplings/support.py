"""SPC: components held at zero, in the basic frame or in inclined axes."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, Support
from faying.model.couplings.rows import Rows, dof_name, sparse_rows


def fixed_components(assembly: Assembly) -> Mask:
    """Return the components (6 n_node,) held along basic directions."""
    fixed = np.zeros((len(assembly.mesh.nodes), 6), dtype=bool)
    for support in assembly.supports:
        for first, directions in _directions(support):
            along = np.abs(directions[_is_basic(directions)]).argmax(axis=1)
            fixed[support.nodes[:, None], first + along] = True
    return fixed.ravel()


def inclined_rows(assembly: Assembly, *, fixed: Mask, blocked: Mask) -> Rows:
    """Return supports along inclined directions as equations between components of a node.

    Each equation is solved for the component with the largest direction cosine. Fixed components (6
    n_node,) are held already and drop out of the equations; blocked ones (6 n_node,) must not
    become dependent here.
    """
    groups = _inclined_directions(assembly)
    free = ~fixed[groups.dofs]
    rows, pivots = _gauss_jordan(groups.directions * free[:, None, :], ~blocked[groups.dofs])
    left = (np.abs(rows) > SOLVED).any(axis=2) & (pivots < 0)
    if left.any():
        group = int(np.flatnonzero(left.any(axis=1))[0])
        dof = groups.dofs[group, np.argmax(np.abs(rows[group]).max(axis=0))]
        refuse_model(
            f"{groups.labels[groups.owner[group]]} holds {dof_name(assembly, int(dof))} along an "
            "inclined direction, but that component is loaded or depends on a coupling; move the "
            "load or take the node out of the coupling or the support"
        )
    which, row = np.nonzero(pivots >= 0)
    pivot = pivots[which, row]
    values = -rows[which, row]
    values[np.arange(len(pivot)), pivot] = 0.0
    shape = (len(pivot), 6 * len(assembly.mesh.nodes))
    number = np.repeat(np.arange(len(pivot)), 3)
    return Rows(
        dependent=groups.dofs[which, pivot],
        matrix=sparse_rows(shape, number, groups.dofs[which].ravel(), values.ravel()),
        owner=groups.owner[which],
        labels=groups.labels,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Groups:
    """Inclined directions per triple of translations or of rotations.

    Attributes
    ----------
    dofs : (n_group, 3)
    directions : (n_group, n_direction, 3)
        Padded with zeros.
    owner : (n_group,)
        First support of each group.
    """

    dofs: Indices
    directions: Matrix
    owner: Indices
    labels: tuple[str, ...]


def _inclined_directions(assembly: Assembly) -> _Groups:
    """Return the inclined directions of all supports by node."""
    keys, vectors, owners = [np.empty(0, np.int64)], [np.empty((0, 3))], [np.empty(0, np.int64)]
    for number, support in enumerate(assembly.supports):
        for first, directions in _directions(support):
            tilted = directions[~_is_basic(directions)]
            n = len(support.nodes)
            keys.append(np.repeat(6 * support.nodes + first, len(tilted)))
            vectors.append(np.tile(tilted, (n, 1)))
            owners.append(np.full(n * len(tilted), number))
    key, vector, owner = np.concatenate(keys), np.concatenate(vectors), np.concatenate(owners)
    order = np.argsort(key, kind="stable")
    unique, start, count = np.unique(key[order], return_index=True, return_counts=True)
    position = np.arange(len(key)) - np.repeat(start, count)
    padded = np.zeros((len(unique), int(count.max(initial=0)), 3))
    padded[np.repeat(np.arange(len(unique)), count), position] = vector[order]
    return _Groups(
        dofs=unique[:, None] + np.arange(3),
        directions=padded,
        owner=owner[order][start],
        labels=tuple(f"support {support.id}" for support in assembly.supports),
    )


def _directions(support: Support) -> list[tuple[int, Matrix]]:
    """Return first component (0 or 3) and held directions (n, 3), of translations and rotations."""
    axes = np.eye(3) if support.axes is None else np.array(support.axes, dtype=float)
    axes[np.abs(axes) <= ROUND_OFF] = 0.0
    directions = []
    for first in (0, 3):
        supported = sorted({c - first for c in support.components if first <= c < first + 3})
        # Three directions hold all basic ones.
        directions.append((first, np.eye(3) if len(supported) == 3 else axes[supported]))
    return directions


def _is_basic(directions: Matrix) -> Mask:
    """Whether each direction (n, 3) is a basic one."""
    return np.asarray(np.count_nonzero(directions, axis=1) == 1)


def _gauss_jordan(rows: Matrix, allowed: Mask) -> tuple[Matrix, Indices]:
    """Return many small systems after Gauss-Jordan elimination, pivots by size where allowed.

    Rows (n_group, n_direction, 3) have one in the pivot column, where all other rows are zero.
    Pivot columns (n_group, n_direction) are returned too, -1 for rows without one.
    """
    rows = rows.copy()
    pivots = np.full(rows.shape[:2], -1, dtype=np.int64)
    columns = allowed.copy()
    for _ in range(min(3, rows.shape[1])):
        size = np.abs(rows) * columns[:, None, :] * (pivots < 0)[:, :, None]
        flat = size.reshape(len(rows), -1)
        best = flat.argmax(axis=1)
        active = np.flatnonzero(flat.max(axis=1, initial=0.0) > SOLVED)
        row, column = np.divmod(best[active], 3)
        pivot_row = rows[active, row] / rows[active, row, column][:, None]
        factor = rows[active, :, column]
        rows[active] -= factor[:, :, None] * pivot_row[:, None, :]
        rows[active, row] = pivot_row
        pivots[active, row] = column
        columns[active, column] = False
    return rows, pivots
