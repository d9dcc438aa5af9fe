"""One small interface to factorizations of symmetric positive definite matrices."""

from dataclasses import dataclass
from typing import Any, Protocol, final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Matrix, SparseMatrix, Vector
from faying.exceptions import ModelError

MECHANISM = 1e-13
"""Strain energy of a motion over that of its nodes moving singly; below it the motion is free.

A held structure stays far above (about (h/L)⁴, 1e-8 for a hundred elements along a beam), a
mechanism comes out at the round-off of the product, 1e-16.
"""


class Factorization(Protocol):
    """A factorized matrix that solves for many right-hand sides."""

    @property
    def backend(self) -> str:
        """Name of the library that made the factors."""
        ...

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        ...


class SingularMatrixError(ModelError):
    """The matrix has (nearly) no stiffness against one motion, which the error carries."""

    def __init__(self, motion: Vector, message: str = "") -> None:
        super().__init__(
            message or "the matrix is singular: the structure can move without resistance"
        )
        self.motion = motion


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SparseFactorization:
    """LU factors of a sparse symmetric matrix by SuperLU in its symmetric mode."""

    factors: Any
    backend: str = "superlu"

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        solution: Matrix = self.factors.solve(np.asarray(right_hand_side, dtype=np.float64))
        return solution


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class DenseFactorization:
    """Cholesky factor of a dense matrix."""

    factor: Matrix
    backend: str = "lapack"

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        solution: Matrix = la.cho_solve((self.factor, True), right_hand_side, check_finite=False)
        return solution


def factorize(A: SparseMatrix | Matrix) -> Factorization:
    """Factorize a symmetric positive definite matrix, sparse or dense.

    A matrix condensed from a larger one goes to :func:`factorize_condensed`.

    Raises
    ------
    SingularMatrixError
        If some motion meets no resistance; the error carries that motion.

    Notes
    -----
    Sparse: SuperLU with minimum-degree ordering, no pivoting; about O(n²) for solids.

    Examples
    --------
    >>> import numpy as np
    >>> factorize(np.diag([2.0, 4.0])).solve(np.array([1.0, 1.0]))
    array([0.5 , 0.25])
    """
    if sp.issparse(A):
        return _factorize_sparse(A)
    dense = np.asarray(A)
    return factorize_condensed(dense, np.diag(dense))


def factorize_condensed(A: Matrix, singly: Vector) -> Factorization:
    """Factorize ΨᵀKΨ, whose own diagonal is round-off where Ψ holds a free motion.

    Parameters
    ----------
    singly : (n,)
        ψᵀ diag(K) ψ of each column: twice its energy if all degrees of freedom moved singly.

    Raises
    ------
    SingularMatrixError
        If some motion meets no resistance; the error carries that motion.
    """
    scale = _jacobi_scale(singly)
    scaled = A * scale[:, None] * scale
    try:
        smallest_pivot = float(np.diag(la.cholesky(scaled)).min(initial=1.0)) ** 2
    except la.LinAlgError:
        smallest_pivot = 0.0
    if smallest_pivot < MECHANISM:
        vectors = np.linalg.eigh(scaled)[1]
        motion = vectors[:, 0] * scale
        raise SingularMatrixError(motion / np.abs(motion).max())
    return DenseFactorization(factor=la.cholesky(A, lower=True))


def _factorize_sparse(A: SparseMatrix) -> Factorization:
    try:
        factorization = _superlu(A)
    except RuntimeError:  # SuperLU met an exactly zero pivot
        shifted = A + 1e-10 * sp.diags_array(A.diagonal() + A.diagonal().mean())
        raise SingularMatrixError(_softest_motion(A, _superlu(shifted))[0]) from None
    motion, resistance = _softest_motion(A, factorization)
    if resistance < MECHANISM:
        raise SingularMatrixError(motion)
    return factorization


def _superlu(A: SparseMatrix) -> SparseFactorization:
    return SparseFactorization(
        factors=spla.splu(
            sp.csc_array(A),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    )


def _softest_motion(A: SparseMatrix, factorization: Factorization) -> tuple[Vector, float]:
    """Two inverse iterations from a fixed random start: the softest motion and its resistance."""
    motion = np.random.default_rng(0).standard_normal(A.shape[0])
    diagonal = A.diagonal()
    with np.errstate(all="ignore"):
        for _ in range(2):
            motion = factorization.solve(motion)
            motion = motion / np.abs(motion).max()
        resistance = float(motion @ (A @ motion) / (motion @ (diagonal * motion)))
    return motion, abs(resistance) if np.isfinite(resistance) else 0.0


def _jacobi_scale(diagonal: Vector) -> Vector:
    return 1.0 / np.sqrt(np.maximum(diagonal, np.finfo(float).tiny))
