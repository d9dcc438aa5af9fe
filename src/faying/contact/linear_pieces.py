"""Contact forces that are linear in a load factor as long as the same points are closed.

With the free gap a + t b the forces of closed points A and the slacks of the others are

    λ_A(t) = −H_AA⁻¹ (a_A + t b_A),   s(t) = H λ(t) + a + t b.

A piece holds both as lines, a column for 1 and one for t, and leads to the next.
"""

from dataclasses import dataclass, replace
from typing import Protocol, Self, final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.neighbouring_blocks import NeighbouringBlocks


class LinearPiece(Protocol):
    """What is linear while the same points are closed."""

    @property
    def active(self) -> Mask:
        """Points that are closed (n_point,)."""
        ...

    @property
    def forces(self) -> Matrix:
        """Contact forces (n_point, 2), zero at other points."""
        ...

    @property
    def slack(self) -> Matrix:
        """Slack of the other points (n_point, 2)."""
        ...

    @property
    def own(self) -> Vector:
        """Diagonal of H (n_point,) [length/force]."""
        ...

    def moved_to(self, active: Mask) -> Self:
        """Return the piece of other closed points."""
        ...

    def between(self, points: Indices) -> Matrix:
        """Return gap per force between points that are not closed, those in contact giving way."""
        ...


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PointPiece:
    """A piece by blocks of H, for any law; see :class:`LinearPiece`.

    Attributes
    ----------
    blocks
        What solves blocks of H near the last one.
    sides : (n_point, 2) [length]
        Free gap a and its growth b.
    """

    blocks: NeighbouringBlocks
    sides: Matrix
    active: Mask
    forces: Matrix
    slack: Matrix

    @classmethod
    def of(cls, H: Matrix, sides: Matrix) -> "PointPiece":
        """Return the piece on which nothing is closed."""
        return cls(
            blocks=NeighbouringBlocks(H=H),
            sides=sides,
            active=np.zeros(len(H), dtype=bool),
            forces=np.zeros_like(sides),
            slack=sides,
        )

    @property
    def own(self) -> Vector:
        """Diagonal of H."""
        return np.asarray(np.diag(self.blocks.H))

    def moved_to(self, active: Mask) -> "PointPiece":
        """Return the piece of other closed points; raises ``ModelError`` of a singular block."""
        forces, blocks = self.blocks.solved(active, -self.sides)
        slack = self.blocks.H @ forces + self.sides
        return replace(self, blocks=blocks, active=active, forces=forces, slack=slack)

    def between(self, points: Indices) -> Matrix:
        """Return H_ZZ − H_ZA H_AA⁻¹ H_AZ of points Z."""
        across = self.blocks.H[:, points]
        relieved, _ = self.blocks.solved(self.active, across)
        return np.asarray(across[points] - across.T @ relieved)
