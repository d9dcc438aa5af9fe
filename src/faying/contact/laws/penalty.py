"""Penalty contact: pressure proportional to penetration, Eq. (15.12)."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.unilateral import Unilateral
from faying.exceptions import ModelError


@dataclass(frozen=True)
class Penalty(Unilateral):
    """p = c_n ⟨−g⟩.

    Attributes
    ----------
    stiffness : [force/length³]
        c_n.

    Raises
    ------
    ModelError
        If the stiffness is not a positive number.
    """

    stiffness: float

    def __post_init__(self) -> None:
        if not 0 < self.stiffness < float("inf"):
            message = f"the penalty is {self.stiffness:g}; give a positive number, 'auto' or 'hard'"
            raise ModelError(message)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "penalty"

    @property
    def penalty(self) -> float:
        """c_n."""
        return self.stiffness

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return λ / (c_n w) and 1 / (c_n w), (1, n_point) each."""
        compliance = 1.0 / (self.stiffness * weights[None])
        return forces * compliance, compliance

    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return c_n ⟨c⟩ and c_n where closed, at closures (n,)."""
        slope = np.where(closure >= 0, self.stiffness, 0.0)
        return slope * closure, slope

    def springs(self, weights: Vector) -> Matrix:
        """Return w c_n (1, n_point)."""
        return self.stiffness * weights[None]
