"""Compliance between many ports, Q A⁻¹ Qᵀ, by nested dissection.

Few unknowns Γ separate A into parts X. With what their elimination leaves,

    Σ = A_ΓΓ − Σ_X A_ΓX A_X⁻¹ A_XΓ,    V = Q_Γ − Σ_X Q_X A_X⁻¹ A_XΓ,
    Q A⁻¹ Qᵀ = Σ_X Q_X A_X⁻¹ Q_Xᵀ + V Σ⁻¹ Vᵀ,

and what a part contributes is its own compliance between its ports Q_X and A_ΓX: the same problem,
half as large. In one front of all that ports touch each column meets all others in every step; here
it meets them in separators alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.linalg as sla
import scipy.sparse as sp
from scipy.linalg.blas import dsyrk

from faying._typing import Indices, Mask, Matrix, SparseMatrix
from faying.linalg.interface import MatrixFactorization
from faying.linalg.separator import Separator, separator
from faying.linalg.singular import NotDefiniteError
from faying.linalg.substitution import agrees

MANY = 1.5
"""Ports over n^⅔, the size of separators of a solid, from which dissection pays.

At 1.1 to 1.2 times that one front of all ports is as good.
"""

FEW = 2
"""Ports over unknowns of a separator up to which a part is not separated further."""

SMALLEST = 1500
"""Unknowns of a part that is not separated further."""

BLOCK = 128
"""Rows of dense matrices that are moved at once."""

SparseBackend = Callable[[SparseMatrix, SparseMatrix | None], MatrixFactorization]


def has_many(shape: tuple[int, int]) -> bool:
    """Return whether the compliance between ports (n_port, n) is formed by dissection."""
    n_port, n = shape
    return n > SMALLEST and n_port > MANY * n ** (2 / 3)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class DissectedFactorization:
    """Factors of a symmetric positive definite matrix with many ports.

    Attributes
    ----------
    factor
        Of the whole matrix.
    A : (n, n)
    factorize
        Makes factors of its parts.
    """

    factor: MatrixFactorization
    A: SparseMatrix
    factorize: SparseBackend

    @property
    def backend(self) -> str:
        """Name of the library that made the factors."""
        return self.factor.backend

    @property
    def memory(self) -> int:
        """Bytes of the factors."""
        return self.factor.memory

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        return self.factor.solve(right_hand_side)

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k), of many columns by dissection.

        Notes
        -----
        The complete substitution of one random combination of columns checks it.
        """
        ports = sp.csr_array(columns.T)
        if not has_many(ports.shape):
            return self.factor.gram(columns)
        try:
            gram = dissected_gram(self.A, ports, self.factorize)
        except (NotDefiniteError, np.linalg.LinAlgError):
            return self.factor.gram(columns)
        return gram if agrees(gram, columns, self.solve) else self.factor.gram(columns)


def dissected_gram(A: SparseMatrix, ports: SparseMatrix, factorize: SparseBackend) -> Matrix:
    """Return Q A⁻¹ Qᵀ (n_port, n_port) for ports Q (n_port, n).

    Raises
    ------
    NotDefiniteError, LinAlgError
        If a pivot is not positive.
    """
    gram, place = _gram(sp.csr_array(A), sp.csr_array(ports), factorize)
    return gram if _is_sorted(place) else gram[np.ix_(place, place)]


def _gram(A: SparseMatrix, ports: SparseMatrix, factorize: SparseBackend) -> tuple[Matrix, Indices]:
    """Return Q A⁻¹ Qᵀ in an order of its own, and the place of each port in it."""
    n_port, n = ports.shape
    found = separator(A, _touched(ports)) if n > SMALLEST else None
    if found is None or n_port < FEW * len(found.unknowns):
        return factorize(A, ports).gram(ports.T), np.arange(n_port)
    order, places = _order(ports, found)
    ordered = ports[order]
    whole = _Sums(
        compliance=np.zeros((n_port, n_port)),
        coupling=ordered[:, found.unknowns].toarray(),
        separator=A[found.unknowns][:, found.unknowns].toarray(),
    )
    for part, place in zip((found.first, found.second), places, strict=True):
        rows = A[part]
        border = rows[:, found.unknowns].T.tocsr()
        whole.add(place, rows[:, part], ordered[place][:, part], border, factorize)
    return whole.closed(), np.argsort(order)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Sums:
    """Q_X A_X⁻¹ Q_Xᵀ, V and Σ, summed over parts."""

    compliance: Matrix
    coupling: Matrix
    separator: Matrix

    def add(
        self,
        place: slice,
        A: SparseMatrix,
        ports: SparseMatrix,
        border: SparseMatrix,
        factorize: SparseBackend,
    ) -> None:
        """Add what a part contributes to the ports at a place."""
        near = np.flatnonzero(np.diff(border.indptr))
        both = sp.vstack([ports, border[near]], format="csr")
        gram, order = _gram(A, both, factorize)
        inner, outer = order[: ports.shape[0]], order[ports.shape[0] :]
        _add_rows(self.compliance[place, place], gram, inner)
        self.coupling[place, near] -= gram[np.ix_(inner, outer)]
        self.separator[np.ix_(near, near)] -= gram[np.ix_(outer, outer)]

    def closed(self) -> Matrix:
        """Return the sum with V Σ⁻¹ Vᵀ."""
        if not len(self.separator):
            return self.compliance
        lower = sla.cholesky(self.separator, lower=True, overwrite_a=True)
        halves = sla.solve_triangular(lower, self.coupling.T, lower=True, overwrite_b=True)
        # In the order of numbers of BLAS it is its own transpose.
        gram = dsyrk(1.0, halves, 1.0, self.compliance.T, trans=1, lower=1, overwrite_c=1)
        return _mirrored(gram).T


def _order(ports: SparseMatrix, found: Separator) -> tuple[Indices, tuple[slice, slice]]:
    """Return ports of the first part before those of both, the second, and neither; and both."""
    first, second = (np.diff(ports[:, part].indptr) > 0 for part in (found.first, found.second))
    kind = np.select([first & ~second, first & second, second], [0, 1, 2], 3)
    ends = np.cumsum(np.bincount(kind, minlength=4))
    return np.argsort(kind, kind="stable"), (slice(0, ends[1]), slice(ends[0], ends[2]))


def _add_rows(total: Matrix, gram: Matrix, chosen: Indices) -> None:
    """Add chosen rows and columns of a symmetric matrix, some rows at a time."""
    if _is_sorted(chosen):
        total += gram[: len(chosen), : len(chosen)]
        return
    # A copy of all of them takes as long to be put into memory as to be made.
    for start in range(0, len(chosen), BLOCK):
        some = slice(start, start + BLOCK)
        total[some] += gram[chosen[some]].take(chosen, axis=1)


def _is_sorted(order: Indices) -> bool:
    return np.array_equal(order, np.arange(len(order)))


def _mirrored(lower: Matrix) -> Matrix:
    """Return a symmetric matrix in the place of its lower triangle."""
    for start in range(0, len(lower), BLOCK):
        end = start + BLOCK
        corner = lower[start:end, start:end]
        corner[:] = np.tril(corner) + np.tril(corner, -1).T
        lower[start:end, end:] = lower[end:, start:end].T
    return lower


def _touched(ports: SparseMatrix) -> Mask:
    """Return which unknowns ports touch."""
    touched: Mask = np.bincount(ports.indices, minlength=ports.shape[1]) > 0
    return touched
