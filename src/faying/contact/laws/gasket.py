"""Pressure over closure of gaskets with permanent set: a table to load, lines to unload."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.contact.laws.curve import Curve
from faying.contact.laws.table import TableClosure
from faying.exceptions import ModelError


@dataclass(frozen=True)
class GasketClosure(TableClosure):
    """p(c) by a table up to the largest closure so far, and along a straight line back from there.

    The slope of the line depends on that closure. At zero pressure the line ends, and its closure
    is the permanent set. Reloading follows the line, then the table. (``LUNL`` of Ansys'
    ``TB,GASKET``.)

    Attributes
    ----------
    unloading : (n,) [force/length³]
        Slope of the line from each row of the table; linear in between, constant beyond the last.

    Raises
    ------
    ModelError
        If there is no such table, slopes are not as many, or a line would lie above the table.

    Examples
    --------
    >>> import faying as fy
    >>> fy.GasketClosure(
    ...     closures=(0.0, 0.4, 0.7), pressures=(0.0, 44.0, 157.0), unloading=(500.0, 500.0, 1200.0)
    ... ).pressures[-1]
    157.0
    """

    unloading: tuple[float, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "unloading", tuple(map(float, self.unloading)))
        if len(self.unloading) != len(self.closures):
            message = (
                f"closure 'gasket': {len(self.closures)} closures and {len(self.unloading)} slopes "
                "of unloading; give each row its own"
            )
            raise ModelError(message)
        closures, pressures = np.array(self.closures), np.array(self.pressures)
        slopes = np.array(self.unloading)
        back = pressures[:, None] - slopes[:, None] * (closures[:, None] - closures)
        above = np.tril(back > pressures * (1 + 1e-12), -1)  # round-off of a line on the table
        if above.any() or not (slopes > 0).all():
            row = int(np.argmax(above.any(axis=1) | (slopes <= 0)))
            message = (
                f"closure 'gasket': from closure {closures[row]:g} pressure goes back with the "
                f"slope {slopes[row]:g}, above the pressures that led there; give it a steeper one"
            )
            raise ModelError(message)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "gasket"

    @property
    def remembers(self) -> bool:
        """True: pressure depends on the largest closure so far."""
        return True

    def after(self, deepest: Vector) -> "ClosedGasket":
        """Return the law of points with largest closures so far (n_point,) [length]."""
        return ClosedGasket(gasket=self, deepest=deepest)


@dataclass(frozen=True, eq=False, kw_only=True)
class ClosedGasket(Curve):
    """A gasket at points that were closed before.

    Attributes
    ----------
    gasket
    deepest : (n_point,) [length]
        Largest closures so far, negative where surfaces never met.
    """

    gasket: GasketClosure
    deepest: Vector

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return self.gasket.name

    @property
    def named_pressure(self) -> float:
        """The last pressure of the table."""
        return self.gasket.named_pressure

    @property
    def stiffness(self) -> float:
        """The steepest slope of the table [force/length³]."""
        return self.gasket.stiffness

    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return p and dp/dc: of the table at new closures, else of the unloading line."""
        pressure, slope = self.gasket.pressure_of(closure)
        reached, steep = self._back
        back, line = closure < self.deepest, reached - steep * (self.deepest - closure)
        pressed = line >= 0
        return np.where(back, line * pressed, pressure), np.where(back, steep * pressed, slope)

    def closure_of(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Return c and dc/dp: of the table at new closures, else of the unloading line."""
        closure, slope = self.gasket.closure_of(pressure)
        reached, steep = self._back
        back, line = pressure < reached, self.deepest - (reached - pressure) / steep
        return np.where(back, line, closure), np.where(back, 1.0 / steep, slope)

    @property
    def _back(self) -> tuple[Vector, Vector]:
        """Pressures (n_point,) at the largest closures, and slopes of unloading from there."""
        slopes = np.interp(self.deepest, self.gasket.closures, self.gasket.unloading)
        return self.gasket.pressure_of(self.deepest)[0], slopes
