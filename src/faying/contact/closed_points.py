"""Contact forces that are linear in a load factor as long as the same points are closed.

With the free gap g = a + t b and springs k of the closed points A, the pairs move besides by w, and

    (Σ + N_Aᵀ k N_A) w = −N_Aᵀ k g,   λ_A = −k (g + N_A w),   s = g + N w

are lines in t. A piece holds them, a column for 1 and one for t, and leads to the next. Of hard
contact forces are the unknowns: λ_A = −H_AA⁻¹ g_A and s = H λ + g.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, Self, final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.condensed import ContactSolver
from faying.contact.contact import Contact
from faying.contact.dense_points import DensePoints
from faying.contact.glued_pairs import GluedPairs
from faying.contact.yielding import YieldingContact
from faying.exceptions import ModelError

MOST_CHANGED = 0.2
"""Points that came or went since pairs were put on springs, over pairs, from which it is done anew.

A new inverse takes 2 n³ multiplications, a system of k pairs k³.
"""


class ClosedPoints(Protocol):
    """Solves contact whose closed points are known."""

    def near(self, active: Mask) -> Self:
        """Return what solves contact of about these closed points."""
        ...

    @property
    def self_compliance(self) -> Vector:
        """Gap of every point per force at it, the diagonal of H (n_point,) [length/force]."""
        ...

    def solved(self, gaps: Matrix, active: Mask) -> tuple[Matrix, Matrix]:
        """Return forces and slacks (n_point, k) of free gaps (n_point, k)."""
        ...

    def between(self, points: Indices, active: Mask) -> Matrix:
        """Return H_ZZ − H_ZA H_AA⁻¹ H_AZ of points Z."""
        ...


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class OnSprings:
    """Closed points as springs between the pairs.

    Attributes
    ----------
    contact
        Elastic, without friction.
    pairs
        On the springs of similar points.
    """

    contact: YieldingContact
    pairs: GluedPairs

    def near(self, active: Mask) -> "OnSprings":
        """Return what solves contact of about these closed points."""
        changed = np.count_nonzero((self.pairs.glued.springs[0] > 0) != active)
        if changed <= MOST_CHANGED * len(self.pairs.structure):
            return self
        return replace(self, pairs=self.pairs.glued_by(self._springs(active)))

    @cached_property
    def self_compliance(self) -> Vector:
        """Gap of every point per force at it (n_point,) [length/force]."""
        pairs = self.contact.contact.rows @ self.contact.S
        moved = np.asarray(self.contact.contact.rows.multiply(pairs).sum(axis=1)).ravel()
        return np.asarray(moved + 1.0 / self.contact.laws.springs[0])

    def solved(self, gaps: Matrix, active: Mask) -> tuple[Matrix, Matrix]:
        """Return forces and slacks (n_point, k) of free gaps (n_point, k)."""
        springs, pairs = self._springs(active), self.pairs
        pressed = -(pairs.transposed @ (springs.T * gaps))
        slack = gaps + pairs.G @ pairs.solved(springs, pressed)
        return -springs.T * slack, np.where(active[:, None], 0.0, slack)

    def between(self, points: Indices, active: Mask) -> Matrix:
        """Return H_ZZ − H_ZA H_AA⁻¹ H_AZ of points Z."""
        rows = self.pairs.G[points]
        rows = rows if isinstance(rows, np.ndarray) else rows.toarray()
        between = rows @ self.pairs.solved(self._springs(active), rows.T)
        return np.asarray(between + np.diag(1.0 / self.contact.laws.springs[0, points]))

    def _springs(self, active: Mask) -> Matrix:
        return np.asarray(self.contact.laws.springs * active)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class UnknownForces:
    """Closed points as unknown forces, for any law."""

    points: DensePoints

    def near(self, active: Mask) -> "UnknownForces":  # noqa: ARG002
        """Return itself: every block of H is factorized."""
        return self

    @property
    def self_compliance(self) -> Vector:
        """Gap of every point per force at it (n_point,) [length/force]."""
        return self.points.diagonal

    def solved(self, gaps: Matrix, active: Mask) -> tuple[Matrix, Matrix]:
        """Return forces and slacks (n_point, k); raises ``ModelError`` of a singular block."""
        forces = np.zeros_like(gaps)
        forces[active] = self._solved(-gaps[active], active)
        return forces, np.where(active[:, None], 0.0, self.points.H @ forces + gaps)

    def between(self, points: Indices, active: Mask) -> Matrix:
        """Return H_ZZ − H_ZA H_AA⁻¹ H_AZ of points Z."""
        across = self.points.H[np.ix_(active, points)]
        across_points = self.points.H[np.ix_(points, points)]
        return np.asarray(across_points - across.T @ self._solved(across, active))

    def _solved(self, right: Matrix, active: Mask) -> Matrix:
        try:
            return self.points.solve_active(right, active)
        except LinAlgError:
            message = (
                "contact forces are not unique where contact is hard at more points than there are "
                "relative displacements; take nodal quadrature or a penalty to follow a load"
            )
            raise ModelError(message) from None


def closed_points(contact: Contact, condensed: ContactSolver) -> ClosedPoints:
    """Return what solves contact without friction whose closed points are known.

    Raises
    ------
    ModelError
        If there is friction, or closure is not in proportion to force.
    """
    contact.check_frictionless()
    contact.check_proportional()
    solver = condensed.cases
    if isinstance(solver, YieldingContact):
        return OnSprings(contact=solver, pairs=solver.pairs)
    return UnknownForces(points=DensePoints(H=condensed.flexibility))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LinearPiece:
    """Forces and slacks as lines, as long as the same points are closed.

    Attributes
    ----------
    solver
        What solves contact with known closed points.
    sides : (n_point, 2) [length]
        Free gap a and its growth b.
    active : (n_point,)
        Points that are closed.
    forces : (n_point, 2)
        Contact forces, zero at other points.
    slack : (n_point, 2)
        Of the other points.
    """

    solver: ClosedPoints
    sides: Matrix
    active: Mask
    forces: Matrix
    slack: Matrix

    @classmethod
    def of(cls, solver: ClosedPoints, sides: Matrix) -> "LinearPiece":
        """Return the piece on which nothing is closed."""
        active = np.zeros(len(sides), dtype=bool)
        return cls(
            solver=solver, sides=sides, active=active, forces=np.zeros_like(sides), slack=sides
        )

    def moved_to(self, active: Mask) -> "LinearPiece":
        """Return the piece of other closed points; raises ``ModelError`` of a singular block."""
        solver = self.solver.near(active)
        forces, slack = solver.solved(self.sides, active)
        return replace(self, solver=solver, active=active, forces=forces, slack=slack)

    def between(self, points: Indices) -> Matrix:
        """Return H_ZZ − H_ZA H_AA⁻¹ H_AZ of points Z."""
        return self.solver.between(points, self.active)
