"""Linear pieces of elastic contact between node pairs, from one to the next by what changed.

Closed points support the pairs by their springs, so that a force at a point k moves the pairs by
u = E n_k with the supported compliance E, and the gaps by N u. Where k changes sides, its spring
comes (+) or goes (−), with the gap G_k it had,

    μ = −G_k / (±D_k + n_k u),   G ← G + N u μ,   E ← E − u uᵀ / (±D_k + n_k u),

with which forces −D⁻¹ G and slacks follow for some ten products of vectors. Products with S prove
the forces from time to time, and correct them; see :mod:`faying.contact.supported_pairs`.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.supported_pairs import (
    CLOSED,
    MOST_REFINEMENTS,
    TINY,
    InaccurateError,
    SupportedCompliance,
    SupportedPairs,
)

MOST_CHANGES = 0.25
"""Changed points over pairs up to which E is kept: a new one takes n³ operations for n pairs."""

LEAST_CHANGES = 64
"""Changed points up to which it is kept in any case."""

ROUND_OFF = 1e-10
"""Force that an unclosed gap stands for, over the largest one, that corrections may leave.

Free gaps that the load closes a thousand times over leave 1e-11 at 10 E/h.
"""

UNPROVED = 8
"""Changes of closed points from one proof by S to the next."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PairPiece:
    """See :class:`faying.contact.linear_pieces.LinearPiece`.

    Attributes
    ----------
    pairs
        The contact problem.
    support
        E of the points that were closed when it was made.
    sides : (n_point, 2) [length]
        Free gap a and its growth b.
    shapes, signs : (n_pair, n_changed), (n_changed,)
        What points that changed since take from E: shapes diag(signs) shapesᵀ.
    unproved
        Changes since the last proof.
    """

    pairs: SupportedPairs
    support: SupportedCompliance
    sides: Matrix
    active: Mask
    forces: Matrix
    slack: Matrix
    shapes: Matrix
    signs: Vector
    unproved: int = 0

    @classmethod
    def of(cls, pairs: SupportedPairs, sides: Matrix, active: Mask) -> "PairPiece":
        """Return the piece of these closed points.

        Raises
        ------
        InaccurateError
            If round-off leaves no exact forces.
        LinAlgError
            If S is not positive semidefinite.
        """
        support = pairs.supported(active)
        acting = support.springs[:, None]
        moved = pairs.N @ (support.E @ (pairs.N.T @ (acting * sides)))
        piece = cls(
            pairs=pairs,
            support=support,
            sides=sides,
            active=active,
            forces=-acting * (sides - moved),
            slack=np.zeros_like(sides),
            shapes=np.zeros((len(pairs.S), 0)),
            signs=np.zeros(0),
        )
        return piece.proved()

    @property
    def own(self) -> Vector:
        """Diagonal of H."""
        return self.pairs.own

    def moved_to(self, active: Mask) -> "PairPiece":
        """Return the piece of other closed points; raises as :meth:`of`."""
        changed = (active ^ self.active).nonzero()[0]
        most = max(MOST_CHANGES * len(self.pairs.S), LEAST_CHANGES)
        if len(self.signs) + len(changed) > most:
            return PairPiece.of(self.pairs, self.sides, active)
        piece = self._changed(changed, active)
        if piece.unproved < UNPROVED:
            return piece
        try:
            return piece.proved()
        except InaccurateError:
            return PairPiece.of(self.pairs, self.sides, active)

    def between(self, points: Indices) -> Matrix:
        """Return N_Z E N_Zᵀ + D_Z of points Z."""
        moved = self.pairs.N[points] @ self._under(points)
        moved[np.diag_indices_from(moved)] += self.pairs.D[points]
        return np.asarray(moved)

    def proved(self) -> "PairPiece":
        """Return the piece with forces that S says close the gaps, and the slack S says.

        Raises
        ------
        InaccurateError
            If corrections do not close them.
        """
        N, D = self.pairs.N, self.pairs.D[:, None]
        springs = np.where(self.active[:, None], 1.0 / D, 0.0)
        forces = self.forces
        before = np.inf
        for _ in range(MOST_REFINEMENTS + 1):
            slack = N @ (self.pairs.S @ (N.T @ forces)) + D * forces + self.sides
            missing = springs * slack
            most = np.maximum(np.abs(forces).max(axis=0, initial=0.0), TINY)
            left = float((np.abs(missing).max(axis=0, initial=0.0) / most).max())
            if left <= CLOSED or before / 2 < left <= ROUND_OFF:
                return replace(self, forces=forces, slack=slack, unproved=0)
            before = left
            pressed = N.T @ missing
            moved = self.support.E @ pressed - self.shapes @ (
                self.signs[:, None] * (self.shapes.T @ pressed)
            )
            forces = forces - springs * (slack - N @ moved)
        raise InaccurateError

    def _under(self, points: Indices) -> Matrix:
        """Return how the pairs move (n_pair, k) under forces at points."""
        taken = self.signs[:, None] * (self.pairs.N[points] @ self.shapes).T
        return np.asarray(self.support.at_points[points].T - self.shapes @ taken)

    def _changed(self, points: Indices, active: Mask) -> "PairPiece":
        """Return the piece after points have changed sides, not proved."""
        D, closing = self.pairs.D, active[points]
        seen = self._under(points)
        moved = self.pairs.N @ seen
        core = moved[points] + np.diag(np.where(closing, D[points], -D[points]))
        gaps = np.where(
            closing[:, None], self.slack[points], -D[points, None] * self.forces[points]
        )
        values, vectors = np.linalg.eigh((core + core.T) / 2)
        scaled = vectors / np.sqrt(np.maximum(np.abs(values), TINY))
        signs = np.sign(values)
        pressing = -scaled @ (signs[:, None] * (scaled.T @ gaps))
        change = moved @ pressing
        forces = np.where(active[:, None], self.forces - change / D[:, None], 0.0)
        forces[points[closing]] = pressing[closing]
        slack = self.slack + change
        slack[points[~closing]] = (gaps + change[points])[~closing]
        return replace(
            self,
            active=active,
            forces=forces,
            slack=slack,
            shapes=np.hstack([self.shapes, seen @ scaled]),
            signs=np.concatenate([self.signs, signs]),
            unproved=self.unproved + len(points),
        )
