"""Nastran DMIG cards, as punched or as written by hand: matrices with labelled rows and columns.

A matrix has a header card with its form, and one card for every column: grid and component of the
column, then grid, component and value of every row. Component 0 of scalar points becomes 1.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix
from faying.io.deck_lines import lines_of_file
from faying.io.matrix_labels import (
    REAL_DOUBLE,
    SQUARE,
    SYMMETRIC,
    LabelledMatrix,
    chosen_name,
    damaged,
    reading,
)
from faying.io.nastran.cards import Cards
from faying.io.nastran.fields import large, small
from faying.io.nastran.tokenizer import read_cards

REAL = (1, 2)
_FORMS = {1: "square", 2: "rectangular", 6: "symmetric", 9: "rectangular"}


def read_dmig(path: Path, name: str) -> LabelledMatrix:
    """Read the matrix ``"M"``, ``"C"`` or ``"K"`` of a file with DMIG cards.

    :func:`faying.io.matrix_labels.chosen_name` chooses it by its name. Rows and columns are
    in ascending order of grid and component; both triangles of a symmetric matrix (form 6) are
    filled in. A value has ten digits in a punch file (sixteen columns); OP4 keeps them all.
    """
    with reading("DMIG", path):
        cards = read_cards(lines_of_file(path)).cards().get("DMIG")
        if cards is None:
            damaged("it has no DMIG card; write the matrix with PARAM,EXTOUT,DMIGPCH, for example")
        headers = _headers(cards)
        return _matrix(cards, chosen_name(list(headers), name), headers)


def _headers(cards: Cards) -> dict[str, int]:
    grid, names = cards.integers(1), cards.words(0)
    headers: dict[str, int] = {}
    for card in np.flatnonzero(grid == 0).tolist():
        if names[card] in headers:
            cards.refuse(card, f"matrix {names[card]} has two headers; keep one")
        headers[names[card]] = card
    for card in np.flatnonzero(grid != 0).tolist():
        if names[card] not in headers:
            cards.refuse(
                card,
                f"a column of matrix '{names[card]}', which has no header (DMIG,{names[card]},0)",
            )
    return headers


def _matrix(cards: Cards, name: str, headers: Mapping[str, int]) -> LabelledMatrix:
    head = cards.take(np.array([headers[name]]))
    form, kind = int(head.integers(2)[0]), int(head.integers(3)[0])
    if kind not in REAL:
        what = "is complex" if kind in (3, 4) else f"has type {kind}"
        head.refuse(0, f"matrix {name} {what}; expected type 1 or 2 (real): write its real part")
    if form not in (SQUARE, SYMMETRIC):
        head.refuse(
            0,
            f"matrix {name} has form {form} ({_FORMS.get(form, 'unknown')}); expected 1 (square) "
            "or 6 (symmetric)",
        )
    mine = np.array(cards.words(0)) == name
    mine[headers[name]] = False
    # Groups of grid, component, real and imaginary part, after the group of the column.
    entries = cards.take(mine).groups(4, 4)
    row, column = _dof(entries, 0), _dof(entries.whole, 1)
    value, imaginary = entries.reals(2), entries.reals(3, 0.0)
    entries.refuse_where(
        imaginary != 0,
        lambda i: f"an imaginary part {imaginary[i]:g}; expected nothing (it is real)",
        3,
    )
    labels, places = np.unique(np.stack([row, column]), return_inverse=True)
    places = places.reshape(2, -1)
    below, across = np.sort(places, axis=0)[::-1] if form == SYMMETRIC else places
    keys = len(labels) * below + across
    _, earliest, which = np.unique(keys, return_index=True, return_inverse=True)
    shown = [f"{label // 10}-{label % 10}" for label in labels.tolist()]
    both = " (or its mirror image)" if form == SYMMETRIC else ""
    entries.refuse_where(
        earliest[which] != np.arange(len(row)),
        lambda i: (
            f"matrix {name}: row {shown[below[i]]} of column {shown[across[i]]}{both} is given "
            "twice"
        ),
    )
    matrix = sp.csr_array((value, tuple(places)), shape=(len(labels), len(labels)))
    if form == SYMMETRIC:
        matrix = sp.csr_array(matrix + matrix.T - sp.diags_array(matrix.diagonal()))
    return LabelledMatrix(matrix=matrix, dofs=np.stack([labels // 10, labels % 10], axis=1))


def _dof(cards: Cards, field: int) -> Indices:
    """Return grid and component as one number each; component 0 of scalar points becomes 1."""
    grid, component = cards.integers(field), cards.integers(field + 1, 0)
    cards.refuse_where(
        (grid < 1) | (grid > 10**9) | (component < 0) | (component > 6),
        lambda i: f"grid {grid[i]} component {component[i]}; components are 1 to 6, or 0",
        field + 1,
    )
    return np.asarray(10 * grid + np.where(component == 0, 1, component))


def dmig_text(name: str, matrix: Matrix, dofs: Indices) -> str:
    """Return the DMIG cards of a matrix (n, n), the lower triangle of a symmetric one.

    Grid and component of each row are ``dofs`` (n, 2); component 0 for scalar points.

    Notes
    -----
    Sixteen columns hold 10 to 15 significant digits, a double has 17; OP4 keeps them all.
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
