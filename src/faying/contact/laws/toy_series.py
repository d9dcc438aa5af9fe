"""A toy: two penalties in series, as of a shim that gives way like an interface of its own."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.penalty import Penalty


@final
@dataclass(frozen=True)
class ToySeries:
    """p = ⟨−g⟩ / (1/c₁ + 1/c₂).

    Attributes
    ----------
    first, second
        The two penalties.
    """

    first: Penalty
    second: Penalty

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "toy-series"

    @property
    def components(self) -> int:
        """The normal component alone."""
        return 1

    @property
    def friction(self) -> float:
        """None."""
        return 0.0

    @property
    def penalty(self) -> float:
        """Stiffness of both together."""
        return 1.0 / (1.0 / self.first.penalty + 1.0 / self.second.penalty)

    def compliance(self, weights: Vector) -> Matrix:
        """Return the sum of both (1, n_point) [length/force]."""
        return self.first.compliance(weights) + self.second.compliance(weights)

    def admissible(self, forces: Matrix) -> Matrix:
        """Return ⟨λ⟩."""
        return np.maximum(forces, 0.0)
