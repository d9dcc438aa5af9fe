"""Pressure over closure by a table, as measured on gaskets and layers."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.curve import Curve
from faying.exceptions import ModelError


@dataclass(frozen=True)
class TableClosure(Curve):
    """p(c) linear between the rows of a table, with the last slope continued beyond the last row.

    Attributes
    ----------
    closures : (n,) [length]
        Rising. Pressure begins at the first, which is negative if that is before surfaces meet.
    pressures : (n,) [force/length²]
        Rising from zero.

    Raises
    ------
    ModelError
        If there are fewer than two rows, or they do not rise.

    Examples
    --------
    >>> import faying as fy
    >>> paper = fy.TableClosure(closures=(0.0, 1e-3, 2e-3), pressures=(0.0, 1.0, 5.0))
    >>> joint = fy.lap_joint(element_size=5.0).with_closure(paper)
    >>> bool(fy.solve_static(fy.preload(joint, {"bolt": 10e3})).max_pressure > 10.0)
    True
    """

    closures: tuple[float, ...]
    pressures: tuple[float, ...]

    def __post_init__(self) -> None:
        for column in ("closures", "pressures"):
            object.__setattr__(self, column, tuple(map(float, getattr(self, column))))
        if len(self.closures) != len(self.pressures) or len(self.closures) < 2:
            message = (
                f"closure '{self.name}': {len(self.closures)} closures and {len(self.pressures)} "
                "pressures; give two rows or more with both"
            )
            raise ModelError(message)
        if self.pressures[0] != 0:
            message = (
                f"closure '{self.name}': the first pressure is {self.pressures[0]:g}; begin with "
                "the closure at which it is still 0"
            )
            raise ModelError(message)
        rises = np.diff([self.closures, self.pressures]) > 0
        if not rises.all():
            row = int(np.argmin(rises.all(axis=0)))
            message = (
                f"closure '{self.name}': after closure {self.closures[row]:g} with pressure "
                f"{self.pressures[row]:g} comes {self.closures[row + 1]:g} with "
                f"{self.pressures[row + 1]:g}; both must rise from row to row"
            )
            raise ModelError(message)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "table"

    @property
    def named_pressure(self) -> float:
        """The last pressure."""
        return self.pressures[-1]

    @property
    def stiffness(self) -> float:
        """The steepest slope [force/length³]."""
        return float((np.diff(self.pressures) / np.diff(self.closures)).max())

    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return p and dp/dc."""
        pressure, slope = _linear(closure, np.array(self.closures), np.array(self.pressures))
        begun = closure >= self.closures[0]
        return pressure * begun, slope * begun

    def closure_of(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Return c and dc/dp."""
        return _linear(pressure, np.array(self.pressures), np.array(self.closures))

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return w ∫ p dc (n_point,), exact."""
        closures, pressures = np.array(self.closures), np.array(self.pressures)
        pressure = np.maximum(forces[0], 0.0) / weights
        row = np.clip(np.searchsorted(pressures, pressure, side="right") - 1, 0, len(closures) - 2)
        energies = np.append(
            0.0, np.cumsum(np.diff(closures) * (pressures[1:] + pressures[:-1]) / 2)
        )
        way = self.closure_of(pressure)[0] - closures[row]
        return np.asarray(weights * (energies[row] + way * (pressures[row] + pressure) / 2))


def _linear(x: Vector, positions: Vector, values: Vector) -> tuple[Vector, Vector]:
    """Return values and slopes at x of a piecewise linear function, continued at both ends."""
    row = np.clip(np.searchsorted(positions, x, side="right") - 1, 0, len(positions) - 2)
    slope = (np.diff(values) / np.diff(positions))[row]
    return values[row] + slope * (x - positions[row]), slope
