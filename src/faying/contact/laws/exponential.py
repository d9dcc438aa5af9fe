"""Pressure that rises exponentially with closure."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.contact.laws.curve import Curve, check_positive
from faying.iterations import MOST_STEPS

LAST_EXPONENT = 7.0
"""1 + c/c₀ beyond which the tangent continues: 4466 times p₀, without overflow of e^s."""


@dataclass(frozen=True)
class ExponentialClosure(Curve):
    """p = p₀ s (e^s − 1)/(e − 1) with s = 1 + c/c₀; zero where s < 0, and p₀ where surfaces meet.

    The softened contact of Abaqus (Theory Guide, "Small-sliding interaction between bodies"), in
    which ``*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL`` gives c₀ and p₀. Beyond s = 7 its
    tangent goes on.

    Attributes
    ----------
    pressure : [force/length²]
        p₀, at zero clearance.
    clearance : [length]
        c₀, at which pressure begins.

    Raises
    ------
    ModelError
        If one of them is not a positive number.

    Examples
    --------
    >>> import faying as fy
    >>> rough = fy.ExponentialClosure(pressure=5.0, clearance=2e-3)
    >>> joint = fy.lap_joint(element_size=5.0).with_closure(rough)
    >>> bool(fy.solve_static(fy.preload(joint, {"bolt": 10e3})).max_pressure > 10.0)
    True
    """

    pressure: float
    clearance: float

    def __post_init__(self) -> None:
        check_positive(self)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "exponential"

    @property
    def named_pressure(self) -> float:
        """p₀."""
        return self.pressure

    def pressure_of(self, closure: Vector) -> tuple[Vector, Vector]:
        """Return p and dp/dc."""
        s = np.maximum(1.0 + closure / self.clearance, 0.0)
        value, slope = _shape(np.minimum(s, LAST_EXPONENT))
        scale = self.pressure / np.expm1(1.0)
        pressure = scale * (value + slope * np.maximum(s - LAST_EXPONENT, 0.0))
        return pressure, scale / self.clearance * np.where(s > 0, slope, 0.0)

    def closure_of(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Return c and dc/dp; c = −c₀ at zero pressure."""
        scale = self.pressure / np.expm1(1.0)
        value = pressure / scale
        last, steepest = _shape(np.array(LAST_EXPONENT))
        # s² and, from 1 on, e^s − 1 are below s (e^s − 1): Newton's method begins above the root.
        s = np.minimum(np.minimum(np.sqrt(value), np.maximum(np.log1p(value), 1.0)), LAST_EXPONENT)
        for _ in range(MOST_STEPS):
            at, slope = _shape(s)
            step = np.divide(at - value, slope, out=np.zeros_like(s), where=slope > 0)
            previous, s = s, np.clip(s - step, 0.0, LAST_EXPONENT)
            if (np.abs(s - previous) <= 1e-15 * s).all():
                break
        beyond = np.maximum(value - last, 0.0) / steepest
        with np.errstate(divide="ignore"):
            slope = self.clearance / (scale * _shape(s)[1])
        return self.clearance * (s + beyond - 1.0), slope


def _shape(s: Vector) -> tuple[Vector, Vector]:
    """Return s (e^s − 1) and its derivative."""
    return s * np.expm1(s), np.expm1(s) + s * np.exp(s)
