"""A mass on a spring, at a distance from an elastic or rigid stop."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector


@dataclass(frozen=True, kw_only=True)
class SpringGap:
    """One degree of freedom u, held by a spring k, with a stop at u = −gap.

    Attributes
    ----------
    stiffness : [force/length]
    stop_stiffness : [force/length]
        Contact stiffness c (penalty times area); ``inf`` is a rigid stop.
    gap : [length]
        Distance to the stop at rest.
    mass
        Only for :meth:`free_vibration`.

    Examples
    --------
    >>> stop = SpringGap(stiffness=1.0, stop_stiffness=3.0, gap=1.0)
    >>> stop.contact_force(-5.0), stop.displacement(-5.0)
    (3.0, -2.0)
    """

    stiffness: float
    stop_stiffness: float = np.inf
    gap: float = 0.0
    mass: float = 1.0

    def contact_force(self, force: float) -> float:
        """Return the force of the stop under a static force; zero unless that closes the gap."""
        share = 1.0 / (1.0 + self.stiffness / self.stop_stiffness)
        return max(-force - self.stiffness * self.gap, 0.0) * share

    def displacement(self, force: float) -> float:
        """Return the static displacement (f + λ) / k."""
        return (force + self.contact_force(force)) / self.stiffness

    def free_vibration(self, amplitude: float, times: Vector) -> Vector:
        """Return the displacement after release at ``amplitude`` > 0, the stop elastic at no gap.

        Half a period on the spring alone, u = a cos ω₁t, and half a period on spring and stop,
        with ω₂² = (k + c)/m and the amplitude a ω₁/ω₂ of equal speed at u = 0.
        """
        slow = np.sqrt(self.stiffness / self.mass)
        fast = np.sqrt((self.stiffness + self.stop_stiffness) / self.mass)
        period = np.pi / slow + np.pi / fast
        since_zero = (np.asarray(times) + 0.5 * np.pi / slow) % period
        on_stop = since_zero - np.pi / slow
        apart = amplitude * np.sin(slow * since_zero)
        closed = -amplitude * slow / fast * np.sin(fast * on_stop)
        return np.asarray(np.where(on_stop < 0, apart, closed))
