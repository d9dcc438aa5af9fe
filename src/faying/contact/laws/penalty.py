"""Penalty contact: pressure in proportion to penetration, Eq. (15.12)."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import ModelError


@final
@dataclass(frozen=True)
class Penalty:
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
    def components(self) -> int:
        """The normal component alone: no friction."""
        return 1

    @property
    def penalty(self) -> float:
        """c_n."""
        return self.stiffness

    @property
    def friction(self) -> float:
        """None."""
        return 0.0

    @property
    def proportional(self) -> bool:
        """Penetration is in proportion to pressure."""
        return True

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return λ / (c_n w) and 1 / (c_n w), (1, n_point) each."""
        compliance = 1.0 / (self.stiffness * weights[None])
        return forces * compliance, compliance

    def admissible(self, forces: Matrix, pressing: Vector | None = None) -> Matrix:  # noqa: ARG002
        """Return ⟨λ⟩: contact presses, it never pulls."""
        return np.maximum(forces, 0.0)

    def derivative(self, forces: Matrix, pressing: Vector | None = None) -> Matrix:  # noqa: ARG002
        """Return one where contact presses, else zero (n_point, 1, 1)."""
        return np.asarray((forces > 0).astype(float)[0, :, None, None])
