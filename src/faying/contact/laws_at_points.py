"""The laws of all interfaces, point by point: what a solver of increments asks them."""

from dataclasses import dataclass
from functools import cached_property
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
        if self._compliance is not None:
            return self._compliance * forces, self._compliance
        return self._asked(forces)

    @cached_property
    def _compliance(self) -> Matrix | None:
        """What is in proportion to force at every point need not be asked again."""
        if not all(law.proportional for law, _ in self._members):
            return None
        return self._asked(np.zeros((3, self.contact.n_points)))[1]

    def _asked(self, forces: Matrix) -> tuple[Matrix, Matrix]:
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

    @cached_property
    def _members(self) -> list[tuple[Law, slice]]:
        return [(self.contact.laws[name], points) for name, points in self.contact.slices.items()]
