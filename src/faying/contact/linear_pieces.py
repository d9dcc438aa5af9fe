"""Contact forces that are linear in a load factor as long as the same points are closed.

With the free gap a + t b the forces of closed points A and the slacks of the others are

    λ_A(t) = −H_AA⁻¹ (a_A + t b_A),   s(t) = H λ(t) + a + t b.

A piece holds both as lines, a column for 1 and one for t, and leads to the next.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.neighbouring_blocks import NeighbouringBlocks


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PointPiece:
    """A piece by blocks of H, for any law.

    Attributes
    ----------
    active : (n_point,)
        Points that are closed.
    forces : (n_point, 2)
        Contact forces, zero at other points.
    slack : (n_point, 2)
        Of the other points.
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
