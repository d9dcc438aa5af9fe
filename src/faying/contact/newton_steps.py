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

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.point_springs import PointSprings

PROXIMAL = 1e-8
"""Yield of a rigid point in a Newton step, over what the structure yields at it."""


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
        diagonal = np.asarray(self.G.multiply(self.G @ self.S).sum(axis=1)).reshape(3, -1)
        diagonal[1:] = diagonal[1:].mean(axis=0)
        return diagonal

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
    ) -> Matrix:
        """Return dx (3, n_point) where F is wrong (3, n_point) [force].

        The slope J is (n_point, 3, 3), the scale r (3, n_point) [force/length], the compliance c′
        (3, n_point) [length/force].

        Raises
        ------
        scipy.linalg.LinAlgError
            If the system is singular.
        """
        points = np.flatnonzero(slope.any(axis=(1, 2)))
        dx = -wrong
        if not len(points):
            return dx
        blocks, r = slope[points], scale[:, points].T
        yielding = at_least(PROXIMAL * self.own, compliance)[:, points].T
        E = blocks * r[:, None, :]
        A = np.eye(3) - blocks + E * yielding[:, None, :]
        solved = np.linalg.solve(A, np.concatenate([E, dx[:, points].T[:, :, None]], axis=2))
        K = np.zeros_like(slope)
        K[points], dx[:, points] = solved[..., :3], solved[..., 3].T
        pairs = self._between_pairs(K, self.transposed @ dx.ravel())
        dx -= self._applied(K, self.S @ pairs)
        return dx

    def _applied(self, K: Matrix, displacements: Vector) -> Matrix:
        """Return K G u (3, n_point) of displacements u of the pairs."""
        moved = (self.G @ displacements).reshape(3, -1)
        return np.asarray(np.einsum("pij,jp->ip", K, moved))

    def _gathered(self, K: Matrix, displacements: Vector) -> Vector:
        """Return Gᵀ K G u of displacements u of the pairs."""
        return np.asarray(self.transposed @ self._applied(K, displacements).ravel())

    def _between_pairs(self, K: Matrix, right: Vector) -> Vector:
        """Solve (I + B S) q = b."""
        touched, feeling = self.springs.touched(K)
        B = self.springs.between_pairs(K)[touched][:, feeling]
        system = B @ self.S.take(feeling, axis=0).take(touched, axis=1)
        system.flat[:: len(system) + 1] += 1.0
        # Forces between pairs that no closed point touches are known, and move the others.
        forces = right.copy()
        forces[touched] = 0.0
        right_side = right - self._gathered(K, self.S @ forces)
        # LAPACK works in column order: it factorizes the transpose in place.
        lu, pivots, failed = lapack.dgetrf(system.T, overwrite_a=1)
        if failed or not np.isfinite(lu).all():
            message = "singular system of a Newton step"
            raise LinAlgError(message)
        forces[touched] = lapack.dgetrs(lu, pivots, right_side[touched], trans=1)[0]
        return forces


def at_least(least: Matrix, compliance: Matrix) -> Matrix:
    """Return what points yield, the least or more.

    Springs that are known by their forces, which come out of the structure, yield less than zero.
    """
    return np.where(compliance < 0, compliance, np.maximum(compliance, least))
