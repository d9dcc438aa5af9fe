"""DMIG cards of a symmetric or square matrix: text any Nastran reads, of ten digits."""

import numpy as np

from faying._typing import Indices, Matrix
from faying.io.named_matrices import REAL_DOUBLE, SQUARE, SYMMETRIC
from faying.io.nastran.layout import large, small


def dmig_text(name: str, matrix: Matrix, dofs: Indices) -> str:
    """Return the DMIG cards of a matrix, the lower triangle of a symmetric one.

    Parameters
    ----------
    matrix : (n, n)
    dofs : (n, 2)
        Grid and component of each row; component 0 for scalar points.

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
