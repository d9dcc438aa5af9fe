"""The contact flexibility H, factorized for certificates; a singular H with its range.

Equation numbers (C…) are from ``docs/theory/certificate.md``.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, Vector
from faying.contact.dense_points import SINGULAR_PIVOT
from faying.digits import ROUND_OFF, SOLVED


@dataclass(frozen=True, eq=False, kw_only=True)
class Flexibility:
    """H = (T Tᵀ)⁺ in the form that certificates use.

    Attributes
    ----------
    H : (n_point, n_point) [length/force]
    half_inverse : (n_point, rank)
        T with H⁺ = T Tᵀ, upper triangular for a definite H.
    range_basis : (n_point, rank) or None
        Orthonormal columns that span the range of a singular H; None where H is definite.
    """

    H: Matrix
    half_inverse: Matrix
    range_basis: Matrix | None

    def half(self, gaps: Matrix, *, back: bool = False) -> Matrix:
        """Return x T (..., rank), whose square is xᵀ H⁺ x; with ``back`` x Tᵀ (..., n_point)."""
        if self.range_basis is not None:
            return np.asarray(gaps @ (self.half_inverse.T if back else self.half_inverse))
        columns = gaps.reshape(-1, gaps.shape[-1]).T
        product = la.blas.dtrmm(1.0, self.half_inverse.T, columns, lower=1, trans_a=back)
        return np.asarray(product.T.reshape(gaps.shape))

    def norms(self, functionals: Matrix) -> Vector:
        """Return √(ℓᵀ H⁺ ℓ) (k,) for force functionals ℓ (k, n_point); infinite off the range."""
        norms = np.linalg.norm(self.half(functionals), axis=-1)
        missed = np.linalg.norm(functionals - self.projected(functionals), axis=-1)
        return np.where(missed > SOLVED * np.linalg.norm(functionals, axis=-1), np.inf, norms)

    @cached_property
    def point_norms(self) -> Vector:
        """√((H⁺)_kk) (n_point,) [√(force/length)], infinite where a point's force is not unique."""
        norms = np.sqrt((self.half_inverse**2).sum(axis=1))
        if self.range_basis is None:
            return np.asarray(norms)
        missed = 1.0 - (self.range_basis**2).sum(axis=1)
        return np.where(missed > SOLVED, np.inf, norms)

    def projected(self, gaps: Matrix) -> Matrix:
        """Return gaps projected onto the range of H."""
        if self.range_basis is None:
            return gaps
        return (gaps @ self.range_basis) @ self.range_basis.T

    def admissible(self, slack: Matrix, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return z ≥ 0 near ``forces`` with s − z in the range of H, and whether it exists (...).

        A definite H admits every z. For a singular one the forces are projected and then lifted
        along the uniform opening until no entry is negative, (C16).
        """
        if self.range_basis is None:
            return forces, np.ones(forces.shape[:-1], dtype=bool)
        z = slack + self.projected(forces - slack)
        opening = self.projected(np.ones(z.shape[-1]))
        deficit = np.maximum(-z, 0.0).max(axis=-1, keepdims=True)
        possible = (deficit[..., 0] == 0) | bool(opening.min() > 0)
        lifted = z + deficit * opening / max(opening.min(), np.finfo(float).tiny)
        return np.maximum(lifted, 0.0), possible


def flexibility(H: Matrix) -> Flexibility:
    """Factorize H for certificates: Cholesky, or the eigenvectors of a singular one.

    Notes
    -----
    About ⅔ n³ multiplications; milliseconds for hundreds of points, 0.7 s for three thousand on
    one thread. Singular H (hard contact with more contact points than relative displacements) needs
    all its eigenvectors and takes tens of times as long.
    """
    H = np.asarray(H, dtype=float)
    try:
        factor = la.cholesky(H, lower=True)
        pivots = np.diag(factor)
        definite = bool(pivots.min() > SINGULAR_PIVOT * pivots.max())
    except la.LinAlgError:
        definite = False
    if definite:
        inverse, _ = la.lapack.dtrtri(factor, lower=1)
        return Flexibility(H=H, half_inverse=inverse.T, range_basis=None)
    values, vectors = la.eigh(H)
    positive = values > ROUND_OFF * values[-1]
    basis = vectors[:, positive]
    return Flexibility(H=H, half_inverse=basis / np.sqrt(values[positive]), range_basis=basis)
