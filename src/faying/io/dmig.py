"""Nastran DMIG cards, as punched or as written by hand: matrices with labelled rows and columns.

A matrix is a header card, which says its form, and one card for every column: grid and component of
the column, then grid, component and value of every row. Scalar points have component 0; they become
component 1 here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import FormatError, refuse
from faying.io.deck_lines import lines_of_file
from faying.io.matrix_labels import (
    REAL_DOUBLE,
    SQUARE,
    SYMMETRIC,
    DamageError,
    LabelledMatrix,
    chosen_name,
)
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Cards
from faying.io.nastran.fields import large, small
from faying.io.nastran.tokenizer import read_cards

REAL = (1, 2)
_FORMS = {1: "square", 2: "rectangular", 6: "symmetric", 9: "rectangular"}


@dataclass(frozen=True, eq=False, kw_only=True)
class _Entries:
    """Entries of one matrix; positions are fields of the bulk data."""

    column: Indices
    row: Indices
    value: Vector
    position: Indices


def read_dmig(path: Path, name: str) -> LabelledMatrix:
    """Read the matrix ``"M"``, ``"C"`` or ``"K"`` of a file with DMIG cards.

    It is chosen by its name, see :func:`faying.io.matrix_labels.chosen_name`. Rows and columns are
    in ascending order of grid and component; of a symmetric matrix (form 6) both triangles are
    filled in. A value has ten digits in a punch file (sixteen columns); OP4 keeps them all.
    """
    cards, headers = _cards(path)
    try:
        return _matrix(cards, chosen_name(list(headers), name), headers)
    except DamageError as error:
        message = f"DMIG file '{path}': {error}"
        raise FormatError(message) from error


def _cards(path: Path) -> tuple[Cards, dict[str, int]]:
    """Return the DMIG cards of a file and the header of each matrix."""
    try:
        lines = lines_of_file(path)
    except OSError as error:
        message = f"DMIG file '{path}' cannot be read ({error.strerror}); check the path"
        raise FormatError(message) from error
    cards = read_cards(lines).cards().get("DMIG")
    if cards is None:
        refuse(f"'{path}' holds no DMIG card; write the matrix with PARAM,EXTOUT,DMIGPCH or so")
    return cards, _headers(cards)


def _headers(cards: Cards) -> dict[str, int]:
    grid, names = cards.integers(1), cards.words(0)
    headers: dict[str, int] = {}
    for card in np.flatnonzero(grid == 0).tolist():
        if names[card] in headers:
            message = f"matrix {names[card]} has two headers; keep one"
            raise cards.error(card, message)
        headers[names[card]] = card
    for card in np.flatnonzero(grid != 0).tolist():
        if names[card] not in headers:
            message = (
                f"a column of matrix '{names[card]}', which has no header (DMIG,{names[card]},0)"
            )
            raise cards.error(card, message)
    return headers


def _matrix(cards: Cards, name: str, headers: Mapping[str, int]) -> LabelledMatrix:
    head = cards.take(np.array([headers[name]]))
    form, kind = int(head.integers(2)[0]), int(head.integers(3)[0])
    if kind not in REAL:
        what = "is complex" if kind in (3, 4) else f"has type {kind}"
        message = f"matrix {name} {what}; expected type 1 or 2 (real): write its real part"
        raise head.error(0, message)
    if form not in (SQUARE, SYMMETRIC):
        message = (
            f"matrix {name} has form {form} ({_FORMS.get(form, 'unknown')}); expected 1 (square) "
            "or 6 (symmetric)"
        )
        raise head.error(0, message)
    mine = np.array(cards.words(0)) == name
    mine[headers[name]] = False
    entries = _entries(cards.take(mine))
    _check_twice(cards, name, entries, form)
    labels, positions = np.unique(np.append(entries.column, entries.row), return_inverse=True)
    column, row = positions[: len(entries.column)], positions[len(entries.column) :]
    value = entries.value
    if form == SYMMETRIC:
        off_diagonal = row != column
        row, column = (
            np.append(row, column[off_diagonal]),
            np.append(column, row[: len(off_diagonal)][off_diagonal]),
        )
        value = np.append(value, value[off_diagonal])
    matrix = sp.csr_array((value, (row, column)), shape=(len(labels), len(labels)))
    return LabelledMatrix(matrix=matrix, dofs=np.stack([labels // 10, labels % 10], axis=1))


def _entries(cards: Cards) -> _Entries:
    """Take the groups of four fields (grid, component, real, imaginary) behind the first."""
    if not len(cards):
        empty = np.empty(0, dtype=np.int64)
        return _Entries(column=empty, row=empty, value=np.empty(0), position=empty)
    column = _dof(cards, cards.integers(1), cards.integers(2, 0), 2)
    groups = np.maximum(cards.count // 4 - 1, 0)
    card = np.repeat(np.arange(len(cards)), groups)
    group = np.arange(len(card)) - np.repeat(np.cumsum(groups) - groups, groups) + 1
    positions = cards.start[card] + 4 * group
    fields = cards.bulk.fields
    filled = np.flatnonzero(
        ~np.logical_and.reduce([numbers.is_blank(fields[positions + i]) for i in range(4)])
    )
    card, group, positions = card[filled], group[filled], positions[filled]
    grid = _numbers(cards, card, group, 0, "a grid")
    component = _numbers(cards, card, group, 1, "a component", blank=0)
    row = _dof(cards, grid, component, 1, card, group)
    value, bad = numbers.reals(fields[positions + 2])
    imaginary, wrong = numbers.reals(fields[positions + 3])
    wrong = (wrong & ~numbers.is_blank(fields[positions + 3])) | (imaginary != 0)
    for mask, field, what in ((bad, 2, "a real number"), (wrong, 3, "nothing (it is real)")):
        if mask.any():
            first = int(np.flatnonzero(mask)[0])
            text = fields[positions[first] + field].decode("latin-1")
            raise cards.malformed(int(card[first]), int(4 * group[first]) + field, text, what)
    return _Entries(column=column[card], row=row, value=value, position=positions)


def _numbers(
    cards: Cards, card: Indices, group: Indices, field: int, what: str, blank: int | None = None
) -> Indices:
    """Return a whole number of every group; blank is ``blank`` or, without one, an error."""
    raw = cards.bulk.fields[cards.start[card] + 4 * group + field]
    values, bad = numbers.integers(raw)
    faulty = bad if blank is None else bad & ~numbers.is_blank(raw)
    if faulty.any():
        first = int(np.flatnonzero(faulty)[0])
        text = raw[first].decode("latin-1")
        raise cards.malformed(int(card[first]), int(4 * group[first]) + field, text, what)
    return np.where(bad, blank or 0, values)


def _dof(
    cards: Cards,
    grid: Indices,
    component: Indices,
    field: int,
    card: Indices | None = None,
    group: Indices | None = None,
) -> Indices:
    """Grid and component in one number; scalar points have component 0 and become 1."""
    wrong = (grid < 1) | (grid > 10**9) | (component < 0) | (component > 6)
    if wrong.any():
        first = int(np.flatnonzero(wrong)[0])
        message = f"grid {grid[first]} component {component[first]}; components are 1 to 6, or 0"
        offset = 0 if group is None else 4 * int(group[first])
        raise cards.error(first if card is None else int(card[first]), message, offset + field)
    return np.asarray(10 * grid + np.where(component == 0, 1, component))


def _check_twice(cards: Cards, name: str, entries: _Entries, form: int) -> None:
    """Refuse an entry given twice, and both of a symmetric pair."""
    row, column = entries.row, entries.column
    if form == SYMMETRIC:
        row, column = np.maximum(row, column), np.minimum(row, column)
    order = np.lexsort((row, column))
    again = (np.diff(row[order]) == 0) & (np.diff(column[order]) == 0)
    if again.any():
        first = int(order[1:][again].min())
        both = " (or its mirror image)" if form == SYMMETRIC else ""
        where = cards.bulk.where(int(entries.position[first]))
        refuse(
            f"{where}: DMIG: matrix {name}: row {row[first] // 10}-{row[first] % 10} of column "
            f"{column[first] // 10}-{column[first] % 10}{both} is given twice"
        )


def dmig_text(name: str, matrix: Matrix, dofs: Indices) -> str:
    """Return the DMIG cards of a matrix (n, n), the lower triangle of a symmetric one.

    Grid and component of each row are ``dofs`` (n, 2); component 0 for scalar points.

    Notes
    -----
    Sixteen columns hold ten to fifteen significant digits, a double has seventeen: OP4 loses none.
    """
    symmetric = np.array_equal(matrix, matrix.T)
    form = SYMMETRIC if symmetric else SQUARE
    cards = [small("DMIG", [name, 0, form, REAL_DOUBLE, 0, None, None, len(matrix)])]
    for number, column in enumerate(matrix.T):
        rows = np.flatnonzero(column)
        rows = rows[rows >= number] if symmetric else rows
        if len(rows):
            values = [name, *dofs[number].tolist(), None]
            for row in rows.tolist():
                values += [*dofs[row].tolist(), float(column[row]), None]
            cards.append(large("DMIG", values))
    return "\n".join(cards) + "\n"
