"""A matrix from a file, with row labels where the file has them."""

from dataclasses import dataclass

from faying._typing import Indices, SparseMatrix


@dataclass(frozen=True, eq=False, kw_only=True)
class LabelledMatrix:
    """A matrix as read.

    Attributes
    ----------
    matrix : (n, n)
    dofs : (n, 2) or None
        Node id and component 1..6 of each row, where the file says so itself.
    held : (n_held, 2) or None
        The same of rows the file marks as held, which ``matrix`` does not have.
    """

    matrix: SparseMatrix
    dofs: Indices | None = None
    held: Indices | None = None
