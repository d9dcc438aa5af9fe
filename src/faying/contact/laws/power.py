"""Pressure as a power of closure, as measured on machined surfaces."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.contact.laws.curve import Curve, check_positive
from faying.exceptions import ModelError


@dataclass(frozen=True)
class PowerClosure(Curve):
    """p = p₀ (c/c₀)^m where c > 0.

    The measured closure of machined surfaces is C pⁿ with n about a half (M. Burdekin, N. Back, A.
    Cowley, J. Mech. Eng. Sci. 20 (1978) 129), so m = 1/n is about 2, and p₀ = (c₀/C)^m.

    Attributes
    ----------
    pressure : [force/length²]
        p₀.
    depth : [length]
        c₀, the closure at which the pressure is p₀.
    exponent
        m.

    Raises
    ------
    ModelError
        If one of them is not positive, or the exponent less than one.

    Examples
    --------
    >>> import faying as fy
    >>> rough = fy.PowerClosure(pressure=5.0, depth=2e-3, exponent=2.0)
    >>> joint = fy.lap_joint(element_size=5.0).with_closure(rough)
    >>> bool(fy.solve_static(fy.preload(joint, {"bolt": 10e3})).max_pressure > 10.0)
    True
    """

    pressure: float
    depth: float
    exponent: float

    def __post_init__(self) -> None:
        check_positive(self)
        if not 1 <= self.exponent < float("inf"):
            message = (
                f"closure 'power': the exponent is {self.exponent:g}; give one or more (of a "
                "closure that grows with the n-th power of pressure it is 1/n, 2 where n = 0.5)"
            )
            raise ModelError(message)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "power"

    @property
    def named_pressure(self) -> float:
        """p₀."""
        return self.pressure

    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return p and dp/dc."""
        ratio = np.maximum(closure, 0.0) / self.depth
        steepness = self.exponent * self.pressure / self.depth
        slope = steepness * ratio ** (self.exponent - 1.0) * (closure >= 0)
        return self.pressure * ratio**self.exponent, slope

    def closure_of(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Return c and dc/dp."""
        ratio = pressure / self.pressure
        flatness = self.depth / (self.exponent * self.pressure)
        with np.errstate(divide="ignore"):
            slope = flatness * ratio ** (1.0 / self.exponent - 1.0)
        return self.depth * ratio ** (1.0 / self.exponent), slope
