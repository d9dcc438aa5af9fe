"""Hard contact: nothing penetrates, Eq. (15.7)."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector


@final
@dataclass(frozen=True)
class Hard:
    """Unilateral contact without any compliance of its own (Signorini)."""

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "hard"

    @property
    def components(self) -> int:
        """The normal component alone: no friction."""
        return 1

    @property
    def penalty(self) -> float:
        """Infinite."""
        return float("inf")

    @property
    def friction(self) -> float:
        """None."""
        return 0.0

    @property
    def proportional(self) -> bool:
        """Nothing is in proportion to everything."""
        return True

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:  # noqa: ARG002
        """Return zeros (1, n_point)."""
        return np.zeros_like(forces), np.zeros_like(forces)

    def admissible(self, forces: Matrix, pressing: Vector | None = None) -> Matrix:  # noqa: ARG002
        """Return ⟨λ⟩: contact presses, it never pulls."""
        return np.maximum(forces, 0.0)

    def derivative(self, forces: Matrix, pressing: Vector | None = None) -> Matrix:  # noqa: ARG002
        """Return one where contact presses, else zero (n_point, 1, 1)."""
        return np.asarray((forces > 0).astype(float)[0, :, None, None])
