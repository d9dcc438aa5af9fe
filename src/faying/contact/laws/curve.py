"""Base class of laws that give pressure over closure by a curve."""

from abc import abstractmethod
from dataclasses import fields
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.unilateral import Unilateral
from faying.exceptions import ModelError

FIRST_PRESSURE = 1e-3
"""Pressure over the reference one at which a curve of zero initial slope is taken to begin."""

_PLACES, _SHARES = np.polynomial.legendre.leggauss(24)
"""Gauss's rule for energies, exact to round-off where a curve has no kink."""


class Curve(Unilateral):
    """p = p(c) of the closure c = −g; zero up to where contact begins, and rising from there.

    A member is a frozen value with :meth:`pressure_of`, its inverse :meth:`closure_of`, and a
    reference pressure.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name in studies and files."""

    @property
    @abstractmethod
    def named_pressure(self) -> float:
        """Reference pressure [force/length²] of the curve."""

    @abstractmethod
    def closure_of(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Return c [length] and dc/dp [length³/force] at pressures (n,) ≥ 0."""

    @property
    def stiffness(self) -> float:
        """Slope [force/length³] at the reference pressure."""
        return float(1.0 / self.closure_of(np.array([self.named_pressure]))[1][0])

    @property
    def penalty(self) -> float:
        """NaN: no single stiffness stands for a curve."""
        return float("nan")

    @property
    def proportional(self) -> bool:
        """False: pressure is not proportional to closure."""
        return False

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return c(λ/w) and its derivative by λ, (1, n_point) each.

        At zero force the derivative is taken at a thousandth of the reference pressure: a curve
        that begins with zero slope would never let a force begin.
        """
        pressure = np.maximum(forces[0], 0.0) / weights
        closed = self.closure_of(pressure)[0]
        slope = self.closure_of(
            np.where(pressure > 0, pressure, FIRST_PRESSURE * self.named_pressure)
        )[1]
        return closed[None], (slope / weights)[None]

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return w ∫ p dc up to the closure under the forces (n_point,)."""
        begun = self.closure_of(np.zeros(1))[0]
        way = self.closure_of(np.maximum(forces[0], 0.0) / weights)[0] - begun
        places = begun + 0.5 * (1.0 + _PLACES) * way[:, None]
        pressure = self.pressure_of(places.ravel())[0].reshape(places.shape)
        return np.asarray(weights * 0.5 * way * (pressure @ _SHARES))

    def springs(self, weights: Vector) -> Matrix:
        """Return w times the slope at the reference pressure (1, n_point)."""
        return self.stiffness * weights[None]


def check_positive(law: Any) -> None:
    """Refuse a law whose parameters are not all positive numbers."""
    for parameter in fields(law):
        value = getattr(law, parameter.name)
        if not 0 < value < float("inf"):
            message = f"closure '{law.name}': {parameter.name} is {value:g}; give a positive number"
            raise ModelError(message)
