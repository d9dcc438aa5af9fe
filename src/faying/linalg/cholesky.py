"""Cholesky factorization of dense matrices by LAPACK."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg as la
from scipy.linalg import lapack

from faying._typing import Matrix, SparseMatrix, Vector
from faying.linalg.singular import MECHANISM, SingularMatrixError
from faying.linalg.substitution import BLOCK, dense


@dataclass(frozen=True, eq=False, kw_only=True)
class DenseFactorization:
    """Cholesky factor of a dense matrix."""

    factor: Matrix
    backend: str = "lapack"

    @property
    def memory(self) -> int:
        """Bytes of the factor."""
        return self.factor.nbytes

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        if 0 in right_hand_side.shape:
            return np.zeros(right_hand_side.shape)
        # SciPy's wrapper takes longer than the substitution into a reduced model.
        return np.asarray(lapack.dpotrs(self.factor, right_hand_side, lower=1)[0])

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B for B (n, k), from L⁻¹B alone."""
        if 0 in columns.shape:
            return np.zeros((columns.shape[1],) * 2)
        half = la.solve_triangular(self.factor, dense(columns), lower=True, check_finite=False)
        return np.asarray(half.T @ half)

    def inverse(self) -> Matrix:
        """Return A⁻¹, which takes twice as long as the factor."""
        return _mirrored(lapack.dpotri(self.factor, lower=1)[0])


def factorize_condensed(A: Matrix, singly: Vector) -> DenseFactorization:
    """Factorize ΨᵀKΨ, whose diagonal is round-off where Ψ contains a free motion.

    ``singly`` (n,) is ψᵀ diag(K) ψ of each column: twice the energy without coupling between
    degrees of freedom.
    """
    scale = 1.0 / np.sqrt(np.maximum(singly, np.finfo(float).tiny))
    scaled = A * scale[:, None] * scale
    try:
        smallest_pivot = float(np.diag(la.cholesky(scaled)).min(initial=1.0)) ** 2
    except la.LinAlgError:
        smallest_pivot = 0.0
    if smallest_pivot < MECHANISM:
        vectors = np.linalg.eigh(scaled)[1]
        motion = vectors[:, 0] * scale
        raise SingularMatrixError(motion / np.abs(motion).max())
    return DenseFactorization(factor=np.asfortranarray(la.cholesky(A, lower=True)))


def inverse(
    matrix: npt.NDArray[Any], smallest: float = 0.0, *, overwrite: bool = False
) -> npt.NDArray[Any]:
    """Return the inverse of a positive definite matrix, by Cholesky, in its precision; read-only.

    With ``overwrite`` the matrix is destroyed.
    """
    # LAPACK works in column order; the transpose of a symmetric matrix is the same.
    factorize, invert = la.get_lapack_funcs(("potrf", "potri"), (matrix,))
    lower, failed = factorize(matrix.T, lower=1, clean=0, overwrite_a=overwrite)
    pivots = np.diag(lower)
    if failed or pivots.min(initial=np.inf) ** 2 < smallest * pivots.max(initial=0.0) ** 2:
        message = "the matrix is not positive definite"
        raise la.LinAlgError(message)
    return _mirrored(invert(lower, lower=1, overwrite_c=1)[0])


def _mirrored(lower: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a symmetric matrix, read-only, of which the lower triangle is given."""
    whole = lower.T
    for row in range(0, len(whole), BLOCK):
        strip = slice(row, row + BLOCK)
        whole[row + BLOCK :, strip] = whole[strip, row + BLOCK :].T
        corner = whole[strip, strip]
        whole[strip, strip] = np.triu(corner) + np.triu(corner, 1).T
    whole.setflags(write=False)
    return whole
