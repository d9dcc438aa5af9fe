"""The stiffness between ports by sparse factors, where dense matrices would not fit.

Products with (F14) use factors of A_vv. With springs B between the ports Q of A,

    (Σ + B)⁻¹ = Q (A + Qᵀ B Q)⁻¹ Qᵀ,                                                         (F15)

by Woodbury's formula, for Σ⁻¹ = Q A⁻¹ Qᵀ (W. W. Hager, SIAM Rev. 31 (1989) 221,
doi:10.1137/1031049).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property, partial
from typing import Any, NoReturn

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, Vector, read_only
from faying.exceptions import ModelError
from faying.linalg.backends import BACKENDS, chosen_backend
from faying.linalg.factorization import factorize, factorize_saddle
from faying.linalg.interface import MatrixFactorization
from faying.linalg.relative_unknowns import with_relative_unknowns

TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False, kw_only=True)
class SparseStiffness:
    """Σ between the ports of a sparse matrix, which is never formed.

    Attributes
    ----------
    matrix : (n, n) sparse
        A, symmetric positive definite.
    ports : (n_port, n) sparse
        Q.
    solve
        Solves with A.
    """

    matrix: SparseMatrix
    ports: SparseMatrix
    solve: Callable[[Matrix], Matrix] = field(repr=False)

    @classmethod
    def of(cls, matrix: SparseMatrix, ports: SparseMatrix) -> "SparseStiffness":
        """Return Σ; the matrix is factorized at the first product with S."""
        once = cache(partial(factorize, matrix))
        return cls(matrix=matrix, ports=ports, solve=lambda forces: once().solve(forces))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without factors, which belong to this process."""
        return SparseStiffness.of, (self.matrix, self.ports)

    def gives(self, forces: Matrix) -> Matrix:
        """Return Q A⁻¹ Qᵀ p for forces p (n_port,) or (n_port, k)."""
        return np.asarray(self.ports @ self.solve(self._transposed @ forces))

    def times(self, moved: Matrix) -> Matrix:
        """Return Σ y for displacements y of the ports (n_port,) or (n_port, k)."""
        directly, across, inner = *self._blocks[:2], self._glued
        return np.asarray(directly @ moved - across @ inner.solve(across.T @ moved))

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of A_yy (n_port,), an upper bound of that of Σ."""
        return np.asarray(self._blocks[0].diagonal())

    def on_springs(
        self, springs: SparseMatrix, precision: type[np.floating[Any]] = np.float64
    ) -> MatrixFactorization:
        """Factorize A + Qᵀ B Q for symmetric springs B (n_port, n_port), in a given precision.

        Raises
        ------
        NotDefiniteError
            If A and the springs leave a motion free.
        """
        both = self.matrix + self._transposed @ springs @ self.ports
        return BACKENDS[chosen_backend()].factorize(both.tocsr().astype(precision))

    def pressing(self, rows: SparseMatrix, D: Vector) -> Callable[[Matrix], Matrix]:
        """Return a function from gaps (n_row, k) to the forces λ (n_row, k) that close them.

        Rows N (n_row, n_port) map displacements of ports to gaps, and D is their added compliance:

            [ A       (N Q)ᵀ ] [  w ]   [  0 ]
            [ N Q      −D    ] [ −λ ] = [ −g ]                                               (F16)

        without loss of digits where D is small or zero.

        Raises
        ------
        NotDefiniteError
            If gaps without compliance are linearly dependent.
        """
        G, n = (rows @ self.ports).tocsr(), self.matrix.shape[0]
        stiff = self.matrix.diagonal()
        # Rows in units of force, because pivots are compared with all entries.
        size = np.sqrt(stiff.mean() / np.maximum(D + G.multiply(G) @ (1.0 / stiff), TINY))
        G = sp.diags_array(size) @ G
        saddle = sp.block_array([[self.matrix, G.T], [G, sp.diags_array(-D * size**2)]])
        factors = factorize_saddle(saddle.tocsr())

        def closing(gaps: Matrix) -> Matrix:
            right = np.zeros((saddle.shape[0], gaps.shape[1]))
            right[n:] = -size[:, None] * gaps
            return np.asarray(-size[:, None] * factors.solve(right)[n:])

        return closing

    def moved_by(self, held: MatrixFactorization, forces: Matrix) -> Matrix:
        """Return (Σ + B)⁻¹ b for forces b (n_port,) or (n_port, k), by factors on springs B."""
        return np.asarray(self.ports @ held.solve(self._transposed @ forces))

    @cached_property
    def _transposed(self) -> SparseMatrix:
        return read_only(self.ports.T.tocsr())

    @cached_property
    def _blocks(self) -> tuple[SparseMatrix, SparseMatrix, SparseMatrix]:
        """A_yy, A_yv and A_vv."""
        unknowns = with_relative_unknowns(self.ports)
        if unknowns is None:
            refuse_dense(self.ports.shape[0])
        turned = (unknowns.T.tocsr() @ (self.matrix @ unknowns)).tocsr()
        n = turned.shape[0] - self.ports.shape[0]
        inner, below = turned[:n][:, :n].tocsr(), turned[n:]
        return below[:, n:].tocsr(), below[:, :n].tocsr(), inner

    @cached_property
    def _glued(self) -> MatrixFactorization:
        """Factors of A_vv."""
        return factorize(self._blocks[2])


def refuse_dense(n_port: int) -> NoReturn:
    """Refuse an operation that needs a dense matrix between too many ports."""
    message = (
        f"this takes dense matrices between {n_port} relative displacements, which exceed the "
        "dense budget; raise it with model.with_dense_budget, or take a coarser interface"
    )
    raise ModelError(message)
