"""Frictionless contact of elastic cylinders and spheres (Hertz 1882).

Formulas after K. L. Johnson, Contact Mechanics, Cambridge 1985: lines §4.2(c), Eqs. (4.43) to
(4.45), spheres §4.2(a), Eqs. (4.22) to (4.24).
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector


@dataclass(frozen=True, kw_only=True)
class LineContact:
    """Two parallel cylinders, or a cylinder on a plane, pressed together in plane strain.

    Attributes
    ----------
    load : [force/length]
        Per unit length along the line.
    radius : [length]
        Relative radius, 1/R = 1/R₁ + 1/R₂; the gap of the undeformed bodies is x²/(2R).
    modulus : [force/length²]
        E*, see :func:`effective_modulus`.

    Examples
    --------
    >>> contact = LineContact(load=100.0, radius=50.0, modulus=1e5)
    >>> round(contact.half_width, 4), round(contact.peak_pressure, 1)
    (0.2523, 252.3)
    """

    load: float
    radius: float
    modulus: float

    @property
    def half_width(self) -> float:
        """Half the width of the contact, √(4 P R / (π E*)) [length]."""
        return float(np.sqrt(4 * self.load * self.radius / (np.pi * self.modulus)))

    @property
    def peak_pressure(self) -> float:
        """Largest pressure, 2 P / (π a) [force/length²]."""
        return 2 * self.load / (np.pi * self.half_width)

    def pressure(self, x: Vector) -> Vector:
        """Pressure at distances x from the centre line, p₀ √(1 − x²/a²) [force/length²]."""
        inside = np.maximum(1 - (np.asarray(x) / self.half_width) ** 2, 0.0)
        return np.asarray(self.peak_pressure * np.sqrt(inside))

    def initial_gap(self, x: Vector) -> Vector:
        """Gap x²/(2R) of the undeformed bodies [length]."""
        return np.asarray(np.square(x) / (2 * self.radius))


@dataclass(frozen=True, kw_only=True)
class PointContact:
    """Two spheres, or a sphere on a plane, pressed together.

    Attributes
    ----------
    load : [force]
    radius : [length]
        Relative radius; the gap of the undeformed bodies is r²/(2R).
    modulus : [force/length²]
        E*, see :func:`effective_modulus`.

    Examples
    --------
    >>> contact = PointContact(load=100.0, radius=50.0, modulus=1e5)
    >>> round(contact.contact_radius, 4), round(contact.peak_pressure, 1)
    (0.3347, 426.2)
    """

    load: float
    radius: float
    modulus: float

    @property
    def contact_radius(self) -> float:
        """Radius of the contact, (3 P R / (4 E*))^(1/3) [length]."""
        return float(np.cbrt(3 * self.load * self.radius / (4 * self.modulus)))

    @property
    def peak_pressure(self) -> float:
        """Largest pressure, 3 P / (2 π a²) [force/length²]."""
        return 3 * self.load / (2 * np.pi * self.contact_radius**2)

    def pressure(self, r: Vector) -> Vector:
        """Pressure at distances r from the centre, p₀ √(1 − r²/a²) [force/length²]."""
        inside = np.maximum(1 - (np.asarray(r) / self.contact_radius) ** 2, 0.0)
        return np.asarray(self.peak_pressure * np.sqrt(inside))


def effective_modulus(*materials: tuple[float, float]) -> float:
    """Return E* of 1/E* = Σ (1 − ν²)/E over (E, ν) of the two bodies; a rigid one is left out.

    Examples
    --------
    >>> effective_modulus((200.0, 0.0), (200.0, 0.0))
    100.0
    """
    return 1.0 / sum((1 - ratio**2) / modulus for modulus, ratio in materials)
