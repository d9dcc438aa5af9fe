"""The damped oscillator under a suddenly applied force."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector


@dataclass(frozen=True, kw_only=True)
class Oscillator:
    """m ü + c u̇ + k u = f, underdamped.

    Attributes
    ----------
    mass, damping, stiffness
        With c < 2 √(k m).
    """

    mass: float
    damping: float
    stiffness: float

    @property
    def frequency(self) -> float:
        """Undamped angular frequency √(k/m)."""
        return float(np.sqrt(self.stiffness / self.mass))

    def step_response(self, force: float, times: Vector) -> Vector:
        """Displacement from rest under a constant force from t = 0+.

        (f/k) (1 − e^(−ζωt) (cos ω_d t + ζω/ω_d sin ω_d t)).

        Examples
        --------
        Without damping the dynamic deflection is twice the static one:

        >>> import numpy as np
        >>> float(Oscillator(mass=1.0, damping=0.0, stiffness=1.0).step_response(3.0, np.pi))
        6.0
        """
        decay = self.damping / (2 * self.mass)
        damped = np.sqrt(self.frequency**2 - decay**2)
        t = np.asarray(times)
        swing = np.cos(damped * t) + decay / damped * np.sin(damped * t)
        return np.asarray(force / self.stiffness * (1 - np.exp(-decay * t) * swing))
