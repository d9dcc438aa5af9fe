"""The contact flexibility H as certificates use it: by pairs, dense, or singular with its range.

Equation numbers (C…) are from ``docs/theory/certificate.md``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.dense_points import SINGULAR_PIVOT
from faying.contact.point_springs import PointSprings
from faying.digits import ROUND_OFF, SOLVED
from faying.joint.system import Joint
from faying.linalg.cholesky import DenseFactorization
from faying.linalg.pieces import pieces


class Flexibility(Protocol):
    """H and what certificates ask of it."""

    @property
    def unique(self) -> bool:
        """Whether H is definite, so that gaps determine the force at each point."""
        ...

    @property
    def point_norms(self) -> Vector:
        """√((H⁺)_kk) (n_point,) [√(force/length)], infinite where a point's force is not unique."""
        ...

    def times(self, forces: Matrix) -> Matrix:
        """Return x H (..., n_point) [length] of forces (..., n_point)."""
        ...

    def solve(self, gaps: Matrix) -> Matrix:
        """Return x H⁺ (..., n_point) [force] of gaps (..., n_point)."""
        ...

    def energy(self, gaps: Matrix) -> Vector:
        """Return xᵀ H⁺ x (...) [force·length] of gaps (..., n_point)."""
        ...

    def norms(self, functionals: Matrix) -> Vector:
        """Return √(ℓᵀ H⁺ ℓ) (k,) for force functionals ℓ (k, n_point); infinite off the range."""
        ...

    def admissible(self, slack: Matrix, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return z ≥ 0 near ``forces``, s − z in the range of H, and whether it exists (...)."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class ElasticFlexibility:
    """H = N S Nᵀ + D of points that all yield, by the pairs beneath them.

    With the stiffness Σ = S⁻¹ between pairs, H⁻¹ = D⁻¹ − D⁻¹ N (Σ + Nᵀ D⁻¹ N)⁻¹ Nᵀ D⁻¹. With
    friction every component of force at a point counts as a point.

    Attributes
    ----------
    N : (n_point, n_relative)
        Displacements along the forces.
    compliance : (n_relative, n_relative) [length/force]
        S.
    held
        Factors of Σ + Nᵀ D⁻¹ N (n_relative, n_relative) [force/length].
    yields : (n_point,) [length/force]
        D.
    """

    N: SparseMatrix
    compliance: Matrix
    held: DenseFactorization
    yields: Vector

    @property
    def unique(self) -> bool:
        """Whether H is definite: points that yield always make it so."""
        return True

    @cached_property
    def point_norms(self) -> Vector:
        """√((H⁻¹)_kk) (n_point,) [√(force/length)]."""
        shares, compliance = np.empty_like(self.yields), self.held.inverse()
        for rows in pieces(len(shares), self.N.shape[1]):
            part = self.N[rows]
            shares[rows] = part.multiply(part @ compliance).sum(axis=1)
        return np.asarray(np.sqrt(np.maximum(1.0 - shares / self.yields, 0.0) / self.yields))

    def times(self, forces: Matrix) -> Matrix:
        """Return x H (..., n_point) [length] of forces (..., n_point)."""
        return self._through(self.compliance.__matmul__, forces) + self.yields * forces

    def solve(self, gaps: Matrix) -> Matrix:
        """Return x H⁻¹ (..., n_point) [force] of gaps (..., n_point)."""
        return (gaps - self._through(self.held.solve, gaps / self.yields)) / self.yields

    def energy(self, gaps: Matrix) -> Vector:
        """Return xᵀ H⁻¹ x (...) [force·length] of gaps (..., n_point)."""
        return np.asarray(np.maximum((gaps * self.solve(gaps)).sum(axis=-1), 0.0))

    def norms(self, functionals: Matrix) -> Vector:
        """Return √(ℓᵀ H⁻¹ ℓ) (k,) for force functionals ℓ (k, n_point)."""
        return np.sqrt(self.energy(functionals))

    def admissible(self, slack: Matrix, forces: Matrix) -> tuple[Matrix, Matrix]:  # noqa: ARG002
        """Return ``forces`` and that they are admissible: H has full range."""
        return forces, np.ones(forces.shape[:-1], dtype=bool)

    def _through(self, between: Callable[[Matrix], Matrix], rows: Matrix) -> Matrix:
        """Return x N B Nᵀ (..., n_point) of rows (..., n_point), for the product with B."""
        columns = rows.reshape(-1, rows.shape[-1]).T
        return np.asarray((self.N @ between(self.N.T @ columns)).T.reshape(rows.shape))


@dataclass(frozen=True, eq=False, kw_only=True)
class DenseFlexibility:
    """H = (T Tᵀ)⁺ between points of which some may be hard.

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

    @property
    def unique(self) -> bool:
        """Whether H is definite."""
        return self.range_basis is None

    def times(self, forces: Matrix) -> Matrix:
        """Return x H (..., n_point) [length] of forces (..., n_point)."""
        return np.asarray(forces @ self.H)

    def solve(self, gaps: Matrix) -> Matrix:
        """Return x H⁺ (..., n_point) [force] of gaps (..., n_point)."""
        return np.asarray((gaps @ self.half_inverse) @ self.half_inverse.T)

    def energy(self, gaps: Matrix) -> Vector:
        """Return xᵀ H⁺ x (...) [force·length] of gaps (..., n_point)."""
        return np.asarray(((gaps @ self.half_inverse) ** 2).sum(axis=-1))

    def norms(self, functionals: Matrix) -> Vector:
        """Return √(ℓᵀ H⁺ ℓ) (k,) for force functionals ℓ (k, n_point); infinite off the range."""
        norms = np.sqrt(self.energy(functionals))
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


def joint_flexibility(joint: Joint) -> Flexibility:
    """Return H of the static contact problem of a joint without friction.

    Raises
    ------
    ModelError
        If the matrices exceed the dense budget, or the joint has friction.

    Notes
    -----
    ⅓ n_relative³ multiplications where all points yield and the structure deforms whenever pairs
    move, and ⅔ for norms of points; else :func:`flexibility`.
    """
    joint.contact.check_frictionless()
    by_pairs = flexibility_by_pairs(joint, joint.contact.interpolation, joint.contact.flexibility)
    return flexibility(joint.static_contact.flexibility) if by_pairs is None else by_pairs


def flexibility_by_pairs(joint: Joint, N: SparseMatrix, yields: Vector) -> Flexibility | None:
    """Return H of a joint along some forces, which displace pairs by Nᵀ and points by D.

    None with hard points, or where some motion of the pairs deforms nothing.
    """
    if not joint.contact.yields:
        return None
    between = joint.static_contact.between
    try:
        stiffness = between.stiffness
    except la.LinAlgError:
        return None
    springs = PointSprings(G=N, components=1).of_diagonal(1.0 / yields[None])
    # The transpose is the same matrix, in the order that LAPACK works on.
    factor = la.cholesky((stiffness + springs).T, lower=True, overwrite_a=True)
    held = DenseFactorization(factor=np.asfortranarray(factor))
    return ElasticFlexibility(N=N, compliance=between.compliance, held=held, yields=yields)


def flexibility(H: Matrix) -> DenseFlexibility:
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
        return DenseFlexibility(H=H, half_inverse=inverse.T, range_basis=None)
    values, vectors = la.eigh(H)
    positive = values > ROUND_OFF * values[-1]
    basis = vectors[:, positive]
    return DenseFlexibility(H=H, half_inverse=basis / np.sqrt(values[positive]), range_basis=basis)
