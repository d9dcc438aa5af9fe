"""The laws of all interfaces, point by point: what a solver of increments asks them."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.laws import Law


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LawsAtPoints:
    """Laws with one or three components, each at its own points, as one with three.

    A component that a law does not have carries no force.
    """

    contact: Contact

    def closure(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return c(x) [length] and c′(x) [length/force], (3, n_point) each."""
        closed, compliance = np.zeros_like(forces), np.zeros_like(forces)
        for law, points in self._members:
            own = slice(law.components), points
            closed[own], compliance[own] = law.closure(forces[own], self.contact.weights[points])
        return closed, compliance

    def admissible(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the admissible forces (3, n_point) nearest to given ones."""
        result = np.zeros_like(forces)
        for law, points in self._members:
            own = slice(law.components), points
            held = None if pressing is None else pressing[points]
            result[own] = law.admissible(forces[own], held)
        return result

    def derivative(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the derivative of the admissible forces (n_point, 3, 3)."""
        result = np.zeros((forces.shape[1], 3, 3))
        for law, points in self._members:
            n, held = law.components, None if pressing is None else pressing[points]
            result[points, :n, :n] = law.derivative(forces[:n, points], held)
        return result

    @property
    def _members(self) -> list[tuple[Law, slice]]:
        return [(self.contact.laws[name], points) for name, points in self.contact.slices.items()]
