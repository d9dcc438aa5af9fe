"""The compliance between ports by sparse factors, where dense matrices would not fit.

S = Q A⁻¹ Qᵀ + X C Xᵀ with a few shapes X: those of a free boundary, and the basis of a reduced
model. S is never formed.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NoReturn, TypeAlias

import numpy as np
import scipy.linalg as la
from scipy.linalg import lapack

from faying._typing import Matrix
from faying.digits import ROUND_OFF
from faying.linalg.sparse_stiffness import SparseStiffness, refuse_dense
from faying.linalg.substitution import symmetrized


@dataclass(frozen=True, eq=False, kw_only=True)
class SparseCompliance:
    """S of the ports of a sparse matrix.

    Attributes
    ----------
    stiffness
        (Q A⁻¹ Qᵀ)⁻¹.
    shapes : (n_port, k)
        X.
    core : (k, k)
        C, symmetric.
    """

    stiffness: SparseStiffness
    shapes: Matrix
    core: Matrix

    @classmethod
    def of(cls, stiffness: SparseStiffness) -> "SparseCompliance":
        """Return S = Q A⁻¹ Qᵀ, without shapes."""
        none = np.zeros((stiffness.ports.shape[0], 0))
        return cls(stiffness=stiffness, shapes=none, core=np.zeros((0, 0)))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""
        return len(self.shapes), len(self.shapes)

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S p for forces p (n_port,) or (n_port, k)."""
        moved = self.stiffness.gives(forces)
        return np.asarray(moved + self.shapes @ (self.core @ (self.shapes.T @ forces)))

    def __array__(self, *_: Any, **__: Any) -> NoReturn:
        """Refuse to form the dense matrix."""
        refuse_dense(len(self.shapes))

    def plus(self, shapes: Matrix, core: Matrix) -> "SparseCompliance":
        """Return S + X C Xᵀ for more shapes."""
        return replace(
            self,
            shapes=np.hstack([self.shapes, shapes]),
            core=np.asarray(la.block_diag(self.core, core)),
        )

    @cached_property
    def across(self) -> tuple[Matrix, Matrix]:
        """Z (n_shape, n_port) and M (n_shape, n_shape) of Σ = Σ₀ − zᵀ M⁻¹ z, by Woodbury.

        In shapes B that are orthonormal in Σ₀, X = B R, S is the identity plus R C Rᵀ.
        """
        if not len(self.core):
            return self.shapes.T, self.core
        resisted = self.stiffness.times(self.shapes)
        gram = self.shapes.T @ resisted
        size = np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        factor, order, rank, _ = lapack.dpstrf(gram / size / size[:, None], lower=0)
        order, triangle = order - 1, np.triu(factor)[:rank]
        rows = np.zeros((rank, len(size)))
        rows[:, order] = triangle
        changes, turns = la.eigh(rows @ (size[:, None] * self.core * size) @ rows.T)
        kept = np.abs(changes) > ROUND_OFF
        apart = resisted[:, order[:rank]] / size[order[:rank]]
        z = la.solve_triangular(triangle[:, :rank], apart.T, trans="T")
        return turns[:, kept].T @ z, np.diag((1.0 + changes[kept]) / changes[kept])


Compliance: TypeAlias = Matrix | SparseCompliance
"""A symmetric compliance between ports, formed or by sparse factors."""


def plus(compliance: Compliance, shapes: Matrix, core: Matrix) -> Compliance:
    """Return S + X C Xᵀ, dense (read-only) or by sparse factors as S is."""
    if isinstance(compliance, SparseCompliance):
        return compliance.plus(shapes, core)
    total = (shapes @ core) @ shapes.T
    total += compliance
    symmetrized(total).setflags(write=False)
    return total
