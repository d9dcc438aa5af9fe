"""Errors of matrices that cannot be factorized, with the free motion that explains them."""

from collections.abc import Callable

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector
from faying.digits import ROUND_OFF
from faying.exceptions import ModelError
from faying.linalg.interface import Factorization

MECHANISM = 1e-13
"""Strain energy of a motion over that of its nodes moved one by one, below which it is free.

It is far larger for a held structure (about (h/L)⁴, 1e-8 for a hundred elements along a beam), and
at the round-off of the product, 1e-16, for a mechanism.
"""


class NotDefiniteError(ModelError):
    """A pivot is zero or of the wrong sign."""

    def __init__(self) -> None:
        super().__init__(
            "the matrix is not positive definite: some motion has zero or negative stiffness; "
            "check the supports, and the matrices if they come from a file"
        )


class InertiaError(ModelError):
    """The signs of the pivots are not reliable."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"the negative eigenvalues cannot be counted: {reason}; choose a frequency further "
            "from the natural frequencies"
        )


class SingularMatrixError(ModelError):
    """The matrix has (nearly) no stiffness against one motion, which the error carries."""

    def __init__(self, motion: Vector, message: str = "") -> None:
        super().__init__(
            message or "the matrix is singular: the structure can move without resistance"
        )
        self.motion = motion


def check_signs(A: SparseMatrix, solve: Callable[[Vector], Vector]) -> None:
    """Check the factors of an indefinite matrix by one substitution."""
    b = np.random.default_rng(0).standard_normal(A.shape[0])
    with np.errstate(all="ignore"):
        x = solve(b)
        error = np.abs(b - A @ x).max() / (np.abs(A) @ np.abs(x) + np.abs(b)).max()
    if not error <= ROUND_OFF:
        reason = f"the factors are off by {error:.0e}"
        raise InertiaError(reason)


def softest_motion(A: SparseMatrix | Matrix, factorization: Factorization) -> tuple[Vector, float]:
    """Return the softest motion and its resistance, by two inverse iterations."""
    motion = np.random.default_rng(0).standard_normal(A.shape[0])
    diagonal = A.diagonal()
    with np.errstate(all="ignore"):
        for _ in range(2):
            motion = factorization.solve(motion)
            motion = motion / np.abs(motion).max()
        resistance = float(motion @ (A @ motion) / (motion @ (diagonal * motion)))
    return motion, abs(resistance) if np.isfinite(resistance) else 0.0
