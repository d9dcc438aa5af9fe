"""What points admit and yield, beside springs that are known by their forces."""

from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from faying._typing import Matrix, Vector


class Admitting(Protocol):
    """What increments as problems of forces ask of the points."""

    def closure(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return what is yielded (3, n_point) [length] to forces, and how much more per force."""
        ...

    def admissible(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the admissible forces (3, n_point) nearest to given ones."""
        ...

    def derivative(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the derivative of the admissible forces (n_point, 3, 3)."""
        ...


@final
@dataclass(frozen=True, eq=False)
class ForcedLaws:
    """Those of points, then of springs whose initial forces admit anything and close by −N₀/k.

    With z = e₀ + ι N₀ − cᵀ p that is N₀ = T − k e, (T1a): the spring comes out of the structure.
    """

    points: Admitting
    stiffness: Vector

    def closure(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return what is yielded, and how much more per force."""
        at_points, springs = self._parts(forces)
        closed, compliance = self.points.closure(at_points)
        taken = np.zeros_like(springs)
        taken[0] = -1.0 / self.stiffness
        return np.hstack([closed, taken * springs]), np.hstack([compliance, taken])

    def admissible(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the admissible forces nearest to given ones."""
        at_points, springs = self._parts(forces)
        return np.hstack([self.points.admissible(at_points, self._pressing(pressing)), springs])

    def derivative(self, forces: Matrix, pressing: Vector | None) -> Matrix:
        """Return the derivative of the admissible forces."""
        at_points, springs = self._parts(forces)
        unchanged = np.zeros((springs.shape[1], 3, 3))
        unchanged[:, 0, 0] = 1.0
        return np.concatenate(
            [self.points.derivative(at_points, self._pressing(pressing)), unchanged]
        )

    def _parts(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        n = forces.shape[1] - len(self.stiffness)
        return forces[:, :n], forces[:, n:]

    def _pressing(self, pressing: Vector | None) -> Vector | None:
        return None if pressing is None else pressing[: len(pressing) - len(self.stiffness)]
