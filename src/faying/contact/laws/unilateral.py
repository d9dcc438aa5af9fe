"""Base class of frictionless normal contact, which presses and never pulls, Eq. (15.7)."""

from abc import abstractmethod
from typing import Self, cast

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.law import Law


class Unilateral:
    """Members of a law with one component and no friction, for every closure."""

    @property
    def normal(self) -> Self:
        """The law itself."""
        return self

    @property
    def components(self) -> int:
        """One, the normal component."""
        return 1

    @property
    def friction(self) -> float:
        """Zero."""
        return 0.0

    @property
    def tangential_penalty(self) -> float:
        """Zero: there is no tangential stiffness."""
        return 0.0

    def with_normal(self, normal: Law) -> Law:
        """Return the normal law alone, for there is no friction to keep."""
        return normal

    def friction_or(self, given: float) -> float:
        """Return the given coefficient."""
        return given

    def with_coefficient(self, friction: float) -> Law:  # noqa: ARG002
        """Return the law itself: without tangential stiffness there is no friction."""
        return cast("Law", self)

    @property
    def yields(self) -> bool:
        """True: forces follow from displacements."""
        return True

    @property
    def proportional(self) -> bool:
        """True: closure is proportional to force, or zero."""
        return True

    @property
    def remembers(self) -> bool:
        """False: the law has no history."""
        return False

    def after(self, deepest: Vector) -> Law:  # noqa: ARG002
        """Return the law itself, which has no history."""
        return cast("Law", self)

    @abstractmethod
    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return c(λ) and c′(λ), (1, n_point) each."""

    @abstractmethod
    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return p [force/length²] and dp/dc [force/length³] at closures (n,) [length]."""

    def respond(self, moved: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return w p(−g) (1, n_point), and w dp/dc (n_point, 1, 1).

        Raises
        ------
        ModelError
            Of hard contact, whose forces do not follow from displacements.
        """
        pressure, slope = self.pressure_of(-moved[0])
        return (weights * pressure)[None], (weights * slope)[:, None, None]

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return ½ λ c(λ) (n_point,)."""
        return np.asarray(0.5 * forces[0] * self.closure(forces, weights)[0][0])

    def admissible(self, forces: Matrix) -> Matrix:
        """Return ⟨λ⟩: contact presses, it never pulls."""
        return np.maximum(forces, 0.0)

    def derivative(self, forces: Matrix) -> Matrix:
        """Return 1 where contact presses, else 0 (n_point, 1, 1)."""
        return np.asarray((forces > 0).astype(float)[0, :, None, None])
