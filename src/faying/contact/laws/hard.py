"""Hard contact: nothing penetrates, Eq. (15.7)."""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.unilateral import Unilateral
from faying.exceptions import ModelError


@dataclass(frozen=True)
class Hard(Unilateral):
    """Unilateral contact without compliance (Signorini)."""

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "hard"

    @property
    def yields(self) -> bool:
        """False: forces do not follow from displacements."""
        return False

    @property
    def penalty(self) -> float:
        """Infinite."""
        return float("inf")

    @property
    def stiffness(self) -> float:
        """Infinite."""
        return float("inf")

    def springs(self, weights: Vector) -> Matrix:
        """Return infinity (1, n_point)."""
        return np.full((1, len(weights)), np.inf)

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:  # noqa: ARG002
        """Return zeros (1, n_point)."""
        return np.zeros_like(forces), np.zeros_like(forces)

    def pressure_of(self, closure: Vector) -> NoReturn:  # noqa: ARG002
        """Refuse: forces of hard contact are unknowns of their own.

        Raises
        ------
        ModelError
            Always.
        """
        message = "forces of hard contact do not follow from displacements; give a penalty"
        raise ModelError(message)
