"""Matrices with labelled rows in a common order, and the choice of M, C or K from a file."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, SparseMatrix
from faying.exceptions import FormatError, refuse_model


@dataclass(frozen=True, eq=False, kw_only=True)
class LabelledMatrix:
    """A matrix read from a file.

    Attributes
    ----------
    matrix : (n, n)
    dofs : (n, 2) or None
        Node id and component 1..6 of each row, where the file has them.
    fixed : (n_fixed, 2) or None
        Node id and component of rows that the file marks as held; ``matrix`` lacks these rows.
    """

    matrix: SparseMatrix
    dofs: Indices | None = None
    fixed: Indices | None = None


def aligned(
    matrices: dict[str, LabelledMatrix], dof_table: Indices | None
) -> tuple[dict[str, SparseMatrix], Indices | None]:
    """Return matrices ``"K"``, ``"M"``, ``"C"`` in the order of one dof table, and the table.

    A given table (n, 2) has node id and component 1..6 of each row. Without one, the table is the
    labels of K, or of the first matrix that has any, or None. Matrices without labels are assumed
    to be in this order.

    Raises
    ------
    ModelError
        If a matrix has rows that the table does not have; rows that it lacks are zero. Rows
        that K holds (:attr:`LabelledMatrix.fixed`) leave all matrices.

    Notes
    -----
    One sort of the labels and one permutation of each matrix.
    """
    table = dof_table
    if table is None:
        labels_of = [matrices[name].dofs for name in "KMC" if name in matrices]
        table = next((labels for labels in labels_of if labels is not None), None)
    if table is None:
        return {name: labelled.matrix for name, labelled in matrices.items()}, None
    lost = [labelled.fixed for labelled in matrices.values() if labelled.fixed is not None]
    fixed = np.concatenate([np.empty((0, 2), dtype=np.int64), *lost])
    return {
        name: _placed(name, labelled, table, fixed) for name, labelled in matrices.items()
    }, table


def _placed(name: str, labelled: LabelledMatrix, table: Indices, fixed: Indices) -> SparseMatrix:
    if labelled.dofs is None:
        return labelled.matrix
    if np.array_equal(labelled.dofs, table):
        return labelled.matrix
    positions = _positions(labelled.dofs, table)
    missing = np.flatnonzero((positions < 0) & (_positions(labelled.dofs, fixed) < 0))
    if missing.size:
        node, component = labelled.dofs[missing[0]].tolist()
        refuse_model(
            f"matrix {name} has a row for node {node} component {component}, which the dof table "
            "or the labels of matrix K do not have; take both matrices from one run"
        )
    present = np.flatnonzero(positions >= 0)
    n_row = len(table)
    lift = sp.csr_array(
        (np.ones(len(present)), (positions[present], present)), shape=(n_row, len(labelled.dofs))
    )
    return sp.csr_array(lift @ labelled.matrix @ lift.T)


def _positions(labels: Indices, table: Indices) -> Indices:
    """Return the row of each label (n, 2) in a table, -1 where the table lacks it."""
    if not len(table):
        return np.full(len(labels), -1)
    # Components are below ten; a table may hold other numbers, which is refused elsewhere.
    keys, sought = (10 * part[:, 0] + part[:, 1] for part in (table, labels))
    order = np.argsort(keys, kind="stable")
    ranks = np.minimum(np.searchsorted(keys, sought, sorter=order), len(keys) - 1)
    rows = order[ranks]
    return np.where((table[rows] == labels).all(axis=1), rows, -1)


LETTERS = {"M": "M", "K": "K", "C": "B"}
"""First letter of Nastran's names (KGG, MAA, BXX) per matrix."""

SQUARE, RECTANGULAR, SYMMETRIC = 1, 2, 6
"""Forms of Nastran's matrices that store every entry."""

REAL_DOUBLE = 2
"""Nastran's type of doubles."""


class DamageError(ValueError):
    """An error in a file and its position; :func:`reading` adds the name of the file."""


def damaged(text: str) -> NoReturn:
    """Raise the error of a damaged file."""
    raise DamageError(text)


@contextmanager
def reading(kind: str, path: Path) -> Iterator[None]:
    """Turn errors within the block into messages that name the matrix file."""
    try:
        yield
    except OSError as error:
        message = f"{kind} file '{path}' cannot be read ({error.strerror}); check the path"
        raise FormatError(message) from error
    except DamageError as error:
        message = f"{kind} file '{path}': {error}"
        raise FormatError(message) from error


def chosen_name(names: Sequence[str], letter_name: str) -> str:
    """Return the name of the matrix ``"M"``, ``"C"`` or ``"K"``.

    It is the given name; else the only name; else the only one that begins with the letter Nastran
    uses (M, B for damping, K).
    """
    exact = [name for name in names if name.upper() == letter_name.upper()]
    letter = LETTERS.get(letter_name, letter_name)
    for candidates in (exact, names, [name for name in names if name.upper().startswith(letter)]):
        if len(candidates) == 1:
            return candidates[0]
    damaged(
        f"it holds {', '.join(names) or 'no matrix'}; expected one matrix, or one whose name "
        f"begins with {letter}; write {letter_name} to a file of its own"
    )
