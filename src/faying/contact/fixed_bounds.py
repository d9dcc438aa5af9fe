"""Increments with fixed friction bounds: convex problems, solved by Newton steps that descend.

With the friction bounds of forces c, and Y = c′(c) or, where that is less, a small part of what the
structure yields, forces are sought that obey

    x = admissible(c − Y⁻¹ (y + c(c) + z_free)),   y = G S Gᵀ x.                             (F1a)

This is where a convex energy of y is least: its slope along dy = G S Gᵀ dx is dyᵀ (x − right side),
and only rises, but where a point with a bound opens and lets go. Newton steps descend, and are as
long as they do. That tells more than the residual where little holds a part: along its motion the
structure yields a million times more than contact, so that a residual rises before a step arrives,
and the last digits decide whether it is taken.

Random paths do as well without (988 increments: 5 refused for 4, with fewer steps), but not hard
plates that friction alone holds between others, which are refused.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix
from faying.contact.forced_laws import Admitting
from faying.contact.newton_descent import FLAT
from faying.contact.newton_steps import NewtonSteps, at_least

LEAST_YIELD = 1e-6
"""Least that points yield, over what the structure yields at them.

Newton steps to tighten three plates, copies perturbed by 1e-14 in the mean: with 1e-8 83 where
they are rigid and 54 with a penalty, with 1e-6 36 and 66, with 1e-4 22 and 274.
"""

MOST_STEPS = 60
"""Newton steps; 2 to 15 are usual."""

MOST_TRIALS = 40
"""Lengths of a step that are tried."""

SOLVED_RESIDUAL = 1e-6
"""Residual over the largest force at which it is solved; the step to it leaves far less."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class FixedBounds:
    """The problem (F1a).

    Attributes
    ----------
    steps
        What forces move, and the linear systems of Newton steps.
    laws
        What the contact points admit and yield.
    z_free : (3, n_point) [length]
        Slack without contact forces.
    about : (3, n_point) [force]
        c.
    """

    steps: NewtonSteps
    laws: Admitting
    z_free: Matrix
    about: Matrix

    def solve(self) -> tuple[Matrix, int]:
        """Return forces (3, n_point), and in how many Newton steps they were found."""
        x, y, step = self.about, self.steps.moved(self.about), 0
        trial, wrong = self._judged(x, y)
        while step < MOST_STEPS and np.abs(wrong).max() > SOLVED_RESIDUAL * np.abs(x).max():
            step += 1
            slope = self.laws.derivative(trial, self.about[0])
            try:
                dx = self.steps.step(wrong, slope, 1.0 / self._yield, self._yield)
            except LinAlgError:
                break
            dy = self.steps.moved(dx)
            if not (dy * wrong).sum() < 0:
                break
            fraction = self._descending(x, y, dx, dy)
            x, y = x + fraction * dx, y + fraction * dy
            trial, wrong = self._judged(x, y)
        return x, step

    @cached_property
    def _closed(self) -> Matrix:
        """c(c)."""
        return self.laws.closure(self.about)[0]

    @cached_property
    def _yield(self) -> Matrix:
        """Y (3, n_point), one where nothing yields."""
        yields = at_least(LEAST_YIELD * self.steps.own, self.laws.closure(self.about)[1])
        return np.where((yields != 0) & np.isfinite(yields), yields, 1.0)

    def _judged(self, x: Matrix, y: Matrix) -> tuple[Matrix, Matrix]:
        """Return forces that the right side of (F1a) makes admissible, and x less that side."""
        trial = self.about - (y + self._closed + self.z_free) / self._yield
        return trial, x - self.laws.admissible(trial, self.about[0])

    def _descending(self, x: Matrix, y: Matrix, dx: Matrix, dy: Matrix) -> float:
        """Return the length of a step: one, or where its energy is least."""
        flat = FLAT * abs(float((dy * self._judged(x, y)[1]).sum()))
        low, high = 0.0, 1.0
        fraction = high
        for _ in range(MOST_TRIALS):
            slope = float((dy * self._judged(x + fraction * dx, y + fraction * dy)[1]).sum())
            if slope > flat:
                high = fraction
            elif slope < -flat and fraction < 1.0:
                low = fraction
            else:
                break
            fraction = (low + high) / 2
        return fraction
