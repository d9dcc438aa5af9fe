"""Rows of several matrices brought into one order by the labels their files carry."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, SparseMatrix
from faying.exceptions import ModelError
from faying.io.labelled_matrix import LabelledMatrix


def aligned(
    matrices: dict[str, LabelledMatrix], given: Indices | None
) -> tuple[dict[str, SparseMatrix], Indices | None]:
    """Return matrices in the order of one dof table, and the table.

    Parameters
    ----------
    matrices
        ``"K"``, ``"M"``, ``"C"``, those that there are.
    given : (n, 2)
        Node id and component 1..6 of each row from a table of its own; else the labels of
        K lead, or of the first that has any. Matrices without labels are in this order already.

    Returns
    -------
    dict, ndarray (n, 2) or None
        None where there is neither a table nor a label.

    Raises
    ------
    ModelError
        If a matrix has rows that the leading order does not have; those it lacks are zero. Rows
        that K holds (:attr:`LabelledMatrix.held`) leave all matrices.

    Notes
    -----
    One sort of the labels and one permutation of each matrix.
    """
    table = given
    if table is None:
        found = [matrices[name].dofs for name in "KMC" if name in matrices]
        table = next((labels for labels in found if labels is not None), None)
    if table is None:
        return {name: one.matrix for name, one in matrices.items()}, None
    lost = [one.held for one in matrices.values() if one.held is not None]
    held = np.concatenate([np.empty((0, 2), dtype=np.int64), *lost])
    return {name: _placed(name, one, table, held) for name, one in matrices.items()}, table


def _placed(name: str, one: LabelledMatrix, table: Indices, held: Indices) -> SparseMatrix:
    if one.dofs is None:
        return one.matrix
    if np.array_equal(one.dofs, table):
        return one.matrix
    place = _positions(one.dofs, table)
    missing = np.flatnonzero((place < 0) & (_positions(one.dofs, held) < 0))
    if missing.size:
        node, component = one.dofs[missing[0]].tolist()
        message = (
            f"matrix {name} has a row for node {node} component {component}, which the dof table "
            "or the labels of matrix K do not have; take both matrices from one run"
        )
        raise ModelError(message)
    kept = np.flatnonzero(place >= 0)
    n_row = len(table)
    lift = sp.csr_array((np.ones(len(kept)), (place[kept], kept)), shape=(n_row, len(one.dofs)))
    return sp.csr_array(lift @ one.matrix @ lift.T)


def _positions(wanted: Indices, table: Indices) -> Indices:
    """Row of each label (n, 2) in a table, -1 where it is not there."""
    if not len(table):
        return np.full(len(wanted), -1)
    # Components are below ten; a table may hold other numbers, which is refused elsewhere.
    keys, sought = (10 * part[:, 0] + part[:, 1] for part in (table, wanted))
    order = np.argsort(keys, kind="stable")
    place = np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)
    found = order[place]
    result: Indices = np.where((table[found] == wanted).all(axis=1), found, -1)
    return result
