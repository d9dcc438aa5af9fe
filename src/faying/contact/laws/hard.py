"""Hard contact: nothing penetrates, Eq. (15.7)."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.unilateral import Unilateral


@final
@dataclass(frozen=True)
class Hard(Unilateral):
    """Unilateral contact without any compliance of its own (Signorini)."""

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "hard"

    @property
    def penalty(self) -> float:
        """Infinite."""
        return float("inf")

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:  # noqa: ARG002
        """Return zeros (1, n_point)."""
        return np.zeros_like(forces), np.zeros_like(forces)
