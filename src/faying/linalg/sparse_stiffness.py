"""The stiffness between more ports than matrices between them have room for, by sparse factors.

(F14) is multiplied from factors of A_vv, and with springs B between the ports Q of A

    (Σ + B)⁻¹ = Q (A + Qᵀ B Q)⁻¹ Qᵀ,                                                         (F15)

by Woodbury's formula, for Σ⁻¹ = Q A⁻¹ Qᵀ (W. W. Hager, SIAM Rev. 31 (1989) 221,
doi:10.1137/1031049).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector, read_only
from faying.linalg.factorization import factorize, factorize_definite
from faying.linalg.interface import MatrixFactorization
from faying.linalg.relative_unknowns import with_relative_unknowns


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SparseStiffness:
    """Σ between the ports of a sparse matrix, which is never formed.

    Attributes
    ----------
    matrix : (n, n) sparse
        A, symmetric positive definite.
    ports : (n_port, n) sparse
        Q.
    unknowns : (n, n) sparse
        What takes [v, y] to displacements.
    """

    matrix: SparseMatrix
    ports: SparseMatrix
    unknowns: SparseMatrix

    @classmethod
    def of(cls, matrix: SparseMatrix, ports: SparseMatrix) -> "SparseStiffness | None":
        """Return Σ; None where ports have no degrees of freedom of their own."""
        unknowns = with_relative_unknowns(ports)
        return None if unknowns is None else cls(matrix=matrix, ports=ports, unknowns=unknowns)

    def times(self, moved: Vector) -> Vector:
        """Return Σ y (n_port,) of displacements of the ports (n_port,), by one substitution."""
        directly, across, inner = self._parts
        return np.asarray(directly @ moved - across @ inner.solve(across.T @ moved))

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of A_yy (n_port,), not below that of Σ."""
        return np.asarray(self._parts[0].diagonal())

    def on_springs(self, springs: SparseMatrix) -> MatrixFactorization:
        """Factorize A + Qᵀ B Q of symmetric springs B (n_port, n_port).

        Raises
        ------
        NotDefiniteError
            If these and A do not resist every motion.
        """
        both = self.matrix + self._transposed @ springs @ self.ports
        return factorize_definite(both.tocsr())

    def moved_by(self, held: MatrixFactorization, forces: Matrix) -> Matrix:
        """Return (Σ + B)⁻¹ b of forces (n_port,) or (n_port, k), of factors on springs B."""
        return np.asarray(self.ports @ held.solve(self._transposed @ forces))

    @cached_property
    def _transposed(self) -> SparseMatrix:
        return read_only(self.ports.T.tocsr())

    @cached_property
    def _parts(self) -> tuple[SparseMatrix, SparseMatrix, MatrixFactorization]:
        """A_yy, A_yv and factors of A_vv."""
        turned = (self.unknowns.T.tocsr() @ (self.matrix @ self.unknowns)).tocsr()
        n = turned.shape[0] - self.ports.shape[0]
        inner, below = turned[:n][:, :n].tocsr(), turned[n:]
        return below[:, n:].tocsr(), below[:, :n].tocsr(), factorize(inner)
