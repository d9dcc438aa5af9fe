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

    def compliance(self, weights: Vector) -> Matrix:
        """Return zeros (1, n_point)."""
        return np.zeros((1, len(weights)))

    def admissible(self, forces: Matrix) -> Matrix:
        """Return ⟨λ⟩: contact presses, it never pulls."""
        return np.maximum(forces, 0.0)
