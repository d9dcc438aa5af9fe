"""Linear systems of Newton's method on increments: local but for what forces between pairs move.

With the derivatives J of what the laws admit and c′ of what they yield, residuals F of (F1) and the
relative displacements y = G S Gᵀ x that contact forces make, a step dx obeys at every point

    A dx + E dy = −F,   E = J r,   A = I − J + E c′,                                        (F2)

and dx = −F where nothing is admissible. A is inverted point by point, and with the change q of
the forces between pairs

    (I + B S) q = −Gᵀ A⁻¹ F,   B = Gᵀ K G,   K = A⁻¹ E,   dx = −A⁻¹ F − K G S q,              (F3)

is a system between the pairs that closed points touch. Where a law does not yield, as hard contact,
c′ in A (not in F) is a small part of what the structure yields: a proximal point iteration, which
needs no more steps and selects one of several solutions where S is singular.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from scipy.linalg import LinAlgError, lapack

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.contact.point_springs import PointSprings
from faying.linalg.gmres import corrected

PROXIMAL = 1e-8
"""Yield of a rigid point in a Newton step, over what the structure yields at it."""

MOST_CORRECTIONS = 12
"""Corrections after which a system gets factors of its own, which cost as much as ten."""

CHANGED, MOST_CHANGED = 0.1, 4
"""Change of K at a point, over the largest K, that counts, and how many such serve for GMRES."""


@final
@dataclass(frozen=True, eq=False)
class Factors:
    """Factors of I + B S at the pairs that closed points touch.

    Attributes
    ----------
    K : (n_point, 3, 3) [force/length]
    touched : (n_touched,)
    lu, pivots
        Of the transpose.
    """

    K: Matrix
    touched: Indices
    lu: Matrix
    pivots: Indices

    def serve(self, K: Matrix) -> bool:
        """Say whether K is another at few points only."""
        changed = np.abs(K - self.K).max(axis=(1, 2)) > CHANGED * np.abs(K).max()
        return bool(np.count_nonzero(changed) <= MOST_CHANGED)

    def applied(self, right: Vector) -> Vector:
        """Return the pair forces of a right-hand side (n_relative,), itself where not touched."""
        result = right.copy()
        result[self.touched] = lapack.dgetrs(self.lu, self.pivots, right[self.touched], trans=1)[0]
        return result


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class NewtonSteps:
    """Solves (F2).

    Attributes
    ----------
    G : (3 n_point, n_relative) sparse
        Displacements at the points: all normal ones, first tangents, second tangents.
    S : (n_relative, n_relative) [length/force]
        Compliance between pairs.
    """

    G: SparseMatrix
    S: Matrix

    @cached_property
    def own(self) -> Matrix:
        """Displacement of a point per force at it, the diagonal of G S Gᵀ (3, n_point).

        Both tangents have one, the mean of theirs, which no turn of them changes.
        """
        own = np.asarray(self.G.multiply(self.G @ self.S).sum(axis=1)).reshape(3, -1)
        own[1:] = own[1:].mean(axis=0)
        return own

    @cached_property
    def springs(self) -> PointSprings:
        """What takes springs at points to pairs."""
        return PointSprings(G=self.G, components=3)

    @property
    def transposed(self) -> SparseMatrix:
        """Gᵀ, which takes forces at the points to the pairs."""
        return self.springs.transposed

    def moved(self, forces: Matrix) -> Matrix:
        """Return the displacements G S Gᵀ x (3, n_point) of forces (3, n_point)."""
        pairs = self.S @ (self.transposed @ forces.ravel())
        return np.asarray((self.G @ pairs).reshape(forces.shape))

    def step(
        self,
        wrong: Matrix,
        slope: Matrix,
        scale: Matrix,
        compliance: Matrix,
        factors: Factors | None = None,
        tolerance: float = 0.0,
    ) -> tuple[Matrix, Factors | None]:
        """Return dx (3, n_point), and the factors it was made with.

        Parameters
        ----------
        wrong : (3, n_point) [force]
            F.
        slope : (n_point, 3, 3)
            J.
        scale : (3, n_point) [force/length]
            r.
        compliance : (3, n_point) [length/force]
            c′.
        factors
            Of a similar system; they serve where few corrections lead to the solution of this one.
        tolerance
            Relative residual of a system that is solved in this way.

        Raises
        ------
        scipy.linalg.LinAlgError
            If the system is singular.
        """
        points = np.flatnonzero(slope.any(axis=(1, 2)))
        dx = -wrong
        if not len(points):
            return dx, factors
        blocks, r = slope[points], scale[:, points].T
        yielding = np.maximum(compliance, PROXIMAL * self.own)[:, points].T
        E = blocks * r[:, None, :]
        A = np.eye(3) - blocks + E * yielding[:, None, :]
        solved = np.linalg.solve(A, np.concatenate([E, dx[:, points].T[:, :, None]], axis=2))
        K = np.zeros_like(slope)
        K[points], dx[:, points] = solved[..., :3], solved[..., 3].T
        pairs, factors = self._between_pairs(K, self.transposed @ dx.ravel(), factors, tolerance)
        dx -= self._applied(K, self.S @ pairs)
        return dx, factors

    def _applied(self, K: Matrix, displacements: Vector) -> Matrix:
        """Return K G u (3, n_point) of displacements u of the pairs."""
        moved = (self.G @ displacements).reshape(3, -1)
        return np.asarray(np.einsum("pij,jp->ip", K, moved))

    def _gathered(self, K: Matrix, displacements: Vector) -> Vector:
        """Return Gᵀ K G u of displacements u of the pairs."""
        return np.asarray(self.transposed @ self._applied(K, displacements).ravel())

    def _between_pairs(
        self, K: Matrix, right: Vector, factors: Factors | None, tolerance: float
    ) -> tuple[Vector, Factors]:
        """Solve (I + B S) q = b, with factors at hand or new ones."""
        if factors is not None and factors.serve(K):
            found = self._refined(K, right, factors, tolerance)
            if found is not None:
                return found, factors
        touched = self.springs.touched(K)
        B = self.springs.between_pairs(K)[touched][:, touched]
        S = self.S.take(touched, axis=0).take(touched, axis=1)
        factors = Factors(K, touched, *_factorized(B @ S))
        # Forces between pairs that no closed point touches are known, and move the others.
        beside = right.copy()
        beside[touched] = 0.0
        return factors.applied(right - self._gathered(K, self.S @ beside)), factors

    def _refined(
        self, K: Matrix, right: Vector, factors: Factors, tolerance: float
    ) -> Vector | None:
        """Solve by GMRES with the factors of a similar system, or not at all."""

        def product(forces: Vector) -> Vector:
            moved = factors.applied(forces)
            return np.asarray(moved + self._gathered(K, self.S @ moved))

        enough = tolerance * float(np.linalg.norm(factors.applied(right)))
        found = corrected(product, right, enough, MOST_CORRECTIONS)
        return None if found is None else factors.applied(found)


def _factorized(product: Matrix) -> tuple[Matrix, Indices]:
    """Factorize the transpose of I + B S, given B S, which is overwritten."""
    product.flat[:: len(product) + 1] += 1.0
    # LAPACK works in column order: it factorizes the transpose in place.
    lu, pivots, failed = lapack.dgetrf(product.T, overwrite_a=1)
    if failed or not np.isfinite(lu).all():
        message = "singular system of a Newton step"
        raise LinAlgError(message)
    return lu, pivots
